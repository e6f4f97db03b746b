// fuzz_readers SECONDS [SEED]: feeds mutated inputs to every reader, in process, and checks that
// nothing but parian::Error ever comes out of one. Run it under the sanitizers.
//
// HDF5 files are mutated by their structure (types, shapes, attributes, values, truncation), all
// valid for HDF5 itself: HDF5 1.10 crashes on flipped bytes of its own metadata, which is not ours
// to mend. Every case has a seed of its own, printed with a violation: `fuzz_readers 0 SEED` runs
// that case alone again.
#include <fcntl.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "fuzz_case.h"
#include "io/array/npy_file.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "io/json/test_folder.h"

namespace parian::fuzz {

void fuzz_image(Case& c) {
  static const std::vector<std::string> extensions{".png", ".hdr", ".exr"};
  const std::string extension = c.pick(extensions);
  static std::map<std::string, std::string> originals;
  std::string& original = originals[extension];
  const std::string path = c.folder + "/image" + extension;
  if (original.empty()) {
    Image image = make_image(11, 5, 3);
    for (std::size_t i = 0; i < image.values.size(); ++i)
      image.values[i] = static_cast<float>(hash_to_uniform(hash_u64(i)));
    save_image(path, image);
    original = read_file(path, 1 << 20);
  }
  std::string bytes = original;
  for (std::size_t edits = 1 + c.below(3); edits > 0; --edits)
    bytes[c.below(bytes.size())] = static_cast<char>(sample_u32(c.rng));
  if (c.one_in(4)) bytes.resize(c.below(bytes.size()));
  c.note(extension + ", bytes changed");
  std::ofstream(path, std::ios::binary) << bytes;  // write_text would wait for the disk
  load_image(path);
}

void fuzz_npy(Case& c) {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }";
  header.resize(117, ' ');
  std::string bytes = "\x93NUMPY\x01" + std::string(1, '\0') + "v" + std::string(1, '\0') + header +
                      "\n" + std::string(48, '\1');
  for (std::size_t edits = 1 + c.below(3); edits > 0; --edits)
    bytes[c.below(bytes.size())] =
        static_cast<char>(c.one_in(2) ? sample_u32(c.rng) : "0123456789(),'<>fiub:{}"[c.below(23)]);
  if (c.one_in(4)) bytes.resize(c.below(bytes.size()));
  c.note("npy, bytes changed");
  parse_npy(bytes, "a.npy");
}

}  // namespace parian::fuzz

namespace {

using namespace parian;
using namespace parian::fuzz;

struct Kind {
  const char* name;
  void (*run)(Case&);
  long cases = 0;
  long refused = 0;
};

// True unless something else than Error escapes.
bool run_case(std::vector<Kind>& kinds, std::uint64_t seed, const std::string& folder) {
  Kind& kind = kinds[hash_u64(seed) % kinds.size()];
  Case c{make_rng(seed), folder, ""};
  ++kind.cases;
  try {
    kind.run(c);
    return true;
  } catch (const Error& error) {
    if (error.kind != ErrorKind::contract) {
      ++kind.refused;
      return true;
    }
    std::printf("violation: a contract failed: %s\n", error.what());
  } catch (const std::exception& error) {
    std::printf("violation: %s\n", error.what());
  }
  std::printf("kind %s, input: %s\nreproduce with: fuzz_readers 0 %llu\n", kind.name,
              c.description.c_str(), static_cast<unsigned long long>(seed));
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 5;
  std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::printf("fuzz_readers: %g s from seed %llu; HDF5's own metadata is left alone\n", seconds,
              static_cast<unsigned long long>(seed));
  std::vector<Kind> kinds{
      {"json", fuzz_json},   {"params", fuzz_params}, {"sample", fuzz_sample},
      {"table", fuzz_table}, {"map", fuzz_map},       {"transport", fuzz_transport},
      {"image", fuzz_image}, {"npy", fuzz_npy},       {"mesh", fuzz_mesh},
      {"blend", fuzz_blend}, {"recipe", fuzz_recipe}, {"photons", fuzz_photons}};
  const TestFolder folder("fuzz");
  const std::string last_name = folder.path.string() + ".seed";
  const int last_case = ::open(last_name.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  std::printf("after a crash, the seed of its case is in %s\n", last_name.c_str());
  std::fflush(stdout);
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  bool good = true;
  do {
    // What no handler sees, a crash or a sanitizer's report, leaves the seed behind in this file.
    const std::string text = std::to_string(seed) + "\n";
    if (::pwrite(last_case, text.data(), text.size(), 0) < 0) return 2;
    good = run_case(kinds, seed++, folder.path.string());
  } while (good && Clock::now() < end);
  ::close(last_case);
  ::unlink(last_name.c_str());
  for (const Kind& kind : kinds)
    std::printf("%-9s %8ld cases, %8ld refused\n", kind.name, kind.cases, kind.refused);
  return good ? 0 : 1;
}

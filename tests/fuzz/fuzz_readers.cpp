// fuzz_readers SECONDS [SEED]: feeds mutated inputs to every reader, in process, and checks that
// nothing but parian::Error ever comes out of one. Run it under the sanitizers.
//
// HDF5 files are mutated by their structure (types, shapes, attributes, values, truncation), all
// valid for HDF5 itself: HDF5 1.10 crashes on flipped bytes of its own metadata, which is not ours
// to mend. Every case has a seed of its own, printed with a violation: `fuzz_readers 0 SEED` runs
// that case alone again.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "acquire/sample.h"
#include "base/random.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/hdf5/testing.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "io/json/json.h"

namespace {

using namespace parian;
namespace fs = std::filesystem;

struct Case {
  Rng rng;
  std::string folder;
  std::string description;  // what was done to the input

  std::size_t below(std::size_t count) { return sample_u32(rng) % count; }
  bool one_in(std::size_t count) { return below(count) == 0; }
  template <typename T>
  T pick(const std::vector<T>& values) {
    return values[below(values.size())];
  }
  void note(const std::string& text) { description += description.empty() ? text : ", " + text; }
  std::string at(const char* name) const { return folder + "/" + name; }
};

// ---- bytes ----

std::string mutate_bytes(Case& c, std::string text) {
  static const std::vector<std::string> tokens{"{",
                                               "}",
                                               "[",
                                               "]",
                                               ",",
                                               ":",
                                               "\"",
                                               "\\u12",
                                               "\\ud800",
                                               "null",
                                               "true",
                                               "1e999",
                                               "-",
                                               "0.0",
                                               "1e-400",
                                               "-0",
                                               "1e308",
                                               "\xff",
                                               "\"a\":",
                                               "//",
                                               "\"eta\":0",
                                               "[[[[[[[[",
                                               "99999999999999999999",
                                               "\"\":{}",
                                               "\"/~\":"};
  for (std::size_t edits = 1 + c.below(4); edits > 0; --edits) {
    const std::size_t at = c.below(text.size() + 1);
    switch (c.below(5)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(sample_u32(c.rng));
        break;
      case 1:
        text.erase(at, 1 + c.below(8));
        break;
      case 2:
        text.insert(at, c.pick(tokens));
        break;
      case 3:
        text.insert(at, text.substr(c.below(text.size() + 1), c.below(40)));
        break;
      default:
        if (c.one_in(4)) text.resize(at);
    }
  }
  return text;
}

// ---- documents ----

double odd_number(Case& c) {
  return c.pick<double>(
      {0,     -0.0, 1,   -1,         0.5,           1.5,          2,    3,     64,     65535,
       65536, 1e6,  1e9, 2147483647, -2147483648.0, 4294967296.0, 1e18, 1e300, -1e300, 1e-300,
       5e-324});
}

Document odd_value(Case& c) {
  switch (c.below(7)) {
    case 0:
      return nullptr;
    case 1:
      return c.one_in(2);
    case 2:
      return c.pick<std::string>({"", "x", "chessboard", "../../etc", std::string(300, 'y')});
    case 3:
      return Document::Array{};
    case 4:
      return Document::Object{};
    case 5:
      return Document::Array{odd_number(c), odd_number(c), odd_number(c)};
    default:
      return odd_number(c);
  }
}

std::size_t count_nodes(const Document& node) {
  std::size_t count = 1;
  if (const auto* array = std::get_if<Document::Array>(&node.value))
    for (const Document& child : *array) count += count_nodes(child);
  if (const auto* object = std::get_if<Document::Object>(&node.value))
    for (const auto& [key, child] : *object) count += count_nodes(child);
  return count;
}

void mutate_node(Case& c, Document& node) {
  c.note("changed " + (node.pointer.empty() ? "/" : node.pointer));
  if (auto* object = std::get_if<Document::Object>(&node.value); object && !c.one_in(4)) {
    const std::size_t at = object->empty() ? 0 : c.below(object->size());
    if (object->empty() || c.one_in(3)) {
      object->emplace_back(c.pick<std::string>({"", "seed", "eta", "unknown"}), odd_value(c));
    } else if (c.one_in(2)) {
      object->erase(object->begin() + static_cast<std::ptrdiff_t>(at));
    } else {
      (*object)[at].first += "x";
    }
    return;
  }
  if (auto* array = std::get_if<Document::Array>(&node.value); array && !c.one_in(4)) {
    if (array->empty() || c.one_in(2)) {
      array->push_back(array->empty() || c.one_in(2) ? odd_value(c) : c.pick(*array));
    } else {
      array->erase(array->begin() + static_cast<std::ptrdiff_t>(c.below(array->size())));
    }
    return;
  }
  node.value = odd_value(c).value;
}

// Counts `index` down through the tree in document order and changes the node where it ends.
bool mutate_at(Case& c, Document& node, std::size_t& index) {
  if (index-- == 0) {
    mutate_node(c, node);
    return true;
  }
  if (auto* array = std::get_if<Document::Array>(&node.value))
    for (Document& child : *array)
      if (mutate_at(c, child, index)) return true;
  if (auto* object = std::get_if<Document::Object>(&node.value))
    for (auto& [key, child] : *object)
      if (mutate_at(c, child, index)) return true;
  return false;
}

void fuzz_json(Case& c) {
  static const std::string text =
      R"({"name": "wax", "list": [1, 2.5e-3, -7], "nested": {"a": {"b": [[], {}]}}, "t": "\u00e4"})";
  const std::string changed = mutate_bytes(c, text);
  c.note(changed);
  const Document document = parse_document(changed, "fuzz.json");
  // What is read is written and read again to the same text.
  const std::string written = format_document(document);
  if (format_document(parse_document(written, "again")) != written)
    throw std::logic_error("a document changes when it is written and read: " + written);
}

void fuzz_params(Case& c) {
  bool flag = false;
  int segments = 0;
  std::uint64_t seed = 0;
  double radius = 0;
  std::string name;
  std::vector<double> knots;
  enum class Mode { fast, good } mode = Mode::fast;
  const ParamList params{
      {.name = "flag", .help = "", .target = &flag},
      {.name = "segments", .help = "", .target = &segments, .min = 0, .max = 256},
      {.name = "seed", .help = "", .target = &seed},
      {.name = "radius", .help = "", .target = &radius, .min = 0, .above_min = true},
      {.name = "name", .help = "", .target = &name},
      {.name = "knots", .help = "", .target = &knots, .min = 0},
      {.name = "mode", .help = "", .target = make_choice(mode, {"fast", "good"})}};
  Document document = parse_document(
      R"({"flag": true, "segments": 3, "seed": 7, "radius": 2, "name": "x", "knots": [0, 1], "mode": "good"})",
      "fuzz.json");
  std::size_t index = c.below(count_nodes(document));
  mutate_at(c, document, index);
  read_params(document, params);
  if (segments < 0 || segments > 256 || !(radius >= 0))
    throw std::logic_error("a parameter out of range was accepted");
}

// The bundled sample descriptions; none until there are some.
std::vector<Document> load_samples() {
  std::vector<Document> samples;
  const fs::path folder = PARIAN_SOURCE_DIR "/data/samples";
  if (!fs::is_directory(folder)) return samples;
  std::vector<std::string> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".json") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  for (const std::string& path : paths) samples.push_back(load_document(path));
  return samples;
}

void fuzz_sample(Case& c) {
  static const std::vector<Document> samples = load_samples();
  if (samples.empty()) return;
  Document document = c.pick(samples);
  for (std::size_t edits = 1 + c.below(2); edits > 0; --edits) {
    std::size_t index = c.below(count_nodes(document));
    mutate_at(c, document, index);
  }
  const ImageLoader load = [](const std::string&) { return make_image(3, 2, 3, 0.5f); };
  read_sample(document, load, c.one_in(2) ? -1 : 5);
}

// ---- HDF5 ----

hid_t odd_type(Case& c) {
  return c.pick<hid_t>({H5T_NATIVE_INT, H5T_NATIVE_SCHAR, H5T_STD_U64BE, H5T_NATIVE_FLOAT,
                        H5T_IEEE_F64BE, H5T_IEEE_F32BE, H5T_NATIVE_LDOUBLE, H5T_NATIVE_HBOOL,
                        H5T_STD_B16LE, H5T_STD_REF_OBJ, H5T_UNIX_D32LE});
}

std::vector<hsize_t> odd_shape(Case& c) {
  std::vector<hsize_t> shape(c.below(6));
  for (hsize_t& size : shape) size = c.pick<hsize_t>({0, 1, 2, 3, 4, 5, 7, 16});
  return shape;
}

std::size_t count_of(const std::vector<hsize_t>& shape) {
  std::size_t count = 1;
  for (const hsize_t size : shape) count *= static_cast<std::size_t>(size);
  return count;
}

// Bytes enough for `count` values of any of the types above.
std::vector<double> odd_data(Case& c, std::size_t count) {
  std::vector<double> data(2 * count + 2);
  for (double& value : data) value = odd_number(c);
  return data;
}

void mutate_attribute(Case& c, hdf5::TestFile& file) {
  const auto name = c.pick<std::string>({"format", "version", "pixel_pitch_mm", "boundary", "eta",
                                         "symmetric", "sampling", "noise_floor", "noise_gain",
                                         "provenance", "hold_out_fraction", "hold_out_seed"});
  const std::size_t kind = c.below(6);
  c.note(fmt::format("attribute {} kind {}", name, kind));
  if (kind == 0) return file.remove_attribute(name.c_str());
  if (kind == 1)
    return file.set(name.c_str(), c.pick<std::string>({"", "included", "area", "\xff\xfe", "parian",
                                                       std::string(5000, 'z')}));
  if (kind == 2) return file.set(name.c_str(), odd_number(c));
  if (kind == 3) {
    const double bad = c.pick<double>({NAN, INFINITY, -INFINITY});
    return file.set(name.c_str(), bad);
  }
  if (kind == 4)
    return file.set_fixed(name.c_str(), "included", 1 + c.below(12),
                          c.one_in(2) ? H5T_STR_SPACEPAD : H5T_STR_NULLPAD);
  const std::vector<hsize_t> shape = odd_shape(c);
  if (count_of(shape) > 2000) return;
  file.set(name.c_str(), odd_type(c), odd_data(c, count_of(shape)).data(), shape);
}

hid_t make_odd_plist(Case& c, const std::vector<hsize_t>& shape) {
  const hid_t plist = H5Pcreate(H5P_DATASET_CREATE);
  const bool chunkable = !shape.empty() && count_of(shape) > 0;
  if (!chunkable || c.one_in(3)) return plist;
  std::vector<hsize_t> chunk;
  for (const hsize_t size : shape) chunk.push_back(1 + c.below(static_cast<std::size_t>(size)));
  if (shape.size() == 4 && c.one_in(2)) chunk = {1, 1, shape[2], shape[3]};
  H5Pset_chunk(plist, static_cast<int>(chunk.size()), chunk.data());
  if (c.one_in(2)) H5Pset_shuffle(plist);
  if (c.one_in(2)) H5Pset_deflate(plist, 1);
  if (c.one_in(4)) H5Pset_fletcher32(plist);
  return plist;
}

void mutate_dataset(Case& c, hdf5::TestFile& file, const std::vector<std::string>& names,
                    const std::vector<std::vector<hsize_t>>& shapes) {
  const std::size_t which = c.below(names.size());
  const char* name = names[which].c_str();
  if (c.one_in(6)) {
    c.note(fmt::format("dataset {} removed", name));
    file.remove_dataset(name);
    if (c.one_in(2)) {
      const hdf5::Id group(H5Gcreate2(file.file.get(), name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                           H5Gclose);
    }
    return;
  }
  std::vector<hsize_t> shape = shapes[which];
  if (c.one_in(3)) shape = odd_shape(c);
  if (!shape.empty() && c.one_in(3))
    shape[c.below(shape.size())] = c.pick<hsize_t>({0, 1, 2, 3, 9});
  if (count_of(shape) > 20000) return;
  const hid_t type = c.one_in(2) ? odd_type(c) : H5T_IEEE_F32LE;
  const hdf5::Id plist(make_odd_plist(c, shape), H5Pclose);
  c.note(fmt::format("dataset {} shape {}", name, fmt::join(shape, "x")));
  const std::vector<double> data = odd_data(c, count_of(shape));
  file.put(name, type, shape, type, c.one_in(5) ? nullptr : data.data(), plist.get());
}

void truncate_file(Case& c, const std::string& path) {
  if (!c.one_in(4)) return;
  const std::size_t size = static_cast<std::size_t>(fs::file_size(path));
  const std::size_t rest = c.below(size);
  c.note(fmt::format("truncated to {}", rest));
  fs::resize_file(path, rest);
}

void fuzz_table(Case& c) {
  static const BssrdfTable table = hdf5::make_noise_table(hdf5::make_test_header());
  const std::string path = c.at("table.h5");
  {
    const hdf5::Guard guard;
    hdf5::TestFile file = hdf5::write_minimal_table(path, table);
    for (std::size_t edits = c.below(3); edits > 0; --edits) mutate_attribute(c, file);
    for (std::size_t edits = c.below(3); edits > 0; --edits)
      mutate_dataset(c, file, {"offsets", "reflectance"},
                     {{table.header.offsets.size(), 2}, hdf5::table_shape(table.header)});
  }
  truncate_file(c, path);
  const BssrdfTable read = read_table(*open_table(path));
  for (const float value : read.reflectance)
    if (std::isinf(value)) throw std::logic_error("an infinite value was accepted");
}

void fuzz_map(Case& c) {
  static const ProfileMap map = make_profile_map(4, 3, 3, 0.5, {0, 0.5, 1}, -1);
  const std::string path = c.at("map.h5");
  {
    const hdf5::Guard guard;
    hdf5::TestFile file(path);
    file.set("format", std::string("parian-profile-map"));
    file.set("version", 1);
    file.set("pixel_pitch_mm", 0.5);
    file.put("knots_mm", H5T_NATIVE_DOUBLE, {3}, H5T_NATIVE_DOUBLE, map.knots_mm.data());
    file.put("log_profile", H5T_NATIVE_FLOAT, {3, 3, 3, 4}, H5T_NATIVE_FLOAT,
             map.log_profile.data());
    for (std::size_t edits = c.below(3); edits > 0; --edits) mutate_attribute(c, file);
    for (std::size_t edits = c.below(3); edits > 0; --edits)
      mutate_dataset(c, file, {"knots_mm", "log_profile", "gain", "dilation"},
                     {{3}, {3, 3, 3, 4}, {3, 3, 4}, {3, 3, 4}});
  }
  truncate_file(c, path);
  check(load_profile_map(path), path);
}

// ---- images ----

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
  write_text(path, bytes);
  load_image(path);
}

// ---- the loop ----

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
  std::vector<Kind> kinds{{"json", fuzz_json},   {"params", fuzz_params}, {"sample", fuzz_sample},
                          {"table", fuzz_table}, {"map", fuzz_map},       {"image", fuzz_image}};
  const hdf5::TestFolder folder("fuzz");
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  bool good = true;
  do {
    // A crash leaves the seed of its case behind as the last line.
    good = run_case(kinds, seed++, folder.path.string());
  } while (good && Clock::now() < end);
  for (const Kind& kind : kinds)
    std::printf("%-8s %8ld cases, %8ld refused\n", kind.name, kind.cases, kind.refused);
  return good ? 0 : 1;
}

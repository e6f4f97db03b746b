// Mutated .kbm files: bytes changed and cut off, and sections changed whose checksums are right.
#include "fuzz_case.h"
#include "io/blend/blend_file.h"
#include "io/blend/sections_internal.h"
#include "material/test_blends.h"

namespace parian::fuzz {
namespace {

std::string make_file(Case& c) {
  const int per_pixel = c.pick<int>({1, 2, 3, 8}), bases = c.pick<int>({1, 5, 300});
  ProfileBlend blend = make_blend(per_pixel, bases, c.pick<int>({1, 3}));
  const std::size_t planes = static_cast<std::size_t>(blend.channels) * blend.pixels();
  if (c.one_in(4)) blend.gain.assign(planes, 0.5f);
  if (c.one_in(4)) blend.dilation.assign(planes, 0.5f);
  if (c.one_in(2)) return encode_blend(blend, BlendEncoding::paper);
  snap_to_grid(blend, {0.01, c.pick<int>({1, 63, 255, 65535})});
  return encode_blend(blend, BlendEncoding::packed);
}

void change_bytes(Case& c, std::string& bytes) {
  if (bytes.empty()) return;
  for (std::size_t edits = 1 + c.below(3); edits > 0; --edits)
    bytes[c.below(bytes.size())] = static_cast<char>(sample_u32(c.rng));
  if (c.one_in(4)) bytes.resize(c.below(bytes.size()));
}

// A number of the header becomes another one.
void change_header(Case& c, std::string& header) {
  std::vector<std::size_t> numbers;
  for (std::size_t i = 1; i < header.size(); ++i)
    if (header[i] >= '0' && header[i] <= '9' && header[i - 1] == ' ') numbers.push_back(i);
  const std::size_t at = c.pick(numbers);
  const std::size_t end = header.find_first_of(",\n]", at);
  header.replace(at, end - at,
                 c.pick<std::string>({"0", "1", "2", "3", "7", "8", "9", "255", "256", "300",
                                      "65535", "65536", "-1", "1e9", "1e300", "0.5", "true"}));
}

// Changes one section and gives it a checksum of its own again.
std::string change_section(Case& c, const std::string& file) {
  ByteReader reader{std::string_view(file).substr(8), "fuzz"};
  std::vector<std::string> sections;
  while (!reader.bytes.empty()) sections.emplace_back(reader.take_section("section"));
  const std::size_t chosen = c.one_in(3) ? 0 : c.below(sections.size());
  if (chosen == 0)
    change_header(c, sections[0]);
  else
    change_bytes(c, sections[chosen]);
  c.note("section " + std::to_string(chosen) + " changed");
  std::string changed = file.substr(0, 8);
  for (const std::string& section : sections) append_section(changed, section);
  return changed;
}

}  // namespace

void fuzz_blend(Case& c) {
  std::string bytes = make_file(c);
  if (c.one_in(4)) {
    change_bytes(c, bytes);
    c.note("bytes changed");
  } else {
    bytes = change_section(c, bytes);
  }
  const ProfileBlend blend = decode_blend(bytes, "fuzz.kbm");
  if (blend.pixels() < 100) make_profile_map(blend);  // whatever passes can be evaluated
}

}  // namespace parian::fuzz

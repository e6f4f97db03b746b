#include <fmt/format.h>

#include "base/error.h"
#include "io/blend/header_internal.h"
#include "io/json/json.h"

namespace parian {
namespace {

constexpr int max_side = 65535;
constexpr std::size_t max_pixels = std::size_t{1} << 26u;
constexpr std::size_t max_knots = 4096;

Document make_numbers(const std::vector<double>& numbers) {
  return Document::Array(numbers.begin(), numbers.end());
}

// The two values that a key may have.
bool read_choice(const Document& header, const char* key, const char* yes, const char* no) {
  const Document& node = get(header, key);
  if (as_string(node) == yes) return true;
  if (as_string(node) != no) throw_at(node, fmt::format("'{}' or '{}'", yes, no));
  return false;
}

}  // namespace

std::string format_header(const ProfileBlend& blend, BlendEncoding encoding) {
  Document header{Document::Object{}};
  set(header, "width", blend.width);
  set(header, "height", blend.height);
  set(header, "channels", blend.channels);
  set(header, "bases", blend.bases());
  set(header, "per_pixel", blend.per_pixel);
  set(header, "pixel_pitch_mm", blend.pixel_pitch_mm);
  set(header, "boundary", blend.boundary == Boundary::included ? "included" : "excluded");
  set(header, "eta", blend.eta);
  set(header, "knots_mm", make_numbers(blend.knots_mm));
  set(header, "encoding", encoding == BlendEncoding::packed ? "packed" : "paper");
  set(header, "profile_step", blend.grid.profile_step);
  set(header, "weight_levels", blend.grid.weight_levels);
  set(header, "gain", !blend.gain.empty());
  set(header, "dilation", !blend.dilation.empty());
  set(header, "hold_out_fraction", blend.hold_out.fraction);
  set(header, "hold_out_seed", std::to_string(blend.hold_out.seed));
  set(header, "provenance", blend.provenance);
  return format_document(header);
}

BlendHeader parse_header(std::string_view text, const std::string& name) {
  const Document header = parse_document(text, name);
  BlendHeader parsed;
  ProfileBlend& blend = parsed.blend;
  blend.width = as_int(get(header, "width"), 1, max_side);
  blend.height = as_int(get(header, "height"), 1, max_side);
  if (blend.pixels() > max_pixels)
    throw_at(get(header, "height"), fmt::format("at most {} pixels", max_pixels),
             fmt::format("{}", blend.pixels()));
  blend.channels = as_int(get(header, "channels"), 1, 3);
  if (blend.channels == 2) throw_at(get(header, "channels"), "1 or 3", "2");
  parsed.bases = static_cast<std::size_t>(as_int(get(header, "bases"), 1, max_bases));
  blend.per_pixel = as_int(get(header, "per_pixel"), 1, max_bases_per_pixel);
  blend.pixel_pitch_mm = as_number(get(header, "pixel_pitch_mm"), 1e-12, 1e12);
  blend.boundary = read_choice(header, "boundary", "included", "excluded") ? Boundary::included
                                                                           : Boundary::excluded;
  blend.eta = as_number(get(header, "eta"), 0.1, 10);
  blend.knots_mm = as_numbers(get(header, "knots_mm"));
  if (blend.knots_mm.size() < 2 || blend.knots_mm.size() > max_knots)
    throw_at(get(header, "knots_mm"), fmt::format("2 to {} knots", max_knots),
             fmt::format("{}", blend.knots_mm.size()));
  parsed.encoding = read_choice(header, "encoding", "packed", "paper") ? BlendEncoding::packed
                                                                       : BlendEncoding::paper;
  const bool packed = parsed.encoding == BlendEncoding::packed;
  blend.grid.profile_step = as_number(get(header, "profile_step"), packed ? 1e-6 : 0, 1);
  blend.grid.weight_levels = as_int(get(header, "weight_levels"), packed ? 1 : 0, 65535);
  parsed.has_gain = as_bool(get(header, "gain"));
  parsed.has_dilation = as_bool(get(header, "dilation"));
  blend.hold_out.fraction = as_number(get(header, "hold_out_fraction"), 0, 1);
  const Document& seed = get(header, "hold_out_seed");
  try {
    blend.hold_out.seed = std::stoull(as_string(seed));
  } catch (const std::logic_error&) {
    throw_at(seed, "a whole number as a string");
  }
  blend.provenance = as_string(get(header, "provenance"));
  return parsed;
}

}  // namespace parian

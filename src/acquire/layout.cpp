#include "acquire/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/names.h"

namespace parian {
namespace {

struct Describe {
  ParamList operator()(UniformLayout&) const { return {}; }
  ParamList operator()(ChessboardLayout& layout) const {
    return {length("tile-mm", "side of a square", layout.tile_mm),
            angle("rotation-deg", "turns the board", layout.rotation_deg)};
  }
  ParamList operator()(StonesLayout& layout) const {
    return {length("size-mm", "spacing of the stones, about their diameter", layout.size_mm),
            number("spread", "relative spread of the radii", layout.spread, 0, 0.9),
            number("elongation", "largest ratio of the axes", layout.elongation, 1, 4),
            number("coverage", "part of the places that hold a stone", layout.coverage, 0, 1),
            number("gap-mm", "matrix between neighbours", layout.gap_mm, 0, 1000),
            number("roughness", "displacement of outlines / size", layout.roughness, 0, 1),
            shares("relative frequency of materials 2, 3, ...", layout.shares)};
  }
  ParamList operator()(VeinsLayout& layout) const {
    return {length("spacing-mm", "distance between veins", layout.spacing_mm),
            length("width-mm", "full width at half strength", layout.width_mm),
            angle("angle-deg", "direction of stretch", layout.angle_deg),
            number("stretch", "elongation along the angle", layout.stretch, 1, 20),
            number("presence", "part of the veins that is there", layout.presence, 0, 1),
            octaves(layout.octaves)};
  }
  ParamList operator()(LayersLayout& layout) const {
    return {length("thickness-mm", "mean thickness of a band", layout.thickness_mm),
            angle("angle-deg", "of the bands, against x", layout.angle_deg),
            number("waviness-mm", "displacement, standard deviation", layout.waviness_mm, 0, 1000),
            length("wavelength-mm", "of the displacement", layout.wavelength_mm),
            number("irregularity", "variation of the thickness", layout.irregularity, 0, 2),
            number("softness-mm", "width of the transitions", layout.softness_mm, 0, 1000),
            shares("relative thickness", layout.shares)};
  }
  ParamList operator()(MixingLayout& layout) const {
    return {length("wavelength-mm", "of the largest structures", layout.wavelength_mm),
            number("sharpness", "0: all alike; large: patches", layout.sharpness, 0, 100),
            octaves(layout.octaves), shares("factors of the weights", layout.shares)};
  }
  ParamList operator()(ImageLayout& layout) const {
    return {
        {.name = "image", .help = "grey image, stretched over the sample", .target = &layout.image},
        {.name = "thresholds",
         .help = "luminances between the materials",
         .target = &layout.thresholds,
         .min = 0,
         .max = 1}};
  }

 private:
  static Param number(const char* name, const char* help, double& target, double min, double max) {
    return {.name = name, .help = help, .target = &target, .min = min, .max = max};
  }
  static Param length(const char* name, const char* help, double& target) {
    return {.name = name, .help = help, .target = &target, .min = 1e-4, .max = 1000, .unit = "mm"};
  }
  static Param angle(const char* name, const char* help, double& target) {
    return {
        .name = name, .help = help, .target = &target, .min = -360, .max = 360, .unit = "degrees"};
  }
  static Param octaves(int& target) {
    return {.name = "octaves", .help = "octaves of noise", .target = &target, .min = 1, .max = 8};
  }
  static Param shares(const char* help, std::vector<double>& target) {
    return {.name = "shares", .help = help, .target = &target, .min = 0, .max = 1000};
  }
};

// Lists that hold one value per material must do so.
struct CheckLists {
  const Document& object;
  int materials;

  void shares(const std::vector<double>& values, int expected) const {
    if (values.empty()) return;
    if (static_cast<int>(values.size()) != expected)
      throw_at(get(object, "shares"), fmt::format("{} shares", expected),
               fmt::format("{}", values.size()));
    if (*std::max_element(values.begin(), values.end()) <= 0)
      throw_at(get(object, "shares"), "a share above 0", "none");
  }
  void operator()(const StonesLayout& layout) const { shares(layout.shares, materials - 1); }
  void operator()(const LayersLayout& layout) const { shares(layout.shares, materials); }
  void operator()(const MixingLayout& layout) const { shares(layout.shares, materials); }
  void operator()(const ImageLayout& layout) const {
    if (layout.thresholds.empty()) return;
    const Document& node = get(object, "thresholds");
    if (static_cast<int>(layout.thresholds.size()) != materials - 1)
      throw_at(node, fmt::format("{} thresholds, one fewer than materials", materials - 1),
               fmt::format("{}", layout.thresholds.size()));
    if (!std::is_sorted(layout.thresholds.begin(), layout.thresholds.end()))
      throw_at(node, "thresholds that increase");
  }
  void operator()(const UniformLayout&) const {}
  void operator()(const ChessboardLayout&) const {}
  void operator()(const VeinsLayout&) const {}
};

Image read_image(const Document& node, const ImageLoader& load_image) {
  const std::string& path = as_string(node);
  if (path.empty()) throw_at(node, "the path of an image");
  Image map;
  try {
    if (!load_image) throw Error({"", "", "", "no image loader"});
    map = load_image(path);
  } catch (const Error& error) {
    if (error.kind == ErrorKind::cancelled) throw;
    throw_at(node, "an image that can be read", error.what());
  }
  if (map.width < 1 || map.height < 1)
    throw_at(node, "an image with at least one pixel", "an empty image");
  return map;
}

void read_maps(const Document& object, const ImageLoader& load_image, ImageLayout& layout) {
  const Document* stack = find(object, "images");
  if (stack == nullptr) {
    layout.map = read_image(get(object, "image"), load_image);
    return;
  }
  if (find(object, "image") != nullptr) throw_at(*stack, "either 'image' or 'images'", "both");
  const Document::Array& images = as_array(*stack);
  if (images.empty()) throw_at(*stack, "at least one image");
  for (const Document& node : images) layout.deeper.push_back(read_image(node, load_image));
  layout.map = std::move(layout.deeper.front());
  layout.deeper.erase(layout.deeper.begin());
}

}  // namespace

const std::vector<std::string>& layout_kinds() {
  static const std::vector<std::string> kinds{"uniform", "chessboard", "stones", "veins",
                                              "layers",  "mixing",     "image"};
  return kinds;
}

Layout make_layout(const std::string& kind) {
  const std::vector<Layout> all{UniformLayout{}, ChessboardLayout{}, StonesLayout{}, VeinsLayout{},
                                LayersLayout{},  MixingLayout{},     ImageLayout{}};
  const auto found = std::find(layout_kinds().begin(), layout_kinds().end(), kind);
  if (found != layout_kinds().end())
    return all[static_cast<std::size_t>(found - layout_kinds().begin())];
  const std::string nearest = nearest_name(kind, layout_kinds());
  throw Error({"", "kind", "one of " + list_names(layout_kinds()),
               nearest.empty() ? fmt::format("'{}'", kind)
                               : fmt::format("'{}' (did you mean '{}'?)", kind, nearest)});
}

ParamList describe(Layout& layout) {
  return std::visit(Describe{}, layout);
}

Layout read_layout(const Document& object, int materials, const ImageLoader& load_image) {
  const Document& kind = get(object, "kind");
  Layout layout;
  try {
    layout = make_layout(as_string(kind));
  } catch (const Error& error) {
    if (error.parts.place != "kind") throw;
    throw_at(kind, error.parts.expected, error.parts.found);
  }
  const bool is_uniform = std::holds_alternative<UniformLayout>(layout);
  if (is_uniform != (materials == 1))
    throw_at(kind,
             is_uniform ? "one material for the layout 'uniform'"
                        : "at least two materials for this layout, or 'uniform'",
             fmt::format("{} with {} material{}", as_string(kind), materials,
                         materials == 1 ? "" : "s"));
  auto* image = std::get_if<ImageLayout>(&layout);
  read_params(object, describe(layout),
              image != nullptr ? std::vector<std::string>{"kind", "images"}
                               : std::vector<std::string>{"kind"});
  std::visit(CheckLists{object, materials}, layout);
  if (image != nullptr) read_maps(object, load_image, *image);
  return layout;
}

}  // namespace parian

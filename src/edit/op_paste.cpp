// "paste": a pattern from this map, another map or an image.
#include <fmt/format.h>

#include "base/error.h"
#include "edit/operations.h"
#include "edit/paste.h"
#include "edit/read_parts_internal.h"

namespace parian {
namespace {

// {"map" | "image": FILE, "min": [x, y], "max": [x, y], "unit": ..., "pixel_pitch_mm": ...}
struct PatternSource {
  Document node;
  std::shared_ptr<const EditState> map;
  std::shared_ptr<const Image> image;
  double pixel_pitch_mm = 0;  // of an image; 0: the map's
  bool has_rectangle = false;
  Point2 min, max;
  Unit unit = Unit::mm;
};

PatternSource read_pattern_source(const Document& node, RecipeResources& resources) {
  check_keys(node, {"map", "image", "min", "max", "unit", "pixel_pitch_mm"});
  PatternSource source;
  source.node = node;
  source.unit = read_unit(node);
  const Document *map = find(node, "map"), *image = find(node, "image");
  if (map != nullptr && image != nullptr)
    throw_at(*image, "only one of the keys 'map' and 'image'", "another");
  if (map != nullptr) source.map = get_map(resources, *map);
  if (image != nullptr) source.image = get_image(resources, *image);
  if (const Document* pitch = find(node, "pixel_pitch_mm")) {
    if (image == nullptr) throw_at(*pitch, "the key 'pixel_pitch_mm' only beside 'image'");
    source.pixel_pitch_mm = read_length(*pitch, 1e-6);
  }
  const Document *min = find(node, "min"), *max = find(node, "max");
  if ((min == nullptr) != (max == nullptr)) throw_at(node, "both 'min' and 'max' or none", "one");
  if (min == nullptr) {
    if (map == nullptr && image == nullptr)
      throw_at(node, "the keys 'min' and 'max' of the region to copy", "neither");
    return source;
  }
  source.has_rectangle = true;
  source.min = read_point(*min);
  source.max = read_point(*max);
  if (!(source.min.x < source.max.x && source.min.y < source.max.y))
    throw_at(*max, "a corner to the right of and below 'min'");
  return source;
}

Pattern make_source_pattern(const PatternSource& source, const EditState& frame) {
  const double pitch = source.pixel_pitch_mm > 0 ? source.pixel_pitch_mm : frame.pixel_pitch_mm;
  Pattern pattern = source.image ? make_pattern(*source.image, pitch, frame.channels)
                                 : make_pattern(source.map ? *source.map : frame);
  if (pattern.channels != frame.channels)
    throw_at(source.node, fmt::format("a map with {} channels", frame.channels),
             fmt::format("{}", pattern.channels));
  if (!source.has_rectangle) return pattern;
  const Grid grid{pattern.width, pattern.height, pattern.pixel_pitch_mm};
  pattern.min = to_pixels(source.min, source.unit, grid);
  pattern.max = to_pixels(source.max, source.unit, grid);
  pattern.min = {std::max(pattern.min.x, 0.0), std::max(pattern.min.y, 0.0)};
  pattern.max = {std::min(pattern.max.x, 1.0 * grid.width),
                 std::min(pattern.max.y, 1.0 * grid.height)};
  if (!(pattern.min.x < pattern.max.x && pattern.min.y < pattern.max.y))
    throw_at(source.node,
             fmt::format("a rectangle that meets the source of {:.6g} x {:.6g} mm",
                         grid.width * grid.pixel_pitch_mm, grid.height * grid.pixel_pitch_mm),
             "one outside");
  return pattern;
}

Operation read_paste(const Document& layer, RecipeResources& resources) {
  PasteParams params;
  read_layer_params(layer, describe(params), {"from", "to", "unit"});
  const PatternSource source = read_pattern_source(get(layer, "from"), resources);
  const Unit unit = read_unit(layer);
  const Document* to = find(layer, "to");
  const Point2 given = to == nullptr ? Point2{} : read_point(*to);
  const bool has_place = to != nullptr;
  return {.apply = [=](const LayerContext& context) {
    const Grid grid = grid_of(context.input);
    const Point2 center =
        has_place ? to_pixels(given, unit, grid) : Point2{0.5 * grid.width, 0.5 * grid.height};
    EditState state = context.input;
    apply(params, make_source_pattern(source, context.frame), center, state, context.mask,
          context.report);
    return state;
  }};
}

}  // namespace

OperationKind make_paste_operation() {
  OperationKind kind;
  kind.name = "paste";
  kind.summary = "the pattern of a region, a map or an image, fitted in by its gradients";
  PasteParams defaults;
  kind.keys = keys_of(describe(defaults), {"from", "to", "unit"});
  kind.read = read_paste;
  kind.params = [] {
    const auto params = std::make_shared<PasteParams>();
    return OperationKind::Params{params, describe(*params)};
  };
  return kind;
}

}  // namespace parian

// "adjust": scale, offset and colour of albedo and range. "interpolate": several strokes with
// parameters of their own, propagated and interpolated (SubEdit, section 5.2; AppWand).
#include <fmt/format.h>

#include "edit/adjust.h"
#include "edit/operations.h"
#include "edit/propagation_source_internal.h"
#include "edit/read_parts_internal.h"

namespace parian {
namespace {

// One value or one for each channel.
void check_channels(const Document& node, const Adjust& adjust, int channels) {
  const std::pair<const char*, const std::vector<double>*> lists[] = {
      {"albedo_scale", &adjust.albedo_scale},
      {"albedo_offset", &adjust.albedo_offset},
      {"range_scale", &adjust.range_scale},
      {"range_offset_mm", &adjust.range_offset_mm}};
  for (const auto& [key, values] : lists)
    if (values->size() != 1 && values->size() != static_cast<std::size_t>(channels))
      throw_at(get(node, key), fmt::format("1 value or {}, as the map has channels", channels),
               fmt::format("{}", values->size()));
  if (channels == 1 && !is_identity(adjust.color))
    throw_at(node, "a map with 3 channels for hue, saturation and lightness", "1 channel");
}

Operation read_adjust(const Document& layer, RecipeResources&) {
  Adjust adjust;
  read_layer_params(layer, describe(adjust));
  return {.apply = [layer, adjust](const LayerContext& context) {
    check_channels(layer, adjust, context.input.channels);
    EditState state = context.input;
    apply(adjust, state, context.mask, context.report);
    return state;
  }};
}

struct Strokes {
  std::vector<Adjust> adjusts;
  std::vector<Document> nodes;
};

Operation read_interpolate(const Document& layer, RecipeResources& resources) {
  Strokes strokes;
  const Document& list = get(layer, "strokes");
  PropagationSource source = read_propagation(layer, list, resources, [&](const Document& node) {
    Adjust adjust;
    read_params(node, describe(adjust), stroke_keys());
    strokes.adjusts.push_back(adjust);
    strokes.nodes.push_back(node);
  });
  return {.apply = [strokes, source](const LayerContext& context) {
    for (std::size_t s = 0; s < strokes.nodes.size(); ++s)
      check_channels(strokes.nodes[s], strokes.adjusts[s], context.input.channels);
    std::vector<Mask> masks =
        propagate_each(source, {context.frame, context.input, context.cache, context.progress});
    for (Mask& mask : masks)
      for (std::size_t i = 0; i < mask.weight.size(); ++i) mask.weight[i] *= context.mask.weight[i];
    EditState state = context.input;
    apply(strokes.adjusts, state, masks, context.report);
    return state;
  }};
}

}  // namespace

OperationKind make_adjust_operation() {
  OperationKind kind;
  kind.name = "adjust";
  kind.summary = "scale and offset of albedo and range, hue, saturation and lightness";
  Adjust defaults;
  kind.keys = keys_of(describe(defaults));
  kind.read = read_adjust;
  kind.params = [] {
    const auto adjust = std::make_shared<Adjust>();
    return OperationKind::Params{adjust, describe(*adjust)};
  };
  return kind;
}

OperationKind make_interpolate_operation() {
  OperationKind kind;
  kind.name = "interpolate";
  kind.summary = "strokes with parameters of their own, interpolated over like-looking pixels";
  kind.keys = propagation_keys({"strokes"});
  kind.read = read_interpolate;
  kind.params = make_propagation_params;
  return kind;
}

}  // namespace parian

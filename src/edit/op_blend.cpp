// "blend": material painting with a profile, or with another map pixel by pixel.
#include "edit/blend.h"

#include <cmath>

#include "edit/operations.h"
#include "edit/read_parts_internal.h"

namespace parian {
namespace {

// The source's pixel at the same place in mm; the source goes on mirrored beyond its borders.
std::vector<std::uint32_t> align_pixels(const EditState& source, const EditState& state) {
  std::vector<std::uint32_t> pixels;
  pixels.reserve(state.pixels());
  const double ratio = state.pixel_pitch_mm / source.pixel_pitch_mm;
  const auto reflect = [](double at, int size) {
    const int i = static_cast<int>(std::fmod(at, 2.0 * size));
    return i < size ? i : 2 * size - 1 - i;
  };
  for (int y = 0; y < state.height; ++y)
    for (int x = 0; x < state.width; ++x) {
      const int sx = reflect((x + 0.5) * ratio, source.width);
      const int sy = reflect((y + 0.5) * ratio, source.height);
      pixels.push_back(static_cast<std::uint32_t>(sy * source.width + sx));
    }
  return pixels;
}

Operation read_blend(const Document& layer, RecipeResources& resources) {
  BlendAmounts amounts;
  read_layer_params(layer, describe(amounts), {"from"});
  const ProfileSource source = read_profile_source(get(layer, "from"), resources);
  return {.apply = [amounts, source](const LayerContext& context) {
    EditState state = context.input;
    if (source.has_place) {
      apply(amounts, get_source_profile(source, context.frame), {}, state, context.mask,
            context.report);
    } else {
      const EditState from = get_source_map(source, context.frame);
      apply(amounts, from, align_pixels(from, state), state, context.mask, context.report);
    }
    return state;
  }};
}

}  // namespace

OperationKind make_blend_operation() {
  OperationKind kind;
  kind.name = "blend";
  kind.summary = "mixes in albedo, range and shape of a picked profile or of another map";
  BlendAmounts defaults;
  kind.keys = keys_of(describe(defaults), {"from"});
  kind.read = read_blend;
  kind.params = [] {
    const auto amounts = std::make_shared<BlendAmounts>();
    return OperationKind::Params{amounts, describe(*amounts)};
  };
  return kind;
}

}  // namespace parian

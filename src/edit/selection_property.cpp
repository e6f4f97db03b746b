#include "edit/selection_property.h"

#include <cmath>
#include <numbers>

#include "image/color_spaces.h"

namespace parian {
namespace {

Plane eval_color(const EditState& state, SelectionProperty property) {
  const std::size_t pixels = state.pixels();
  const Plane albedo = albedo_plane(state);
  Plane values(pixels, 0.0);
  for (std::size_t i = 0; i < pixels; ++i) {
    Color rgb;
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = albedo[(state.channels == 3 ? c : 0) * pixels + i];
    const Color lch = oklab_to_oklch(linear_to_oklab(rgb));
    const double degrees = lch[2] * 180 / std::numbers::pi;
    values[i] = property == SelectionProperty::lightness ? lch[0]
                : property == SelectionProperty::chroma  ? lch[1]
                                                         : std::fmod(degrees + 360, 360.0);
  }
  return values;
}

}  // namespace

const std::vector<std::string>& selection_property_names() {
  static const std::vector<std::string> names{"albedo",    "range",  "mean_radius",
                                              "lightness", "chroma", "hue_deg"};
  return names;
}

Plane eval_selection_property(const EditState& state, SelectionProperty property, int channel) {
  if (property >= SelectionProperty::lightness) return eval_color(state, property);
  const std::size_t pixels = state.pixels();
  Plane values(pixels, 0.0);
  const Plane plane = property == SelectionProperty::albedo  ? albedo_plane(state)
                      : property == SelectionProperty::range ? range_plane(state)
                                                             : mean_radius_plane(state);
  const int first = channel < 0 ? 0 : channel, end = channel < 0 ? state.channels : channel + 1;
  for (int c = first; c < end; ++c)
    for (std::size_t i = 0; i < pixels; ++i)
      values[i] += plane[static_cast<std::size_t>(c) * pixels + i] / (end - first);
  return values;
}

}  // namespace parian

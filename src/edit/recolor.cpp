#include "edit/recolor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "image/color_spaces.h"

namespace parian {
namespace {

bool is_negative(const Color& rgb) {
  return rgb[0] < 0 || rgb[1] < 0 || rgb[2] < 0;
}

// A recolouring by a part: a turn and a factor of (a, b), a factor of L.
struct Change {
  double cosine, sine, lightness;
};

Change make_change(const Recolor& recolor, double amount) {
  const double turn = amount * recolor.hue_deg * std::numbers::pi / 180;
  const double chroma = 1 + amount * (recolor.saturation - 1);
  const double lightness = 1 + amount * (recolor.lightness - 1);
  // Chroma follows lightness, so that darker is not more saturated.
  const double scale = chroma * lightness;
  return {scale * std::cos(turn), scale * std::sin(turn), lightness};
}

Color change_color(const Color& albedo, const Change& change) {
  Color oklab = linear_to_oklab(albedo);
  oklab = {change.lightness * oklab[0], change.cosine * oklab[1] - change.sine * oklab[2],
           change.sine * oklab[1] + change.cosine * oklab[2]};
  Color rgb = oklab_to_linear(oklab);
  if (!is_negative(rgb)) return rgb;
  const double part = find_possible_chroma(oklab);
  rgb = oklab_to_linear({oklab[0], part * oklab[1], part * oklab[2]});
  for (double& value : rgb) value = std::max(0.0, value);  // of rounding
  return rgb;
}

}  // namespace

ParamList describe(Recolor& recolor) {
  return {{.name = "hue-deg",
           .help = "added to the albedo's hue",
           .target = &recolor.hue_deg,
           .min = -360,
           .max = 360,
           .unit = "degrees"},
          {.name = "saturation",
           .help = "factor on the albedo's chroma",
           .target = &recolor.saturation,
           .min = 0,
           .max = 10},
          {.name = "lightness",
           .help = "factor on the albedo's lightness",
           .target = &recolor.lightness,
           .min = 0,
           .max = 10}};
}

bool is_identity(const Recolor& recolor) {
  return recolor.hue_deg == 0 && recolor.saturation == 1 && recolor.lightness == 1;
}

void recolor_planes(double* albedo, std::size_t pixels, const Recolor& recolor,
                    const float* amount) {
  if (is_identity(recolor)) return;
  const Change whole = make_change(recolor, 1);
  parallel_for_blocks(pixels, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (amount[i] == 0) continue;
      const Color rgb = change_color(
          {albedo[i], albedo[pixels + i], albedo[2 * pixels + i]},
          amount[i] == 1 ? whole : make_change(recolor, static_cast<double>(amount[i])));
      for (std::size_t c = 0; c < 3; ++c) albedo[c * pixels + i] = rgb[c];
    }
  });
}

}  // namespace parian

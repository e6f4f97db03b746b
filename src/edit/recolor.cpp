#include "edit/recolor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"

namespace parian {
namespace {

bool is_negative(const Color& rgb) {
  return rgb[0] < 0 || rgb[1] < 0 || rgb[2] < 0;
}

// The largest part of the chroma with which no channel is negative.
Color reduce_chroma(const Color& oklab) {
  double low = 0, high = 1;
  for (int i = 0; i < 24; ++i) {
    const double middle = 0.5 * (low + high);
    const bool outside =
        is_negative(oklab_to_linear({oklab[0], middle * oklab[1], middle * oklab[2]}));
    (outside ? high : low) = middle;
  }
  Color rgb = oklab_to_linear({oklab[0], low * oklab[1], low * oklab[2]});
  for (double& value : rgb) value = std::max(0.0, value);
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

Color recolor_albedo(const Color& albedo, const Recolor& recolor, double amount) {
  if (amount == 0 || is_identity(recolor)) return albedo;
  Color oklab = linear_to_oklab(albedo);
  const double turn = amount * recolor.hue_deg * std::numbers::pi / 180;
  const double c = std::cos(turn), s = std::sin(turn);
  const double chroma = 1 + amount * (recolor.saturation - 1);
  const double lightness = 1 + amount * (recolor.lightness - 1);
  // Chroma follows lightness, so that darker is not more saturated.
  const double scale = chroma * lightness;
  oklab = {lightness * oklab[0], scale * (c * oklab[1] - s * oklab[2]),
           scale * (s * oklab[1] + c * oklab[2])};
  const Color rgb = oklab_to_linear(oklab);
  return is_negative(rgb) ? reduce_chroma(oklab) : rgb;
}

void recolor_planes(double* albedo, std::size_t pixels, const Recolor& recolor,
                    const float* amount) {
  parallel_for_blocks(pixels, 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Color rgb = recolor_albedo({albedo[i], albedo[pixels + i], albedo[2 * pixels + i]},
                                       recolor, static_cast<double>(amount[i]));
      for (std::size_t c = 0; c < 3; ++c) albedo[c * pixels + i] = rgb[c];
    }
  });
}

}  // namespace parian

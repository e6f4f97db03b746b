#include "app/report/false_color.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "image/color.h"

namespace parian {
namespace {

// sRGB-encoded stops at equal steps; lightness rises evenly.
constexpr std::array<std::array<float, 3>, 6> stops{{{0.00f, 0.00f, 0.05f},
                                                     {0.22f, 0.06f, 0.38f},
                                                     {0.55f, 0.14f, 0.42f},
                                                     {0.84f, 0.30f, 0.28f},
                                                     {0.97f, 0.60f, 0.16f},
                                                     {0.99f, 0.98f, 0.72f}}};

float false_color(double part, std::size_t channel) {
  const double place = std::clamp(part, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  const float t = static_cast<float>(place - static_cast<double>(low));
  return decode_srgb((1 - t) * stops[low][channel] + t * stops[low + 1][channel]);
}

}  // namespace

double largest_value(const Image& values) {
  double largest = 0;
  for (float value : values.values)
    if (std::isfinite(value)) largest = std::max(largest, static_cast<double>(value));
  return largest;
}

Image draw_false_color(const Image& values, double scale) {
  PARIAN_CHECK_EQ(values.channels, 1);
  const double top = scale > 0 ? scale : largest_value(values);
  Image image = make_image(values.width, values.height, 3, decode_srgb(0.5f));
  for (std::size_t i = 0; i < values.values.size(); ++i)
    for (std::size_t c = 0; c < 3 && std::isfinite(values.values[i]); ++c)
      image.values[3 * i + c] =
          false_color(top > 0 ? static_cast<double>(values.values[i]) / top : 0, c);
  return image;
}

Image absolute_difference(const Image& a, const Image& b) {
  PARIAN_CHECK_EQ(a.values.size(), b.values.size());
  Image difference = a;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    difference.values[i] = std::abs(a.values[i] - b.values[i]);
  return difference;
}

}  // namespace parian

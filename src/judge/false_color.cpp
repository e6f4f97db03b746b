#include "judge/false_color.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "base/check.h"
#include "image/color.h"
#include "judge/canvas.h"
#include "judge/plot.h"

namespace parian {
namespace {

constexpr Color missing_color{0.22f, 0.22f, 0.22f}, ink{0.012f, 0.014f, 0.02f};

void copy_into(Image& image, const Image& part, int left, int top) {
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x)
      for (int c = 0; c < 3; ++c) at(image, left + x, top + y, c) = at(part, x, y, c);
}

}  // namespace

std::array<float, 3> map_color(double value) {
  // Control points in sRGB, equally spaced.
  constexpr float points[][3] = {
      {0.20f, 0.05f, 0.32f}, {0.24f, 0.24f, 0.53f}, {0.17f, 0.42f, 0.56f}, {0.12f, 0.58f, 0.54f},
      {0.28f, 0.74f, 0.43f}, {0.64f, 0.86f, 0.27f}, {0.98f, 0.93f, 0.30f}};
  constexpr int last = static_cast<int>(std::size(points)) - 1;
  const double t = std::clamp(value, 0.0, 1.0) * last;
  const int i = std::min(static_cast<int>(t), last - 1);
  const float w = static_cast<float>(t - i);
  Color color;
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = decode_srgb(points[i][c] + w * (points[i + 1][c] - points[i][c]));
  return color;
}

Image false_color(const Image& values, double max) {
  PARIAN_CHECK_LT(0, max);
  Image image = make_image(values.width, values.height, 3);
  for (int y = 0; y < values.height; ++y)
    for (int x = 0; x < values.width; ++x) {
      const double value = at(values, x, y, 0);
      const Color color = std::isnan(value) ? missing_color : map_color(value / max);
      for (int c = 0; c < 3; ++c) at(image, x, y, c) = color[static_cast<std::size_t>(c)];
    }
  return image;
}

Image draw_color_map(const Image& values, double max, int magnification, const std::string& title) {
  constexpr int pad = 12, top = 36, bar_width = 16;
  constexpr double scale = 1.5;
  const Image picture = magnify(false_color(values, max), magnification);
  const std::vector<double> ticks = plot_ticks(0, max, false);
  double widest = 0;
  for (const double tick : ticks) widest = std::max(widest, text_width(format_tick(tick), scale));
  const int bar = pad + picture.width + pad;
  const int width = std::max(bar + bar_width + 8 + static_cast<int>(std::ceil(widest)) + pad,
                             static_cast<int>(text_width(title, 2)) + 2 * pad);
  Image image = make_image(width, picture.height + top + pad, 3, 1);
  draw_text(image, {pad, 12}, title, 2, ink);
  copy_into(image, picture, pad, top);
  for (int y = 0; y < picture.height; ++y)
    fill_box(image, {1.0 * bar, 1.0 * top + y, 1.0 * bar + bar_width, top + y + 1.0},
             map_color(1 - (y + 0.5) / picture.height));
  for (const double tick : ticks) {
    const double y = std::round(top + (1 - tick / max) * picture.height);
    fill_box(image, {1.0 * bar + bar_width, y - 0.5, bar + bar_width + 4.0, y + 0.5}, ink);
    draw_text(image, {bar + bar_width + 7.0, y - std::floor(text_height(scale) / 2)},
              format_tick(tick), scale, ink);
  }
  return image;
}

}  // namespace parian

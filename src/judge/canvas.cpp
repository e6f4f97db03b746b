#include "judge/canvas.h"

#include <stb_easy_font.h>

#include <algorithm>
#include <cmath>

namespace parian {
namespace {

void blend(Image& image, int x, int y, Color color, double coverage) {
  for (int c = 0; c < 3; ++c) {
    float& value = at(image, x, y, c);
    value += static_cast<float>(coverage) * (color[static_cast<std::size_t>(c)] - value);
  }
}

// Length of [a, b] within the pixel [i, i + 1].
double overlap(double a, double b, int i) {
  return std::clamp(std::min(b, i + 1.0) - std::max(a, static_cast<double>(i)), 0.0, 1.0);
}

struct PixelBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

// The pixels of the image that the box touches.
PixelBox touched(const Image& image, Box box) {
  const auto bound = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  return {bound(std::floor(box.x0), image.width), bound(std::floor(box.y0), image.height),
          bound(std::ceil(box.x1), image.width), bound(std::ceil(box.y1), image.height)};
}

Box intersect(Box a, Box b) {
  return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

double distance_to_segment(Point p, Point a, Point b) {
  const double ux = b.x - a.x, uy = b.y - a.y, vx = p.x - a.x, vy = p.y - a.y;
  const double length2 = ux * ux + uy * uy;
  const double t = length2 > 0 ? std::clamp((ux * vx + uy * vy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(vx - t * ux, vy - t * uy);
}

// Coverage of a pixel whose centre is `distance` from the spine of a stroke.
double stroke_coverage(double distance, double half_width) {
  return std::clamp(half_width + 0.5 - distance, 0.0, 1.0);
}

std::string printable(const std::string& text) {
  std::string clean = text;
  for (char& c : clean)
    if (c < 32 || c > 126) c = '?';
  return clean;
}

struct FontVertex {
  float x, y, z;
  unsigned char color[4];
};

}  // namespace

void fill_box(Image& image, Box box, Color color, double alpha) {
  const PixelBox pixels = touched(image, box);
  for (int y = pixels.y0; y < pixels.y1; ++y)
    for (int x = pixels.x0; x < pixels.x1; ++x)
      blend(image, x, y, color, alpha * overlap(box.x0, box.x1, x) * overlap(box.y0, box.y1, y));
}

void draw_dot(Image& image, Point centre, double radius, Color color, double alpha, Box clip) {
  const double reach = radius + 1;
  const PixelBox pixels = touched(image, intersect(clip, {centre.x - reach, centre.y - reach,
                                                          centre.x + reach, centre.y + reach}));
  for (int y = pixels.y0; y < pixels.y1; ++y)
    for (int x = pixels.x0; x < pixels.x1; ++x) {
      const double distance = std::hypot(x + 0.5 - centre.x, y + 0.5 - centre.y);
      blend(image, x, y, color, alpha * stroke_coverage(distance, radius));
    }
}

void draw_polyline(Image& image, const std::vector<Point>& points, double width, Color color,
                   Box clip) {
  std::vector<float> coverage(static_cast<std::size_t>(image.width) *
                              static_cast<std::size_t>(image.height));
  const auto cover = [&](int x, int y) -> float& {
    return coverage[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                    static_cast<std::size_t>(x)];
  };
  const double reach = width / 2 + 1;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Point a = points[i], b = points[i + 1];
    const PixelBox pixels =
        touched(image, intersect(clip, {std::min(a.x, b.x) - reach, std::min(a.y, b.y) - reach,
                                        std::max(a.x, b.x) + reach, std::max(a.y, b.y) + reach}));
    for (int y = pixels.y0; y < pixels.y1; ++y)
      for (int x = pixels.x0; x < pixels.x1; ++x) {
        const double distance = distance_to_segment({x + 0.5, y + 0.5}, a, b);
        cover(x, y) =
            std::max(cover(x, y), static_cast<float>(stroke_coverage(distance, width / 2)));
      }
  }
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (cover(x, y) > 0) blend(image, x, y, color, cover(x, y));
}

void draw_text(Image& image, Point at, const std::string& text, double scale, Color color,
               bool vertical) {
  std::string clean = printable(text);
  // A character has fewer than 32 quads of 4 vertices.
  std::vector<FontVertex> vertices(clean.size() * 128);
  const int quads = stb_easy_font_print(0, 0, clean.data(), nullptr, vertices.data(),
                                        static_cast<int>(vertices.size() * sizeof(FontVertex)));
  for (std::size_t q = 0; q < static_cast<std::size_t>(quads); ++q) {
    const FontVertex &a = vertices[4 * q], &b = vertices[4 * q + 2];
    const Box box =
        vertical
            ? Box{at.x + scale * a.y, at.y - scale * b.x, at.x + scale * b.y, at.y - scale * a.x}
            : Box{at.x + scale * a.x, at.y + scale * a.y, at.x + scale * b.x, at.y + scale * b.y};
    fill_box(image, box, color);
  }
}

double text_width(const std::string& text, double scale) {
  std::string clean = printable(text);
  return scale * stb_easy_font_width(clean.data());
}

}  // namespace parian

#include "edit/mask_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"

namespace parian {
namespace {

constexpr int grid = 4;  // points per side of a pixel

struct Box {
  double x0, y0, x1, y1;
};

double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

int clamp_to(double value, int size) {
  return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
}

// weight(x, y) in [0, 1], averaged over the points of each pixel that the box touches.
template <typename Weight>
void draw(Mask& mask, const Box& box, const Weight& weight) {
  const int x0 = clamp_to(std::floor(box.x0), mask.width), x1 = clamp_to(box.x1 + 1, mask.width);
  const int y0 = clamp_to(std::floor(box.y0), mask.height), y1 = clamp_to(box.y1 + 1, mask.height);
  if (y0 >= y1) return;
  parallel_for(static_cast<std::size_t>(y1 - y0), [&](std::size_t row) {
    const int y = y0 + static_cast<int>(row);
    for (int x = x0; x < x1; ++x) {
      double sum = 0;
      for (int j = 0; j < grid; ++j)
        for (int i = 0; i < grid; ++i) sum += weight(x + (i + 0.5) / grid, y + (j + 0.5) / grid);
      float& value =
          mask.weight[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                      static_cast<std::size_t>(x)];
      value = std::max(value, static_cast<float>(sum / (grid * grid)));
    }
  });
}

Box box_of(const std::vector<Point2>& points, double margin) {
  Box box{points[0].x, points[0].y, points[0].x, points[0].y};
  for (const Point2& p : points)
    box = {std::min(box.x0, p.x), std::min(box.y0, p.y), std::max(box.x1, p.x),
           std::max(box.y1, p.y)};
  return {box.x0 - margin, box.y0 - margin, box.x1 + margin, box.y1 + margin};
}

double distance_to_segment(double x, double y, Point2 a, Point2 b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double t =
      length2 > 0 ? std::clamp(((x - a.x) * dx + (y - a.y) * dy) / length2, 0.0, 1.0) : 0;
  return std::hypot(x - a.x - t * dx, y - a.y - t * dy);
}

}  // namespace

void draw_rectangle(Mask& mask, Point2 min, Point2 max) {
  draw(mask, {min.x, min.y, max.x, max.y}, [&](double x, double y) {
    return x >= min.x && x < max.x && y >= min.y && y < max.y ? 1.0 : 0.0;
  });
}

void draw_ellipse(Mask& mask, Point2 center, Point2 radii, double rotation_deg) {
  const double angle = rotation_deg * std::numbers::pi / 180;
  const double c = std::cos(angle), s = std::sin(angle), reach = std::max(radii.x, radii.y);
  draw(mask, box_of({center}, reach), [&](double x, double y) {
    const double dx = x - center.x, dy = y - center.y;
    return std::hypot((c * dx + s * dy) / radii.x, (c * dy - s * dx) / radii.y) < 1 ? 1.0 : 0.0;
  });
}

void draw_polygon(Mask& mask, const std::vector<Point2>& points) {
  if (points.size() < 3) return;
  draw(mask, box_of(points, 0), [&](double x, double y) {
    bool inside = false;
    for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++) {
      const Point2 &a = points[i], &b = points[j];
      if ((a.y > y) != (b.y > y) && x < a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y))
        inside = !inside;
    }
    return inside ? 1.0 : 0.0;
  });
}

void draw_stroke(Mask& mask, const std::vector<Point2>& points, double radius, double hardness) {
  if (points.empty() || !(radius > 0)) return;
  const double core = std::clamp(hardness, 0.0, 1.0) * radius;
  const auto of_segment = [&](Point2 a, Point2 b) {
    draw(mask, box_of({a, b}, radius), [&](double x, double y) {
      const double distance = distance_to_segment(x, y, a, b);
      if (distance >= radius) return 0.0;
      return distance <= core ? 1.0 : smooth((radius - distance) / (radius - core));
    });
  };
  if (points.size() == 1) return of_segment(points[0], points[0]);
  for (std::size_t i = 1; i < points.size(); ++i) of_segment(points[i - 1], points[i]);
}

void draw_gradient(Mask& mask, Point2 from, Point2 to) {
  const double dx = to.x - from.x, dy = to.y - from.y, length2 = dx * dx + dy * dy;
  if (!(length2 > 0)) return;
  draw(mask, {0, 0, static_cast<double>(mask.width), static_cast<double>(mask.height)},
       [&](double x, double y) {
         return smooth(((x - from.x) * dx + (y - from.y) * dy) / length2);
       });
}

}  // namespace parian

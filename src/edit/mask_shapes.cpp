#include "edit/mask_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/hot.h"
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

struct PixelBox {
  int x0, y0, x1, y1;
};

// The pixels that a box touches.
PixelBox pixels_of(const Mask& mask, const Box& box) {
  PARIAN_CHECK(std::isfinite(box.x0) && std::isfinite(box.x1));
  PARIAN_CHECK(std::isfinite(box.y0) && std::isfinite(box.y1));
  return {clamp_to(std::floor(box.x0), mask.width), clamp_to(std::floor(box.y0), mask.height),
          clamp_to(box.x1 + 1, mask.width), clamp_to(box.y1 + 1, mask.height)};
}

// Calls body(y, row) for the rows of the box.
template <typename Body>
void for_rows(Mask& mask, const PixelBox& box, const Body& body) {
  if (box.y0 >= box.y1 || box.x0 >= box.x1) return;
  parallel_for(static_cast<std::size_t>(box.y1 - box.y0), [&](std::size_t i) {
    const int y = box.y0 + static_cast<int>(i);
    body(y, &mask.weight[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width)]);
  });
}

// A point's place from its number along a line of points.
double place_of(int point) {
  return (point + 0.5) / grid;
}

void raise(float& weight, double sum) {
  weight = std::max(weight, static_cast<float>(sum / (grid * grid)));
}

// weight(x, y) in [0, 1], averaged over the points of each pixel that the box touches.
template <typename Weight>
void draw(Mask& mask, const Box& box, const Weight& weight) {
  const PixelBox pixels = pixels_of(mask, box);
  for_rows(mask, pixels, [&](int y, float* row) {
    for (int x = pixels.x0; x < pixels.x1; ++x) {
      double sum = 0;
      for (int j = 0; j < grid; ++j)
        for (int i = 0; i < grid; ++i)
          sum += weight(place_of(grid * x + i), place_of(grid * y + j));
      raise(row[x], sum);
    }
  });
}

Box box_of(const std::vector<Point2>& points, double margin) {
  Box box{points[0].x, points[0].y, points[0].x, points[0].y};
  for (const Point2& p : points) {
    PARIAN_CHECK(std::isfinite(p.x) && std::isfinite(p.y));
    box = {std::min(box.x0, p.x), std::min(box.y0, p.y), std::max(box.x1, p.x),
           std::max(box.y1, p.y)};
  }
  return {box.x0 - margin, box.y0 - margin, box.x1 + margin, box.y1 + margin};
}

// Where the edges of a polygon cross the line at y, in ascending order.
void find_crossings(const std::vector<Point2>& points, double y, std::vector<double>& crossings) {
  crossings.clear();
  for (std::size_t i = 0, j = points.size() - 1; i < points.size(); j = i++) {
    const Point2 &a = points[i], &b = points[j];
    if ((a.y > y) != (b.y > y)) crossings.push_back(std::lerp(a.x, b.x, (y - a.y) / (b.y - a.y)));
  }
  std::sort(crossings.begin(), crossings.end());
}

struct Segment {
  double x, y, dx, dy, inverse_length2;  // 0 for a point
};

std::vector<Segment> make_segments(const std::vector<Point2>& points) {
  std::vector<Segment> segments;
  segments.reserve(points.size());
  for (std::size_t i = points.size() > 1 ? 1 : 0; i < points.size(); ++i) {
    const Point2 &a = points[i > 0 ? i - 1 : 0], &b = points[i];
    const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
    segments.push_back({a.x, a.y, dx, dy, length2 > 0 ? 1 / length2 : 0});
  }
  return segments;
}

// Lowers squared distances of the points [begin, end) of the line at y to those to a segment.
PARIAN_HOT void lower_distances(double x, double y, double dx, double dy, double inverse_length2,
                                int begin, int end, double* PARIAN_RESTRICT distance2) {
  for (int i = begin; i < end; ++i) {
    const double px = (i + 0.5) * (1.0 / grid) - x, py = y;
    double t = (px * dx + py * dy) * inverse_length2;
    t = t > 0 ? t : 0;
    t = t < 1 ? t : 1;
    const double ex = px - t * dx, ey = py - t * dy, value = ex * ex + ey * ey;
    distance2[i] = value < distance2[i] ? value : distance2[i];
  }
}

// Squared distances of the points in [first, last) of the line at y to the nearest segment, where
// they are below radius^2.
void find_distances(const std::vector<Segment>& segments, double y, double radius, int first,
                    int last, double* distance2) {
  std::fill(distance2 + first, distance2 + last, radius * radius);
  for (const Segment& s : segments) {
    if (std::max(s.y, s.y + s.dy) + radius < y || std::min(s.y, s.y + s.dy) - radius > y) continue;
    const double low = grid * (std::min(s.x, s.x + s.dx) - radius);
    const double high = grid * (std::max(s.x, s.x + s.dx) + radius);
    lower_distances(s.x, y - s.y, s.dx, s.dy, s.inverse_length2,
                    std::max(first, clamp_to(std::floor(low), last)), clamp_to(high + 1, last),
                    distance2);
  }
}

}  // namespace

void draw_rectangle(Mask& mask, Point2 min, Point2 max) {
  draw(mask, {min.x, min.y, max.x, max.y}, [&](double x, double y) {
    return x >= min.x && x < max.x && y >= min.y && y < max.y ? 1.0 : 0.0;
  });
}

void draw_ellipse(Mask& mask, Point2 center, Point2 radii, double rotation_deg) {
  if (!(radii.x > 0 && radii.y > 0)) return;
  const double angle = rotation_deg * std::numbers::pi / 180;
  const double c = std::cos(angle), s = std::sin(angle), reach = std::max(radii.x, radii.y);
  draw(mask, box_of({center}, reach), [&](double x, double y) {
    const double dx = x - center.x, dy = y - center.y;
    const double u = (c * dx + s * dy) / radii.x, v = (c * dy - s * dx) / radii.y;
    return u * u + v * v < 1 ? 1.0 : 0.0;
  });
}

void draw_polygon(Mask& mask, const std::vector<Point2>& points) {
  if (points.size() < 3) return;
  const PixelBox pixels = pixels_of(mask, box_of(points, 0));
  for_rows(mask, pixels, [&](int y, float* row) {
    std::vector<double> crossings;
    // How many more lines are inside from a point on than before it.
    std::vector<int> change(static_cast<std::size_t>(grid * mask.width) + 1);
    for (int j = 0; j < grid; ++j) {
      find_crossings(points, place_of(grid * y + j), crossings);
      for (std::size_t k = 0; k < crossings.size(); ++k)
        change[static_cast<std::size_t>(clamp_to(std::ceil(grid * crossings[k] - 0.5),
                                                 grid * mask.width))] += k % 2 == 0 ? 1 : -1;
    }
    int inside = 0;
    for (int x = 0; x < pixels.x1; ++x) {
      int sum = 0;
      for (int i = 0; i < grid; ++i)
        sum += inside += change[static_cast<std::size_t>(grid * x + i)];
      raise(row[x], sum);
    }
  });
}

void draw_stroke(Mask& mask, const std::vector<Point2>& points, double radius, double hardness) {
  if (points.empty() || !(radius > 0)) return;
  const double core = hardness > 0 ? std::min(hardness, 1.0) * radius : 0;
  const PixelBox pixels = pixels_of(mask, box_of(points, radius));
  const std::vector<Segment> segments = make_segments(points);
  const auto weight_of = [&](double distance2) {
    if (distance2 >= radius * radius) return 0.0;
    const double distance = std::sqrt(distance2);
    return distance <= core ? 1.0 : smooth((radius - distance) / (radius - core));
  };
  for_rows(mask, pixels, [&](int y, float* row) {
    std::vector<double> sums(static_cast<std::size_t>(mask.width));
    std::vector<double> distance2(static_cast<std::size_t>(grid * mask.width));
    for (int j = 0; j < grid; ++j) {
      find_distances(segments, place_of(grid * y + j), radius, grid * pixels.x0, grid * pixels.x1,
                     distance2.data());
      for (int i = grid * pixels.x0; i < grid * pixels.x1; ++i)
        sums[static_cast<std::size_t>(i / grid)] +=
            weight_of(distance2[static_cast<std::size_t>(i)]);
    }
    for (int x = pixels.x0; x < pixels.x1; ++x) raise(row[x], sums[static_cast<std::size_t>(x)]);
  });
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

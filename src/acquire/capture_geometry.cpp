#include "acquire/capture_geometry.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/error.h"

namespace parian {
namespace {

using Matrix3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

Eigen::Map<const Matrix3> matrix_of(const Homography& h) {
  return Eigen::Map<const Matrix3>(h.m.data());
}

// Moves the mean to 0 and the mean distance to sqrt(2).
Matrix3 make_normalisation(const std::vector<Point>& points) {
  const auto count = static_cast<double>(points.size());
  double x = 0, y = 0, distance = 0;
  for (const Point& point : points) x += point.x / count, y += point.y / count;
  for (const Point& point : points) distance += std::hypot(point.x - x, point.y - y) / count;
  const double s = std::sqrt(2.0) / std::max(distance, 1e-12);
  Matrix3 matrix;
  matrix << s, 0, -s * x, 0, s, -s * y, 0, 0, 1;
  return matrix;
}

struct Region {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
  int pixels = 0;
};

// Fills the region around a pixel above the threshold and marks it as seen.
Region fill_region(const Image& image, float threshold, int x, int y,
                   std::vector<unsigned char>& seen) {
  Region region{x, x, y, y, 0};
  std::vector<std::pair<int, int>> stack{{x, y}};
  const auto visit = [&](int px, int py) {
    if (px < 0 || py < 0 || px >= image.width || py >= image.height) return;
    const std::size_t i = static_cast<std::size_t>(py) * static_cast<std::size_t>(image.width) +
                          static_cast<std::size_t>(px);
    if (seen[i] != 0 || !(image.values[i] > threshold)) return;
    seen[i] = 1;
    stack.emplace_back(px, py);
  };
  seen[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
       static_cast<std::size_t>(x)] = 1;
  while (!stack.empty()) {
    const auto [px, py] = stack.back();
    stack.pop_back();
    region.x0 = std::min(region.x0, px), region.x1 = std::max(region.x1, px);
    region.y0 = std::min(region.y0, py), region.y1 = std::max(region.y1, py);
    ++region.pixels;
    visit(px - 1, py), visit(px + 1, py), visit(px, py - 1), visit(px, py + 1);
  }
  return region;
}

// Centroid over the region's box and as much again around it, as far as two pixels.
Dot measure_dot(const Image& image, const Region& region) {
  Dot dot;
  for (int y = std::max(0, region.y0 - 2); y <= std::min(image.height - 1, region.y1 + 2); ++y)
    for (int x = std::max(0, region.x0 - 2); x <= std::min(image.width - 1, region.x1 + 2); ++x) {
      const double value = std::max(0.0f, at(image, x, y, 0));
      dot.x += value * (x + 0.5);
      dot.y += value * (y + 0.5);
      dot.power += value;
    }
  dot.x /= dot.power;
  dot.y /= dot.power;
  return dot;
}

// The mean step from a dot to its nearest neighbour in a cone of 40 degrees around an axis.
Point find_step(const std::vector<Dot>& dots, bool along_x) {
  const double cone = std::tan(40.0 / 180 * 3.141592653589793);
  std::vector<Point> steps;
  for (const Dot& from : dots) {
    Point best;
    double shortest = std::numeric_limits<double>::infinity();
    for (const Dot& to : dots) {
      const double dx = to.x - from.x, dy = to.y - from.y;
      const double ahead = along_x ? dx : dy, aside = along_x ? dy : dx;
      const double length = std::hypot(dx, dy);
      if (ahead > 0 && std::abs(aside) <= cone * ahead && length < shortest)
        best = {dx, dy}, shortest = length;
    }
    if (std::isfinite(shortest)) steps.push_back(best);
  }
  if (steps.empty()) return {};
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end(), [](const Point& a, const Point& b) {
    return std::hypot(a.x, a.y) < std::hypot(b.x, b.y);
  });
  return *middle;
}

// The dot nearest to a place, or -1 when none is within `reach`.
int nearest_dot(const std::vector<Dot>& dots, double x, double y, double reach) {
  int best = -1;
  for (std::size_t i = 0; i < dots.size(); ++i) {
    const double distance = std::hypot(dots[i].x - x, dots[i].y - y);
    if (distance < reach) best = static_cast<int>(i), reach = distance;
  }
  return best;
}

// Lattice coordinates of the dots, walked from neighbour to neighbour from the first one.
std::map<std::pair<int, int>, int> walk_lattice(const std::vector<Dot>& dots) {
  const Point u = find_step(dots, true), v = find_step(dots, false);
  const double reach = 0.3 * std::min(std::hypot(u.x, u.y), std::hypot(v.x, v.y));
  std::map<std::pair<int, int>, int> places{{{0, 0}, 0}};
  std::vector<bool> used(dots.size());
  used[0] = true;
  std::vector<std::pair<int, int>> stack{{0, 0}};
  while (!stack.empty()) {
    const auto [i, j] = stack.back();
    stack.pop_back();
    const Dot& from = dots[static_cast<std::size_t>(places[{i, j}])];
    for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int next =
          nearest_dot(dots, from.x + di * u.x + dj * v.x, from.y + di * u.y + dj * v.y, reach);
      if (next < 0 || used[static_cast<std::size_t>(next)]) continue;
      used[static_cast<std::size_t>(next)] = true;
      places[{i + di, j + dj}] = next;
      stack.emplace_back(i + di, j + dj);
    }
  }
  return places;
}

}  // namespace

Point apply(const Homography& h, double x, double y) {
  const double w = h.m[6] * x + h.m[7] * y + h.m[8];
  return {(h.m[0] * x + h.m[1] * y + h.m[2]) / w, (h.m[3] * x + h.m[4] * y + h.m[5]) / w};
}

Homography invert(const Homography& h) {
  const Matrix3 inverse = matrix_of(h).inverse();
  Homography result;
  std::copy(inverse.data(), inverse.data() + 9, result.m.begin());
  return result;
}

double area_scale(const Homography& h, double x, double y) {
  // det of the derivative of a homography is det(m) / w^3.
  const double w = h.m[6] * x + h.m[7] * y + h.m[8];
  return std::abs(matrix_of(h).determinant() / (w * w * w));
}

Homography fit_homography(const std::vector<PointPair>& points) {
  if (points.size() < 4)
    throw Error({{}, "homography", "4 points or more", fmt::format("{}", points.size())});
  std::vector<Point> from, to;
  for (const PointPair& point : points) {
    from.push_back({point.x_mm, point.y_mm});
    to.push_back({point.x_px, point.y_px});
  }
  const Matrix3 a = make_normalisation(from), b = make_normalisation(to);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = a * Eigen::Vector3d(from[i].x, from[i].y, 1);
    const Eigen::Vector3d q = b * Eigen::Vector3d(to[i].x, to[i].y, 1);
    Eigen::Matrix<double, 9, 1> row;
    row << p, 0, 0, 0, -q.x() * p;
    normal += row * row.transpose();
    row << 0, 0, 0, p, -q.y() * p;
    normal += row * row.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> solver(normal);
  if (!(solver.eigenvalues()[1] > 1e-9 * solver.eigenvalues()[8]))
    throw Error({{}, "homography", "points that do not lie on one line", "such points"});
  const Eigen::Matrix<double, 9, 1> h = solver.eigenvectors().col(0);
  const Matrix3 normalised = Eigen::Map<const Matrix3>(h.data());
  Matrix3 matrix = b.inverse() * normalised * a;
  matrix /= matrix(2, 2);
  Homography result;
  std::copy(matrix.data(), matrix.data() + 9, result.m.begin());
  return result;
}

double reprojection_error(const Homography& h, const std::vector<PointPair>& points) {
  double sum = 0;
  for (const PointPair& point : points) {
    const Point found = apply(h, point.x_mm, point.y_mm);
    sum += (found.x - point.x_px) * (found.x - point.x_px) +
           (found.y - point.y_px) * (found.y - point.y_px);
  }
  return std::sqrt(sum / static_cast<double>(points.size()));
}

std::vector<Dot> find_dots(const Image& image) {
  const float largest = *std::max_element(image.values.begin(), image.values.end());
  std::vector<float> sorted = image.values;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const float median = *middle;
  for (float& value : sorted) value = std::abs(value - median);
  std::nth_element(sorted.begin(), middle, sorted.end());
  // 10 standard deviations of the background, by the median absolute deviation.
  if (!(largest > median + 15 * *middle) || !(largest > 0))
    throw Error({{}, "dots", "dots that stand out of the background", "none"});
  const float threshold = median + 0.3f * (largest - median);
  std::vector<unsigned char> seen(image.values.size());
  std::vector<Dot> dots;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                            static_cast<std::size_t>(x);
      if (seen[i] != 0 || !(image.values[i] > threshold)) continue;
      const Region region = fill_region(image, threshold, x, y, seen);
      if (region.pixels >= 2) dots.push_back(measure_dot(image, region));
    }
  if (dots.empty()) throw Error({{}, "dots", "dots that stand out of the background", "none"});
  return dots;
}

std::vector<PointPair> match_lattice(const std::vector<Dot>& dots, const CaptureMeta& meta) {
  const int columns = dots_along(meta.width, 0, meta.lattice_px);
  const int rows = dots_along(meta.height, 0, meta.lattice_px);
  const auto places = walk_lattice(dots);
  int i0 = 0, i1 = 0, j0 = 0, j1 = 0;
  for (const auto& [place, dot] : places) {
    i0 = std::min(i0, place.first), i1 = std::max(i1, place.first);
    j0 = std::min(j0, place.second), j1 = std::max(j1, place.second);
  }
  const auto expected = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  if (dots.size() != expected || places.size() != expected || i1 - i0 + 1 != columns ||
      j1 - j0 + 1 != rows)
    throw Error({{},
                 "lattice",
                 fmt::format("{} x {} dots, as the description says", columns, rows),
                 fmt::format("{} dots, of which {} make a lattice of {} x {}", dots.size(),
                             places.size(), i1 - i0 + 1, j1 - j0 + 1)});
  std::vector<PointPair> points;
  points.reserve(places.size());
  for (const auto& [place, index] : places) {
    const Dot& dot = dots[static_cast<std::size_t>(index)];
    points.push_back({(meta.lattice_px * (place.first - i0) + 0.5) * meta.pixel_pitch_mm,
                      (meta.lattice_px * (place.second - j0) + 0.5) * meta.pixel_pitch_mm, dot.x,
                      dot.y});
  }
  return points;
}

}  // namespace parian

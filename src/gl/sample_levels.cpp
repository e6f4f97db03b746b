#include "gl/sample_levels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "base/parallel.h"

namespace parian {
namespace {

void halve(const std::vector<SurfacePoint>& points, std::uint32_t* order, std::size_t count) {
  if (count <= 1) return;
  Bounds3 box;
  for (std::size_t i = 0; i < count; ++i) extend(box, points[order[i]].position);
  const int axis = longest_axis(box);
  // Powers of two, so that groups of 4^k start at multiples of 4^k.
  const std::size_t half = std::bit_ceil(count) / 2;
  std::nth_element(order, order + half, order + count, [&](std::uint32_t a, std::uint32_t b) {
    const float pa = component(points[a].position, axis), pb = component(points[b].position, axis);
    return pa != pb ? pa < pb : a < b;
  });
  const auto work = [&](std::size_t side) {
    side == 0 ? halve(points, order, half) : halve(points, order + half, count - half);
  };
  if (count > 4096) {
    parallel_for(2, work);
  } else {
    work(0);
    work(1);
  }
}

double smooth_step(double t) {
  return t * t * (3 - 2 * t);
}

}  // namespace

std::vector<std::uint32_t> order_by_groups(const std::vector<SurfacePoint>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);
  halve(points, order.data(), order.size());
  return order;
}

std::size_t level_size(std::size_t samples, int level) {
  for (int l = 0; l < level; ++l) samples = (samples + 3) / 4;
  return samples;
}

double RadialLevels::level_radius(int level) const {
  return std::ldexp(radius_mm, level);
}

double RadialLevels::first_mm(int level) const {
  return level == 0 ? 0 : level_radius(level) * std::exp2(-0.5 - 0.5 * overlap);
}

double RadialLevels::last_mm(int level) const {
  return level_radius(level) * (level + 1 == count ? 2 : std::exp2(0.5 + 0.5 * overlap));
}

RadialLevels make_radial_levels(double radius_mm, double overlap, double max_support_mm) {
  RadialLevels levels;
  levels.radius_mm = radius_mm;
  levels.overlap = overlap;
  while (levels.last_mm(levels.count - 1) < max_support_mm) ++levels.count;
  levels.nodes = {0, static_cast<float>(radius_mm / 4)};
  for (int i = 0; i < 2 * levels.count + 3; ++i)
    levels.nodes.push_back(static_cast<float>(radius_mm * std::exp2(0.5 * i - 1)));
  return levels;
}

std::array<float, 4> RadialLevels::weight_place(int level) const {
  const double narrow = std::exp2(0.5 - 0.5 * overlap), wide = std::exp2(0.5 + 0.5 * overlap);
  const double radius = level_radius(level), width = wide - narrow;
  std::array<float, 4> place{0, 1, 0, 1};
  if (level > 0) {
    place[0] = static_cast<float>(2 / (radius * width));
    place[1] = static_cast<float>(-narrow / width);
  }
  if (level + 1 < count) {
    place[2] = static_cast<float>(-1 / (radius * width));
    place[3] = static_cast<float>(wide / width);
  }
  return place;
}

double level_weight(const RadialLevels& levels, int level, double r_mm) {
  if (level + 1 == levels.count && r_mm >= levels.last_mm(level)) return 0;
  const std::array<float, 4> place = levels.weight_place(level);
  const auto part = [&](std::size_t i) {
    return r_mm * static_cast<double>(place[i]) + static_cast<double>(place[i + 1]);
  };
  return smooth_step(std::clamp(std::min(part(0), part(2)), 0.0, 1.0));
}

std::array<int, 5> level_nodes(int level) {
  if (level == 0) return {0, 1, 2, 4, 6};
  const int first = 2 * level + 2;
  return {first, first + 1, first + 2, first + 3, first + 4};
}

}  // namespace parian

// Blue noise by weighted sample elimination: "Sample Elimination for Generating Poisson Disk
// Sample Sets", Yuksel 2015. Ours also keeps the number of samples of every patch.
#include "mesh/surface_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.h"
#include "base/parallel.h"
#include "base/random.h"
#include "mesh/sample_elimination_internal.h"
#include "mesh/topology_internal.h"

namespace parian {
namespace {

constexpr std::size_t candidates_per_sample = 4;
// Samples per patch, whose number of samples is exact: without, numbers in large regions vary by
// twice as much.
constexpr std::size_t patch = 32;
constexpr std::size_t block = 2048;

// Every third bit of a 63-bit word.
std::uint64_t spread_bits(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32u) & 0x1f00000000ffff;
  x = (x | x << 16u) & 0x1f0000ff0000ff;
  x = (x | x << 8u) & 0x100f00f00f00f00f;
  x = (x | x << 4u) & 0x10c30c30c30c30c3;
  return (x | x << 2u) & 0x1249249249249249;
}

std::vector<double> sum_areas(const TriangleMesh& mesh, const std::vector<std::uint32_t>& order) {
  std::vector<double> sums(order.size());
  parallel_for_blocks(sums.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      sums[i] = 0.5 * length(double_area_normal(mesh, mesh.triangles[order[i]]));
  });
  std::partial_sum(sums.begin(), sums.end(), sums.begin());
  return sums;
}

// Maps [0, 1) to a triangle, preserving measure and keeping near what is near: each digit of the
// number to base 4 chooses one of the four triangles between the corners and the edges' middles
// (Basu and Owen 2015).
Vec2 fraction_to_barycentric(double fraction) {
  Vec2 a{0, 0}, b{1, 0}, c{0, 1};
  for (int level = 0; level < 14; ++level) {
    fraction *= 4;
    const int digit = std::min(3, static_cast<int>(fraction));
    fraction -= digit;
    const Vec2 ab = (a + b) * 0.5f, bc = (b + c) * 0.5f, ca = (c + a) * 0.5f;
    if (digit == 0) a = bc, b = ca, c = ab;
    if (digit == 1) b = ab, c = ca;
    if (digit == 2) a = ab, c = bc;
    if (digit == 3) a = ca, b = bc;
  }
  return (a + b + c) * (1.0f / 3);
}

// One at random in each of `count` equal parts of the area.
std::vector<Candidate> make_candidates(const TriangleMesh& mesh,
                                       const std::vector<std::uint32_t>& order,
                                       const std::vector<double>& sums, std::size_t count,
                                       std::uint64_t seed) {
  std::vector<Candidate> candidates(count);
  parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const double at = (static_cast<double>(i) + hash_to_uniform(hash_u64(seed, i))) /
                        static_cast<double>(count) * sums.back();
      const auto place = static_cast<std::size_t>(
          std::upper_bound(sums.begin(), sums.end() - 1, at) - sums.begin());
      const double before = place == 0 ? 0 : sums[place - 1];
      const double area = sums[place] - before;
      const double fraction = area > 0 ? std::clamp((at - before) / area, 0.0, 1.0) : 0.5;
      const Vec2 barycentric = fraction_to_barycentric(fraction);
      const Triangle& v = mesh.triangles[order[place]];
      const Vec3 p = mesh.positions[v[0]] * (1 - barycentric.x - barycentric.y) +
                     mesh.positions[v[1]] * barycentric.x + mesh.positions[v[2]] * barycentric.y;
      candidates[i] = {p, to_unit(double_area_normal(mesh, v)), barycentric, order[place],
                       static_cast<std::uint32_t>(i / (candidates_per_sample * patch))};
    }
  });
  return candidates;
}

}  // namespace

double SurfaceSamples::spacing_mm() const {
  return std::sqrt(area_mm2);
}

std::vector<std::uint32_t> order_triangles(const TriangleMesh& mesh) {
  const Bounds3 box = bounds(mesh);
  const Vec3 size = extent(box);
  const float scale = 2097151 / (3 * std::max({size.x, size.y, size.z}));
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(mesh.triangles.size());
  parallel_for_blocks(keys.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Vec3 p;
      for (const std::uint32_t v : mesh.triangles[i]) p += mesh.positions[v] - box.lower;
      const auto bits = [&](float x) { return spread_bits(static_cast<std::uint64_t>(x * scale)); };
      keys[i] = {bits(p.x) << 2u | bits(p.y) << 1u | bits(p.z), static_cast<std::uint32_t>(i)};
    }
  });
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order;
  order.reserve(keys.size());
  for (const auto& key : keys) order.push_back(key.second);
  return order;
}

std::vector<Vec3> spread_points(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
  PARIAN_CHECK(!mesh.triangles.empty());
  const std::vector<std::uint32_t> order = order_triangles(mesh);
  std::vector<Vec3> points;
  points.reserve(count);
  for (const Candidate& candidate :
       make_candidates(mesh, order, sum_areas(mesh, order), count, seed))
    points.push_back(candidate.position);
  return points;
}

SurfaceSamples make_surface_samples(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed,
                                    const Progress& progress) {
  PARIAN_CHECK_LT(std::size_t{0}, count);
  PARIAN_CHECK_LT(count, std::size_t{1} << 27u);
  PARIAN_CHECK(!mesh.triangles.empty());
  advance_progress(progress, "samples", 0);
  const std::vector<std::uint32_t> order = order_triangles(mesh);
  const std::vector<double> sums = sum_areas(mesh, order);
  const double area = sums.back();
  PARIAN_CHECK_LT(0.0, area);
  std::vector<Candidate> candidates =
      make_candidates(mesh, order, sums, candidates_per_sample * count, seed);
  eliminate_samples(candidates, count, area, patch, progress);
  SurfaceSamples samples;
  samples.area_mm2 = area / static_cast<double>(count);
  samples.points.resize(count);
  parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      samples.points[i] =
          get_surface_point(mesh, candidates[i].triangle, candidates[i].barycentric);
  });
  advance_progress(progress, "samples", 1);
  return samples;
}

}  // namespace parian

#include "gl/self_occlusion.h"

#include <algorithm>
#include <cmath>

#include "base/hot.h"
#include "base/parallel.h"
#include "base/random.h"

namespace parian {
namespace {

constexpr std::size_t directions = occlusion_side * occlusion_side;
constexpr std::size_t map_texels = std::size_t{occlusion_size} * occlusion_size;
constexpr std::size_t spread_points = 150'000;

// Areas of the triangles up to each.
std::vector<double> sum_areas(const TriangleMesh& mesh) {
  std::vector<double> sums;
  sums.reserve(mesh.triangles.size());
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3 first = mesh.positions[a];
    sum += 0.5 *
           static_cast<double>(length(cross(mesh.positions[b] - first, mesh.positions[c] - first)));
    sums.push_back(sum);
  }
  return sums;
}

// One in each of as many equal parts of the area.
std::vector<Vec3> spread_over(const TriangleMesh& mesh) {
  const std::vector<double> sums = sum_areas(mesh);
  std::vector<Vec3> points(spread_points);
  std::size_t triangle = 0;
  for (std::size_t i = 0; i < spread_points; ++i) {
    const double wanted =
        sums.back() * (static_cast<double>(i) + 0.5) / static_cast<double>(spread_points);
    while (triangle + 1 < sums.size() && sums[triangle] < wanted) ++triangle;
    auto u = static_cast<float>(hash_to_uniform(hash_u64(i, 0)));
    auto v = static_cast<float>(hash_to_uniform(hash_u64(i, 1)));
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto& [a, b, c] = mesh.triangles[triangle];
    const Vec3 first = mesh.positions[a];
    points[i] = first + (mesh.positions[b] - first) * u + (mesh.positions[c] - first) * v;
  }
  return points;
}

// `points` in units of the sphere's radius.
PARIAN_HOT void draw_heights(const Vec3* points, std::size_t count, const Frame& frame,
                             std::uint16_t* heights) {
  constexpr float half = 0.5f * static_cast<float>(occlusion_size);
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<std::size_t>(half + half * dot(points[i], frame.tangent));
    const auto y = static_cast<std::size_t>(half + half * dot(points[i], frame.bitangent));
    const auto height =
        static_cast<std::uint16_t>(65535.0f * (0.5f + 0.5f * dot(points[i], frame.normal)));
    std::uint16_t& highest = heights[y * occlusion_size + x];
    highest = std::max(highest, height);
  }
}

// The least of the most over squares of 2 x 2 texels (closing), in place: fills what no point has
// met. Where heights are those of a plane or of a convex object nothing changes. A margin of a
// texel on all sides is empty.
PARIAN_HOT void close_holes(std::uint16_t* heights) {
  constexpr std::size_t n = occlusion_size;
  for (std::size_t i = 0; i + n + 1 < map_texels; ++i) {
    const std::uint16_t here = std::max(heights[i], heights[i + 1]);
    const std::uint16_t below = std::max(heights[i + n], heights[i + n + 1]);
    heights[i] = std::max(here, below);
  }
  for (std::size_t i = map_texels - 1; i > n; --i) {
    const std::uint16_t here = std::min(heights[i], heights[i - 1]);
    const std::uint16_t above = std::min(heights[i - n], heights[i - n - 1]);
    heights[i] = std::min(here, above);
  }
}

}  // namespace

Vec3 occlusion_direction(int x, int y) {
  const auto place = [](int i) {
    return (2 * static_cast<float>(i) + 1) / static_cast<float>(occlusion_side) - 1;
  };
  const float a = place(x), b = place(y), z = 1 - std::abs(a) - std::abs(b);
  if (z >= 0) return normalize({a, b, z});
  return normalize({std::copysign(1 - std::abs(b), a), std::copysign(1 - std::abs(a), b), z});
}

HeightMaps make_height_maps(const TriangleMesh& mesh) {
  HeightMaps maps;
  const Bounds3 box = bounds(mesh);
  maps.middle = center(box);
  maps.radius_mm = 0.51f * diagonal(box);
  maps.heights.assign(directions * map_texels, 0);
  std::vector<Vec3> points = spread_over(mesh);
  for (Vec3& point : points) point = (point - maps.middle) / maps.radius_mm;
  parallel_for(directions, [&](std::size_t i) {
    const auto index = static_cast<int>(i);
    const Vec3 direction = occlusion_direction(index % occlusion_side, index / occlusion_side);
    std::uint16_t* heights = &maps.heights[i * map_texels];
    draw_heights(points.data(), points.size(), make_frame(direction), heights);
    close_holes(heights);
  });
  return maps;
}

SelfOcclusion make_self_occlusion(const HeightMaps& maps) {
  return {maps.middle, maps.radius_mm,
          make_texture_array(TexelFormat::r16ui, occlusion_size, occlusion_size,
                             static_cast<int>(directions), "heights of the object",
                             maps.heights.data())};
}

void bind_self_occlusion(const Program& program, const SelfOcclusion& occlusion, int unit) {
  bind_texture(program, "object_heights", unit, occlusion.heights);
  set_uniform(program, "object_middle", occlusion.middle);
  set_uniform(program, "object_radius", occlusion.radius_mm);
}

}  // namespace parian

#include "gl/self_occlusion.h"

#include <algorithm>
#include <cmath>

#include "base/hot.h"
#include "base/parallel.h"
#include "mesh/surface_samples.h"

namespace parian {
namespace {

constexpr std::size_t directions = occlusion_side * occlusion_side;
constexpr std::size_t map_texels = std::size_t{occlusion_size} * occlusion_size;
constexpr std::size_t point_count = 150'000;

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
  std::vector<Vec3> points = spread_points(mesh, point_count);
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

#include "gl/self_occlusion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mesh/shapes.h"
#include "mesh/surface_samples.h"
#include "mesh/test_meshes.h"

namespace parian {
namespace {

constexpr int cells = occlusion_side * occlusion_side;

// As shaders/self_occlusion.glsl looks it up: mm, or far below where there is nothing.
float find_height(const HeightMaps& maps, int cell, Vec3 place) {
  const Frame frame = make_frame(occlusion_direction(cell % occlusion_side, cell / occlusion_side));
  const auto texel = [&](Vec3 axis) {
    const float at = dot(place - maps.middle, axis) / maps.radius_mm;
    return static_cast<std::size_t>((0.5f + 0.5f * at) * occlusion_size);
  };
  const std::size_t index =
      (static_cast<std::size_t>(cell) * occlusion_size + texel(frame.bitangent)) * occlusion_size +
      texel(frame.tangent);
  const std::uint16_t height = maps.heights[index];
  return height == 0 ? -1e30f : (static_cast<float>(height) / 32767.5f - 1) * maps.radius_mm;
}

TEST(SelfOcclusion, DirectionsAreSpreadEvenly) {
  Vec3 sum;
  float nearest = 1;
  for (int i = 0; i < cells; ++i) {
    const Vec3 d = occlusion_direction(i % occlusion_side, i / occlusion_side);
    EXPECT_NEAR(length(d), 1, 1e-6f);
    sum += d;
    for (int j = 0; j < i; ++j)
      nearest = std::min(nearest,
                         1 - dot(d, occlusion_direction(j % occlusion_side, j / occlusion_side)));
  }
  EXPECT_NEAR(length(sum), 0, 1e-4f);
  EXPECT_GT(std::acos(1 - nearest), 0.08f);  // 256 even ones would be 0.24 apart
}

// Of a ball in all directions sqrt(R^2 - s^2) at distance s from the middle.
TEST(SelfOcclusion, HeightsOfABallAreThose) {
  TriangleMesh mesh = make_sphere(6);
  for (Vec3& position : mesh.positions) position = position * 10.0f + Vec3{3, -2, 5};
  const HeightMaps maps = make_height_maps(mesh);
  EXPECT_NEAR(length(maps.middle - Vec3{3, -2, 5}), 0, 1e-3f);
  for (int cell = 0; cell < cells; cell += 5) {
    const Vec3 d = occlusion_direction(cell % occlusion_side, cell / occlusion_side);
    const Frame frame = make_frame(d);
    for (const float s : {0.0f, 3.0f, 6.0f, 8.0f}) {
      const float height = find_height(maps, cell, maps.middle + frame.tangent * s);
      const float slope = s / std::sqrt(100 - s * s);
      EXPECT_NEAR(height, std::sqrt(100 - s * s), 1e-2f + 1.5f * slope * maps.texel_mm()) << cell;
    }
    EXPECT_LT(find_height(maps, cell, maps.middle + frame.tangent * 11.0f), -100);
  }
}

// To the last texel: from nowhere on a ball, a box or a thin plate, along no direction that leads
// off it, is anything in the way. A plate has no holes where something is.
TEST(SelfOcclusion, NothingOfAConvexObjectIsHidden) {
  for (const TriangleMesh& mesh : {make_sphere(4), make_box({3, 1, 2}), make_box({5, 0.01, 4})}) {
    TriangleMesh smooth = mesh;
    if (smooth.normals.empty()) compute_normals(smooth);
    const HeightMaps maps = make_height_maps(smooth);
    std::size_t asked = 0, below = 0, seen_from_below = 0;
    for (const SurfacePoint& point : make_surface_samples(smooth, 1000).points) {
      const Vec3 off = point.position + point.geometric_normal * (1.5f * maps.texel_mm());
      const Vec3 under = point.position - point.geometric_normal * (1.5f * maps.texel_mm());
      for (int cell = 0; cell < cells; ++cell) {
        const Vec3 d = occlusion_direction(cell % occlusion_side, cell / occlusion_side);
        const float cosine = dot(d, point.geometric_normal);
        if (cosine <= 0) continue;
        ASSERT_LE(find_height(maps, cell, off), dot(off - maps.middle, d)) << cell;
        ++asked;
        if (cosine < 0.5f) continue;
        ++below;
        seen_from_below += find_height(maps, cell, under) <= dot(under - maps.middle, d) ? 1 : 0;
      }
    }
    EXPECT_GT(asked, 100'000u);
    EXPECT_LE(seen_from_below, below / 50);
  }
}

TEST(SelfOcclusion, IsTheSameEachTime) {
  const TriangleMesh mesh = make_knot(1);
  EXPECT_EQ(make_height_maps(mesh).heights, make_height_maps(mesh).heights);
}

}  // namespace
}  // namespace parian

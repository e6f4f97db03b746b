#include "scene/mapping.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/random.h"
#include "mesh/test_meshes.h"

namespace parian {
namespace {

TEST(MirrorTile, IsExactAtBorders) {
  bool mirrored = true;
  EXPECT_EQ(mirror_tile(0, 4, mirrored), 0);
  EXPECT_FALSE(mirrored);
  EXPECT_EQ(mirror_tile(-0.5, 4, mirrored), -0.5);
  EXPECT_FALSE(mirrored);
  EXPECT_EQ(mirror_tile(3.25, 4, mirrored), 3.25);
  EXPECT_EQ(mirror_tile(3.75, 4, mirrored), 3.25);
  EXPECT_TRUE(mirrored);
  EXPECT_EQ(mirror_tile(-1, 4, mirrored), 0);
  EXPECT_TRUE(mirrored);
  EXPECT_EQ(mirror_tile(7.25, 4, mirrored), -0.25);
  EXPECT_TRUE(mirrored);
  EXPECT_EQ(mirror_tile(7.5, 4, mirrored), -0.5);
  EXPECT_FALSE(mirrored);
  EXPECT_EQ(mirror_tile(8 * 1e6 + 1, 4, mirrored), 1);
  EXPECT_FALSE(mirrored);
  // The far border is not part of the interval.
  EXPECT_EQ(mirror_tile(3.5, 4, mirrored), std::nextafter(3.5, 0));
}

TEST(MirrorTile, StaysInsideAndIsContinuous) {
  Rng rng = make_rng(1);
  for (int size : {1, 2, 3, 222})
    for (int i = 0; i < 2000; ++i) {
      const double x = (sample_uniform(rng) - 0.5) * 10 * size;
      bool mirrored = false, mirrored_near = false;
      const double place = mirror_tile(x, size, mirrored);
      ASSERT_GE(place, -0.5);
      ASSERT_LT(place, size - 0.5);
      const double near = mirror_tile(x + 1e-7, size, mirrored_near);
      ASSERT_NEAR(std::abs(near - place), mirrored == mirrored_near ? 1e-7 : 0.5e-7, 0.51e-7);
      if (mirrored == mirrored_near) {
        ASSERT_EQ(near < place, mirrored);
      }
    }
  bool mirrored = false;
  for (double odd : {1e300, HUGE_VAL, static_cast<double>(NAN)}) {
    const double place = mirror_tile(odd, 5, mirrored);
    EXPECT_TRUE(place >= -0.5 && place < 4.5) << odd;
  }
}

// Directions are orthonormal, tangent, and those along which the place in the sample grows.
void expect_frame_fits(const Mapping& mapping, const SampleGrid& grid, const SurfacePoint& point,
                       const std::function<SurfacePoint(Vec3)>& move) {
  const SamplePoint at = map_to_sample(mapping, grid, point);
  ASSERT_NEAR(length(at.along_x), 1, 1e-5);
  ASSERT_NEAR(length(at.along_y), 1, 1e-5);
  ASSERT_NEAR(dot(at.along_x, at.along_y), 0, 1e-5);
  ASSERT_NEAR(dot(at.along_x, point.normal), 0, 1e-5);
  ASSERT_NEAR(dot(at.along_y, point.normal), 0, 1e-5);
  const float step = 1e-2f;
  const SamplePoint right = map_to_sample(mapping, grid, move(at.along_x * step));
  const SamplePoint down = map_to_sample(mapping, grid, move(at.along_y * step));
  ASSERT_GT(right.x - at.x, 0);
  ASSERT_GT(down.y - at.y, 0);
}

TEST(Mapping, BoxAlongAnAxisIsInMillimetres) {
  const SampleGrid grid{.width = 40, .height = 30, .pixel_pitch_mm = 0.5};
  Mapping mapping;
  SamplePoint at = map_to_sample(mapping, grid, make_surface_point({3, -2, 7}, {0, 0, 1}));
  EXPECT_NEAR(at.x, 3 / 0.5 - 0.5, 1e-9);
  EXPECT_NEAR(at.y, 2 / 0.5 - 0.5, 1e-9);
  EXPECT_EQ(at.along_x, (Vec3{1, 0, 0}));
  EXPECT_EQ(at.along_y, (Vec3{0, -1, 0}));
  // Enlarged twice, half as far; mirrored on the other side of the origin.
  mapping.scale = 2;
  at = map_to_sample(mapping, grid, make_surface_point({-3, -2, 7}, {0, 0, 1}));
  EXPECT_NEAR(at.x, 3 / 0.5 / 2 - 0.5, 1e-9);
  EXPECT_EQ(at.along_x, (Vec3{-1, 0, 0}));
  mapping.offset_mm = {-3, 2};
  at = map_to_sample(mapping, grid, make_surface_point({-3, -2, 7}, {0, 0, 1}));
  EXPECT_NEAR(at.x, -0.5, 1e-9);
  EXPECT_NEAR(at.y, -0.5, 1e-9);
  // A quarter turn brings the sample's x axis to where its y axis was.
  mapping = {.rotation_deg = 90};
  at = map_to_sample(mapping, grid, make_surface_point({3, -2, 7}, {0, 0, 1}));
  EXPECT_NEAR(at.x, 2 / 0.5 - 0.5, 1e-6);
  EXPECT_NEAR(distance(at.along_x, {0, -1, 0}), 0, 1e-6);
}

TEST(Mapping, BoxFramesFollowTheSample) {
  Rng rng = make_rng(2);
  const SampleGrid grid{.width = 33, .height = 21, .pixel_pitch_mm = 1.5};
  const auto uniform = [&] { return static_cast<float>(2 * sample_uniform(rng) - 1); };
  for (int i = 0; i < 500; ++i) {
    const Mapping mapping{.scale = 0.5 + sample_uniform(rng),
                          .rotation_deg = 360 * sample_uniform(rng),
                          .offset_mm = {20 * uniform(), 20 * uniform()}};
    const SurfacePoint point = make_surface_point(
        {100 * uniform(), 100 * uniform(), 100 * uniform()}, {uniform(), uniform(), uniform()});
    expect_frame_fits(mapping, grid, point, [&](Vec3 by) {
      SurfacePoint moved = point;
      moved.position += by;
      return moved;
    });
  }
}

TEST(Mapping, UprightFacesJoinAllAround) {
  const SampleGrid grid{.width = 7, .height = 5, .pixel_pitch_mm = 1};
  const Mapping mapping{.rotation_deg = 30, .offset_mm = {1.7f, 0.3f}};
  for (const Vec3 corner : {Vec3{4, 1, 4}, Vec3{4, 1, -4}, Vec3{-4, 1, -4}, Vec3{-4, 1, 4}}) {
    const SamplePoint a =
        map_to_sample(mapping, grid, make_surface_point(corner, corner * Vec3{1, 0, 1.0001f}));
    const SamplePoint b =
        map_to_sample(mapping, grid, make_surface_point(corner, corner * Vec3{1.0001f, 0, 1}));
    EXPECT_NEAR(a.x, b.x, 1e-9);
    EXPECT_NEAR(a.y, b.y, 1e-9);
  }
  // Ties take z.
  const SamplePoint tie = map_to_sample({}, grid, make_surface_point({1, -2, 4}, {1, 1, 1}));
  EXPECT_NEAR(tie.x, 0.5, 1e-9);
  EXPECT_NEAR(tie.y, 1.5, 1e-9);
}

TEST(Mapping, TextureCoordinates) {
  const SampleGrid grid{.width = 40, .height = 20, .pixel_pitch_mm = 0.5};
  SurfacePoint point = make_surface_point({0, 0, 0}, {0, 0, 1});
  point.texcoord = {0.25f, 0.5f};
  point.dp_du = {0, 30, 0};
  point.dp_dv = {20, 0, 0};  // left-handed
  Mapping mapping{.kind = MappingKind::uv};
  SamplePoint at = map_to_sample(mapping, grid, point);
  EXPECT_NEAR(at.x, 0.25 * 40 - 0.5, 1e-9);  // a unit of u is the sample's width: 20 mm
  EXPECT_NEAR(at.y, 19.5, 1e-9);             // 10 mm: the sample's lower border
  EXPECT_NEAR(distance(at.along_x, {0, 1, 0}), 0, 1e-6);
  mapping.uv_size_mm = 8;
  at = map_to_sample(mapping, grid, point);
  EXPECT_NEAR(at.x, 0.25 * 8 / 0.5 - 0.5, 1e-9);
  EXPECT_NEAR(at.y, 0.5 * 8 / 0.5 - 0.5, 1e-9);
  EXPECT_NEAR(distance(at.along_y, {1, 0, 0}), 0, 1e-6);
  // Sheared coordinates: the nearest orthonormal pair, symmetric about both directions.
  point.dp_du = {1, 0, 0};
  point.dp_dv = {1, 1, 0};
  at = map_to_sample(mapping, grid, point);
  EXPECT_NEAR(dot(at.along_x, at.along_y), 0, 1e-6);
  EXPECT_NEAR(dot(at.along_x, normalize(point.dp_du)), dot(at.along_y, normalize(point.dp_dv)),
              1e-6);
  // Without any direction there still is a frame.
  point.dp_du = point.dp_dv = {};
  at = map_to_sample(mapping, grid, point);
  EXPECT_NEAR(length(at.along_x), 1, 1e-6);
  EXPECT_NEAR(dot(at.along_x, at.along_y), 0, 1e-6);
}

}  // namespace
}  // namespace parian

#include "scene/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace parian {
namespace {

Bounds3 box_of(Vec3 lower, Vec3 upper) {
  return {lower, upper};
}

TEST(Camera, RowZeroIsOnTopAndColumnsGrowToTheRight) {
  const Camera camera{.position = {0, 0, 10}, .fov_deg = 90, .width = 200, .height = 100};
  const CameraRay middle = make_camera_ray(camera, 100, 50);
  EXPECT_NEAR(middle.direction.z, -1, 1e-6);
  EXPECT_EQ(middle.origin, (Vec3{0, 0, 10}));
  // 90 degrees of height: the middle of the top border is 45 degrees up.
  const CameraRay top = make_camera_ray(camera, 100, 0);
  EXPECT_NEAR(top.direction.y, std::numbers::sqrt2 / 2, 1e-6);
  // Twice as wide as high.
  const CameraRay right = make_camera_ray(camera, 200, 50);
  EXPECT_NEAR(right.direction.x / -right.direction.z, 2, 1e-6);
  EXPECT_NEAR(length(make_camera_ray(camera, 3, 97).direction), 1, 1e-6);
}

TEST(Camera, AnUpAlongTheViewIsReplaced) {
  Camera camera{.position = {0, 10, 0}};
  const CameraFrame frame = make_camera_frame(camera);
  EXPECT_NEAR(length(frame.right), 1, 1e-6);
  EXPECT_NEAR(dot(frame.up, frame.forward), 0, 1e-6);
  EXPECT_EQ(frame.up, (Vec3{0, 0, -1}));
}

TEST(Camera, TheDefaultViewFramesTheBox) {
  for (const Vec3 size : {Vec3{10, 1, 1}, Vec3{1, 10, 1}, Vec3{1, 2, 30}, Vec3{100, 100, 100}})
    for (const int width : {100, 640, 2000}) {
      const Bounds3 box = box_of({3, 0, -2}, Vec3{3, 0, -2} + size);
      Camera camera{.target = center(box), .width = width, .height = 480};
      frame_box(camera, box);
      EXPECT_EQ(check_view(camera, box), ViewProblem::none);
      const CameraFrame frame = make_camera_frame(camera);
      double reach = 0;  // of the corners, as a part of the half picture
      for (unsigned i = 0; i < 8; ++i) {
        const Vec3 corner{(i & 1u) != 0 ? box.upper.x : box.lower.x,
                          (i & 2u) != 0 ? box.upper.y : box.lower.y,
                          (i & 4u) != 0 ? box.upper.z : box.lower.z};
        const Vec3 d = corner - camera.position;
        const double depth = dot(d, frame.forward);
        ASSERT_GT(depth, 0);
        reach = std::max({reach, std::abs(dot(d, frame.right)) / depth / frame.half_width,
                          std::abs(dot(d, frame.up)) / depth / frame.half_height});
      }
      EXPECT_NEAR(reach, 1 / 1.05, 1e-3);
    }
}

TEST(Camera, ViewsThatShowNothing) {
  const Bounds3 box = box_of({-1, -1, -1}, {1, 1, 1});
  const auto check = [&](Vec3 position, Vec3 target) {
    return check_view({.position = position, .target = target}, box);
  };
  EXPECT_EQ(check({0, 0, 10}, {0, 0, 0}), ViewProblem::none);
  EXPECT_EQ(check({0, 0, 0.5f}, {0, 0, 0}), ViewProblem::inside_box);
  EXPECT_EQ(check({0, 0, 1}, {0, 0, 0}), ViewProblem::inside_box);
  EXPECT_EQ(check({0, 0, 10}, {0, 0, 20}), ViewProblem::box_outside_view);
  EXPECT_EQ(check({0, 0, 10}, {10, 0, 10}), ViewProblem::box_outside_view);
  EXPECT_EQ(check({0, 0, 10}, {9, 0, 0}), ViewProblem::box_outside_view);
  EXPECT_EQ(check({0, 0, 10}, {0, -9, 0}), ViewProblem::box_outside_view);
  EXPECT_EQ(check({0, 0, 10}, {3, 0, 0}), ViewProblem::none);  // its edge is in view
}

}  // namespace
}  // namespace parian

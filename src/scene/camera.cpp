#include "scene/camera.h"

#include <array>
#include <cmath>
#include <numbers>

namespace parian {
namespace {

constexpr double radians = std::numbers::pi / 180;

std::array<Vec3, 8> corners(const Bounds3& box) {
  std::array<Vec3, 8> points;
  for (unsigned i = 0; i < 8; ++i)
    points[i] = {(i & 1u) != 0 ? box.upper.x : box.lower.x,
                 (i & 2u) != 0 ? box.upper.y : box.lower.y,
                 (i & 4u) != 0 ? box.upper.z : box.lower.z};
  return points;
}

}  // namespace

CameraFrame make_camera_frame(const Camera& camera) {
  CameraFrame frame;
  frame.position = camera.position;
  frame.forward = normalize(camera.target - camera.position);
  frame.right = cross(frame.forward, normalize(camera.up));
  if (length(frame.right) < 1e-5f)
    frame.right =
        cross(frame.forward, std::abs(frame.forward.y) > 0.9f ? Vec3{0, 0, -1} : Vec3{0, 1, 0});
  frame.right = normalize(frame.right);
  frame.up = cross(frame.right, frame.forward);
  frame.half_height = std::tan(camera.fov_deg / 2 * radians);
  frame.half_width = frame.half_height * camera.width / camera.height;
  frame.width = camera.width;
  frame.height = camera.height;
  return frame;
}

CameraRay make_camera_ray(const CameraFrame& frame, double px, double py) {
  const double x = (2 * px / frame.width - 1) * frame.half_width;
  const double y = (1 - 2 * py / frame.height) * frame.half_height;
  return {frame.position, normalize(frame.forward + frame.right * static_cast<float>(x) +
                                    frame.up * static_cast<float>(y))};
}

CameraRay make_camera_ray(const Camera& camera, double px, double py) {
  return make_camera_ray(make_camera_frame(camera), px, py);
}

void frame_box(Camera& camera, const Bounds3& box) {
  constexpr double azimuth = 20 * radians, elevation = 15 * radians, margin = 1.05;
  const Vec3 towards{static_cast<float>(std::sin(azimuth) * std::cos(elevation)),
                     static_cast<float>(std::sin(elevation)),
                     static_cast<float>(std::cos(azimuth) * std::cos(elevation))};
  camera.position = camera.target + towards * std::max(1.0f, diagonal(box));
  const CameraFrame frame = make_camera_frame(camera);
  // A corner at (x, y), z nearer than the target, is in view from d >= z + |x| / half_width.
  double distance = 0;
  for (const Vec3& corner : corners(box)) {
    const Vec3 from_target = corner - camera.target;
    const double x = std::abs(dot(from_target, frame.right)) / frame.half_width;
    const double y = std::abs(dot(from_target, frame.up)) / frame.half_height;
    distance = std::max(distance, dot(from_target, towards) + margin * std::max(x, y));
  }
  camera.position = camera.target + towards * static_cast<float>(distance);
}

ViewProblem check_view(const Camera& camera, const Bounds3& box) {
  const Vec3 p = camera.position;
  if (min(p, box.lower) == box.lower && max(p, box.upper) == box.upper)
    return ViewProblem::inside_box;
  // Outward normals' products with the five planes of the view; all corners beyond one of them.
  const CameraFrame frame = make_camera_frame(camera);
  std::array<int, 5> beyond{};
  for (const Vec3& corner : corners(box)) {
    const Vec3 d = corner - p;
    const double x = dot(d, frame.right), y = dot(d, frame.up), z = dot(d, frame.forward);
    beyond[0] += z <= 0 ? 1 : 0;
    beyond[1] += x > z * frame.half_width ? 1 : 0;
    beyond[2] += -x > z * frame.half_width ? 1 : 0;
    beyond[3] += y > z * frame.half_height ? 1 : 0;
    beyond[4] += -y > z * frame.half_height ? 1 : 0;
  }
  for (int count : beyond)
    if (count == 8) return ViewProblem::box_outside_view;
  return ViewProblem::none;
}

}  // namespace parian

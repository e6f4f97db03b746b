#include "app/studio/stage.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "scene/camera.h"

namespace parian {
namespace {

constexpr double degree = 0.017453292519943295;
constexpr double least_roll_deg = 1e-3;  // less is rounding
constexpr double steep_deg = 89.5;       // beyond it the y axis is no guide to the picture's up

// The picture's axes before it is rolled; defined at the poles, too.
struct OrbitAxes {
  Vec3 right, up;
};
OrbitAxes axes_of(const Orbit& orbit) {
  return {direction_of(orbit.yaw_deg + 90, 0), direction_of(orbit.yaw_deg, orbit.pitch_deg + 90)};
}

}  // namespace

std::shared_ptr<const Stage> make_stage(Scene scene) {
  if (scene.mesh.normals.empty()) compute_normals(scene.mesh);
  RayTracer tracer(scene.mesh);
  const Bounds3 box = bounds(scene.mesh);
  scene.material = {};
  scene.layers.clear();
  scene.lights.clear();
  return std::make_shared<const Stage>(Stage{std::move(scene), std::move(tracer), box});
}

std::string why_not(const SurfaceLayer& layer, const Stage& stage, const Material& material) {
  try {
    check_layer(layer, material, {}, stage.scene.mesh, {}, "layer");
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

StageLayers shown_layers(const StageLayers& layers, const Stage& stage, const Material& material) {
  StageLayers shown;
  for (const auto& layer : layers)
    if (layer->enabled && why_not(*layer, stage, material).empty()) shown.push_back(layer);
  return shown;
}

std::vector<SurfaceLayer> copy_layers(const StageLayers& layers) {
  std::vector<SurfaceLayer> copies;
  copies.reserve(layers.size());
  for (const auto& layer : layers) copies.push_back(*layer);
  return copies;
}

Scene make_scene(const Stage& stage, const Material& material, const StageLayers& layers,
                 const Lighting& lighting, const Camera& camera) {
  Scene scene = stage.scene;
  scene.material = material;
  scene.layers = copy_layers(layers);
  scene.lights = make_lights(lighting);
  scene.camera = camera;
  scene.exposure = 0;
  return scene;
}

Orbit make_orbit(const Camera& camera) {
  const Vec3 from = camera.position - camera.target;
  const double r = std::max(1e-6, static_cast<double>(length(from)));
  const double height = std::clamp(static_cast<double>(from.y) / r, -1.0, 1.0);
  Orbit orbit{
      .target = camera.target,
      .yaw_deg = std::atan2(static_cast<double>(from.x), static_cast<double>(from.z)) / degree,
      .pitch_deg = std::asin(height) / degree,
      .distance_mm = r,
      .fov_deg = camera.fov_deg};
  const OrbitAxes axes = axes_of(orbit);
  const Vec3 up = make_camera_frame(camera).up;
  const double roll =
      std::atan2(static_cast<double>(dot(up, axes.right)), static_cast<double>(dot(up, axes.up))) /
      degree;
  if (std::abs(roll) > least_roll_deg) orbit.roll_deg = roll;
  return orbit;
}

Orbit frame_stage(const Stage& stage, int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.target = center(stage.box);
  frame_box(camera, stage.box);
  return make_orbit(camera);
}

Camera make_camera(const Orbit& orbit, int width, int height) {
  Camera camera;
  camera.target = orbit.target;
  camera.position = orbit.target + direction_of(orbit.yaw_deg, orbit.pitch_deg) *
                                       static_cast<float>(orbit.distance_mm);
  if (orbit.roll_deg != 0 || std::abs(orbit.pitch_deg) > steep_deg) {
    const OrbitAxes axes = axes_of(orbit);
    camera.up = axes.up * static_cast<float>(std::cos(orbit.roll_deg * degree)) +
                axes.right * static_cast<float>(std::sin(orbit.roll_deg * degree));
  }
  camera.fov_deg = orbit.fov_deg;
  camera.width = width;
  camera.height = height;
  return camera;
}

void turn(Orbit& orbit, double dx, double dy, int height) {
  const double scale = 180.0 / std::max(1, height);
  orbit.yaw_deg = std::remainder(orbit.yaw_deg - dx * scale, 360.0);
  orbit.pitch_deg = std::clamp(orbit.pitch_deg + dy * scale, -89.0, 89.0);
}

void pan(Orbit& orbit, double dx, double dy, int height) {
  const CameraFrame frame = make_camera_frame(make_camera(orbit, height, height));
  const auto step =
      static_cast<float>(2 * frame.half_height * orbit.distance_mm / std::max(1, height));
  orbit.target = orbit.target - frame.right * (static_cast<float>(dx) * step);
  orbit.target += frame.up * (static_cast<float>(dy) * step);
}

void zoom(Orbit& orbit, double steps) {
  orbit.distance_mm = std::clamp(orbit.distance_mm * std::pow(0.9, steps), 1e-3, 1e6);
}

std::optional<SurfacePoint> find_point(const Stage& stage, const Camera& camera, double px,
                                       double py) {
  const CameraRay ray = make_camera_ray(camera, px, py);
  const std::optional<Hit> hit =
      stage.tracer.intersect({.origin = ray.origin, .direction = ray.direction});
  if (!hit) return std::nullopt;
  return get_surface_point(stage.scene.mesh, hit->triangle, hit->barycentric);
}

std::optional<MapPlace> pick(const Stage& stage, const SampleGrid& grid, const Camera& camera,
                             double px, double py) {
  const std::optional<SurfacePoint> point = find_point(stage, camera, px, py);
  if (!point) return std::nullopt;
  const SamplePoint place = map_to_sample(stage.scene.mapping, grid, *point);
  return MapPlace{place.x, place.y};
}

}  // namespace parian

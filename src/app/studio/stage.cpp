#include "app/studio/stage.h"

#include <algorithm>
#include <cmath>

#include "scene/camera.h"

namespace parian {
namespace {

constexpr double degree = 0.017453292519943295;

Vec3 direction_of(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * degree, e = elevation_deg * degree;
  return {static_cast<float>(std::cos(e) * std::sin(a)), static_cast<float>(std::sin(e)),
          static_cast<float>(std::cos(e) * std::cos(a))};
}

}  // namespace

std::shared_ptr<const Stage> make_stage(Scene scene) {
  if (scene.mesh.normals.empty()) compute_normals(scene.mesh);
  RayTracer tracer(scene.mesh);
  const Bounds3 box = bounds(scene.mesh);
  return std::make_shared<const Stage>(Stage{std::move(scene), std::move(tracer), box});
}

Scene make_scene(const Stage& stage, const Material& material, const Lighting& lighting,
                 const Camera& camera) {
  Scene scene = stage.scene;
  scene.material = material;
  scene.layers.clear();
  scene.lights = make_lights(lighting);
  scene.camera = camera;
  scene.exposure = 0;
  return scene;
}

Orbit make_orbit(const Camera& camera) {
  const Vec3 from = camera.position - camera.target;
  const double r = std::max(1e-6, static_cast<double>(length(from)));
  const double height = std::clamp(static_cast<double>(from.y) / r, -1.0, 1.0);
  return {.target = camera.target,
          .yaw_deg = std::atan2(static_cast<double>(from.x), static_cast<double>(from.z)) / degree,
          .pitch_deg = std::asin(height) / degree,
          .distance_mm = r,
          .fov_deg = camera.fov_deg};
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

std::vector<Light> make_lights(const Lighting& lighting) {
  std::vector<Light> lights;
  if (lighting.image != nullptr && lighting.environment > 0) {
    const auto scale = static_cast<float>(lighting.environment);
    lights.emplace_back(EnvironmentLight{.image = *lighting.image,
                                         .rotation_deg = lighting.rotation_deg,
                                         .scale = {scale, scale, scale}});
  }
  if (lighting.lamp > 0) {
    const auto e = static_cast<float>(lighting.lamp);
    lights.emplace_back(
        DirectionalLight{.direction = direction_of(lighting.azimuth_deg, lighting.elevation_deg),
                         .irradiance = {e, e, e}});
  }
  return lights;
}

std::optional<MapPlace> pick(const Stage& stage, const SampleGrid& grid, const Camera& camera,
                             double px, double py) {
  const CameraRay ray = make_camera_ray(camera, px, py);
  const std::optional<Hit> hit =
      stage.tracer.intersect({.origin = ray.origin, .direction = ray.direction});
  if (!hit) return std::nullopt;
  const SurfacePoint point = get_surface_point(stage.scene.mesh, hit->triangle, hit->barycentric);
  const SamplePoint place = map_to_sample(stage.scene.mapping, grid, point);
  return MapPlace{place.x, place.y};
}

}  // namespace parian

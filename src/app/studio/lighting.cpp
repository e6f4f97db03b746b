#include "app/studio/lighting.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/environment.h"

namespace parian {
namespace {

constexpr double degree = 0.017453292519943295;

struct TakeLight {
  StageLight operator()(const DirectionalLight& light) const {
    return {.kind = LightKind::directional,
            .enabled = light.enabled,
            .place = light.direction,
            .power = light.irradiance};
  }
  StageLight operator()(const PointLight& light) const {
    return {.kind = LightKind::point,
            .enabled = light.enabled,
            .place = light.position,
            .power = light.intensity};
  }
  StageLight operator()(const EnvironmentLight& light) const {
    return {.kind = LightKind::environment,
            .enabled = light.enabled,
            .power = light.scale,
            .rotation_deg = light.rotation_deg,
            .sky = std::make_shared<const EnvironmentLight>(light)};
  }
};

Light make_light(const StageLight& light) {
  switch (light.kind) {
    case LightKind::directional:
      return DirectionalLight{light.place, light.power, light.enabled};
    case LightKind::point:
      return PointLight{light.place, light.power, light.enabled};
    case LightKind::environment:
      break;
  }
  EnvironmentLight environment = *light.sky;
  environment.rotation_deg = light.rotation_deg;
  environment.scale = light.power;
  environment.enabled = light.enabled;
  return environment;
}

}  // namespace

const std::vector<std::string>& light_kind_names() {
  static const std::vector<std::string> names{"lamp", "point light", "environment"};
  return names;
}

StageLight take_light(const Light& light) {
  return std::visit(TakeLight{}, light);
}

Lighting take_lights(const std::vector<Light>& lights) {
  Lighting lighting;
  lighting.reserve(lights.size());
  for (const Light& light : lights) lighting.push_back(take_light(light));
  return lighting;
}

Lighting only_enabled(Lighting lighting) {
  std::erase_if(lighting, [](const StageLight& light) { return !light.enabled; });
  return lighting;
}

std::vector<Light> make_lights(const Lighting& lighting, Disabled disabled) {
  std::vector<Light> lights;
  for (const StageLight& light : lighting)
    if (light.enabled || disabled == Disabled::keep) lights.push_back(make_light(light));
  return lights;
}

StageLight make_sky_light(const std::string& sky) {
  return take_light(EnvironmentLight{
      .image = sky == "clear" ? make_sky_image() : make_studio_image(), .sky = sky});
}

Lighting make_first_lighting() {
  StageLight studio = make_sky_light("studio");
  studio.power = {0.5f, 0.5f, 0.5f};
  return {{.place = direction_of(45, 40), .power = {2.5f, 2.5f, 2.5f}}, std::move(studio)};
}

Vec3 direction_of(double azimuth_deg, double elevation_deg) {
  const double a = azimuth_deg * degree, e = elevation_deg * degree;
  return {static_cast<float>(std::cos(e) * std::sin(a)), static_cast<float>(std::sin(e)),
          static_cast<float>(std::cos(e) * std::cos(a))};
}

LightAngles angles_of(const StageLight& light, Vec3 center) {
  const Vec3 from = light.kind == LightKind::point ? light.place - center : light.place;
  const double r = std::max(1e-6, static_cast<double>(length(from)));
  const double height = std::clamp(static_cast<double>(from.y) / r, -1.0, 1.0);
  return {std::atan2(static_cast<double>(from.x), static_cast<double>(from.z)) / degree,
          std::asin(height) / degree, r};
}

void set_angles(StageLight& light, const LightAngles& angles, Vec3 center) {
  const Vec3 towards = direction_of(angles.azimuth_deg, angles.elevation_deg);
  light.place = light.kind == LightKind::point
                    ? center + towards * static_cast<float>(angles.distance_mm)
                    : towards;
}

Vec3 direction_to(const StageLight& light, Vec3 center) {
  const LightAngles angles = angles_of(light, center);
  return direction_of(angles.azimuth_deg, angles.elevation_deg);
}

void turn_light(StageLight& light, double azimuth_deg, double elevation_deg, Vec3 center) {
  if (light.kind == LightKind::environment) {
    light.rotation_deg = std::remainder(light.rotation_deg + azimuth_deg, 360.0);
    return;
  }
  LightAngles angles = angles_of(light, center);
  angles.azimuth_deg = std::remainder(angles.azimuth_deg + azimuth_deg, 360.0);
  angles.elevation_deg = std::clamp(angles.elevation_deg + elevation_deg, -89.0, 89.0);
  set_angles(light, angles, center);
}

std::size_t find_light(const Lighting& lighting, std::size_t selected, bool is_environment) {
  const auto is_of_sort = [&](const StageLight& light) {
    return (light.kind == LightKind::environment) == is_environment;
  };
  if (selected < lighting.size() && is_of_sort(lighting[selected])) return selected;
  const auto found = std::find_if(lighting.begin(), lighting.end(), [&](const StageLight& light) {
    return light.enabled && is_of_sort(light);
  });
  return static_cast<std::size_t>(found - lighting.begin());
}

}  // namespace parian

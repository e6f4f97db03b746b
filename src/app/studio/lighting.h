// The lights around the stage, and how they are turned by dragging.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scene/read_scene.h"
#include "scene/scene.h"

namespace parian {

enum class LightKind { directional, point, environment };
const std::vector<std::string>& light_kind_names();

// A light of scene/scene.h; images are shared and never change.
struct StageLight {
  LightKind kind = LightKind::directional;
  bool enabled = true;
  Vec3 place{0, 1, 0};  // unit, towards a directional light; position of a point light, mm
  Rgb power{1, 1, 1};   // irradiance, intensity, or factor of an environment
  double rotation_deg = 0;
  std::shared_ptr<const EnvironmentLight> sky;  // image of an environment and where it is from
  friend bool operator==(const StageLight&, const StageLight&) = default;
};
using Lighting = std::vector<StageLight>;

StageLight take_light(const Light& light);
// Those that are on.
Lighting only_enabled(Lighting lighting);

Lighting take_lights(const std::vector<Light>& lights);
// Those that are on, in their order; all of them with the others where asked.
std::vector<Light> make_lights(const Lighting& lighting, Disabled disabled = Disabled::drop);

// An environment by code: "clear" or "studio".
StageLight make_sky_light(const std::string& sky);
// A lamp at the upper right and a dim studio.
Lighting make_first_lighting();

// As seen from a point that the object is around: azimuth from +z to +x.
struct LightAngles {
  double azimuth_deg = 0, elevation_deg = 0;
  double distance_mm = 1;  // of a point light
};
Vec3 direction_of(double azimuth_deg, double elevation_deg);
LightAngles angles_of(const StageLight& light, Vec3 center);
void set_angles(StageLight& light, const LightAngles& angles, Vec3 center);
// Towards it; unit.
Vec3 direction_to(const StageLight& light, Vec3 center);
// Lamps about the centre, environments about +y.
void turn_light(StageLight& light, double azimuth_deg, double elevation_deg, Vec3 center);

// Which light dragging turns: the selected one where it is of this sort, else the first that is on.
// None: as many as there are.
std::size_t find_light(const Lighting& lighting, std::size_t selected, bool is_environment);

}  // namespace parian

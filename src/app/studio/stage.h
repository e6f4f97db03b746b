// What stands on the stage: a mesh with its mapping, ready for rays, and how the camera and lights
// are set up around it by dragging.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "mesh/ray_tracer.h"
#include "scene/mapping.h"
#include "scene/scene.h"

namespace parian {

// Never changes once made; shared between threads.
struct Stage {
  Scene scene;  // its material, lights, camera are starting values only
  RayTracer tracer;
  Bounds3 box;
};
std::shared_ptr<const Stage> make_stage(Scene scene);

// A camera that looks at a point from a distance; angles in degrees, y up.
struct Orbit {
  Vec3 target;
  double yaw_deg = 20, pitch_deg = 15;
  double distance_mm = 100;
  double fov_deg = 30;
  friend bool operator==(const Orbit&, const Orbit&) = default;
};
Orbit make_orbit(const Camera& camera);
Orbit frame_stage(const Stage& stage, int width, int height);
Camera make_camera(const Orbit& orbit, int width, int height);
// By pixels dragged: a whole height of the picture is half a turn.
void turn(Orbit& orbit, double dx, double dy, int height);
void pan(Orbit& orbit, double dx, double dy, int height);
void zoom(Orbit& orbit, double steps);

// The one directional light that is dragged, and an environment.
struct Lighting {
  double azimuth_deg = 45, elevation_deg = 40;  // of the lamp, towards it
  double lamp = 2.5;                            // irradiance on a plane that faces it; 0: off
  double environment = 0.5;                     // factor; 0: off
  double rotation_deg = 0;                      // of the environment
  std::shared_ptr<const Image> image;           // null: none
  friend bool operator==(const Lighting&, const Lighting&) = default;
};
std::vector<Light> make_lights(const Lighting& lighting);

// The stage's mesh made of a material, under these lights.
Scene make_scene(const Stage& stage, const Material& material, const Lighting& lighting,
                 const Camera& camera);

// The place in the map under a pixel of the picture.
struct MapPlace {
  double x = 0, y = 0;  // pixels, centres at integers
};
std::optional<MapPlace> pick(const Stage& stage, const SampleGrid& grid, const Camera& camera,
                             double px, double py);

}  // namespace parian

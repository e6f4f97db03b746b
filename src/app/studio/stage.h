// What stands on the stage: a mesh with its mapping, ready for rays, and how the camera and layers
// are set up on it. Lights: lighting.h.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/studio/lighting.h"
#include "mesh/ray_tracer.h"
#include "scene/mapping.h"
#include "scene/scene.h"

namespace parian {

// Never changes once made; shared between threads.
struct Stage {
  Scene scene;  // without material, layers and lights; its camera is a starting value only
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
  double roll_deg = 0;  // of the picture's up from the y axis, to the right
  friend bool operator==(const Orbit&, const Orbit&) = default;
};
Orbit make_orbit(const Camera& camera);
Orbit frame_stage(const Stage& stage, int width, int height);
Camera make_camera(const Orbit& orbit, int width, int height);
// By pixels dragged: a whole height of the picture is half a turn.
void turn(Orbit& orbit, double dx, double dy, int height);
void pan(Orbit& orbit, double dx, double dy, int height);
void zoom(Orbit& orbit, double steps);

// Layers over the material, bottom up; an edit puts another one in the place of what was there.
using StageLayers = std::vector<std::shared_ptr<const SurfaceLayer>>;
// Why a layer cannot lie on this material and mesh; empty: it can.
std::string why_not(const SurfaceLayer& layer, const Stage& stage, const Material& material);
// Those that are on and can.
StageLayers shown_layers(const StageLayers& layers, const Stage& stage, const Material& material);
std::vector<SurfaceLayer> copy_layers(const StageLayers& layers);

// The stage's mesh made of a material under these layers (all are taken) and lights.
Scene make_scene(const Stage& stage, const Material& material, const StageLayers& layers,
                 const Lighting& lighting, const Camera& camera);

// The surface under a pixel of the picture, and its place in the map.
std::optional<SurfacePoint> find_point(const Stage& stage, const Camera& camera, double px,
                                       double py);
struct MapPlace {
  double x = 0, y = 0;  // pixels, centres at integers
};
std::optional<MapPlace> pick(const Stage& stage, const SampleGrid& grid, const Camera& camera,
                             double px, double py);

}  // namespace parian

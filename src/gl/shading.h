// From exitance to a picture: transmission towards the viewer, reflections of lights, environments
// behind the object.
#pragma once

#include <vector>

#include "gl/lamps.h"
#include "gl/self_occlusion.h"
#include "gl/surface_view.h"
#include "material/profile_map.h"
#include "scene/scene.h"

namespace parian {

// Parameters of every picture.
Param describe_antialias(int& antialias);
Param describe_shadow_size(int& shadow_size);
Param describe_reflection_rays(int& reflection_rays);

// What is drawn to: `exitance` pi / T times radiance, in [row][column] of all pixels drawn;
// `reflections` without exposure, kept until view, lights or eta change.
struct PictureTargets {
  GeometryBuffer geometry;
  Texture exitance, reflections, radiance;
  Framebuffer exitance_target, reflection_target, radiance_target;  // share the geometry's depth
  bool reflections_are_old = true;
};
PictureTargets make_picture_targets(int width, int height);

// Of lamp.glsl with one view or the six of a cube.
struct LampProgram {
  Program one, six;
  const Program& of(const Lamp& lamp) const { return lamp.views.size() == 1 ? one : six; }
};
LampProgram make_lamp_program(const std::vector<std::string_view>& fragment);

struct ShadingPrograms {
  Program shade;
  LampProgram reflection;
  Program sky_reflection, sky_background;
};
ShadingPrograms make_shading_programs();

// Lights as the device has them.
struct LightObjects {
  std::vector<Lamp> lamps;
  std::vector<Sky> skies;
};
// Those that `scene` shows or reflects; all lamps where flux is found with them.
LightObjects make_light_objects(const std::vector<Light>& lights, const Scene& scene,
                                const MeshBuffers& mesh, int shadow_size, bool with_flux);

// Whether reflections ask what the object hides of an environment.
bool reflects_environments(const Scene& scene);

struct ShadingInput {
  const Scene& scene;  // its exposure, background, environment and specular
  const SplatCamera& camera;
  const LightObjects& lights;
  const SelfOcclusion& occlusion;  // made where reflects_environments
  Boundary boundary = Boundary::excluded;
  double eta = 1.3;
  int reflection_rays = 16;
};
// Into targets.radiance: linear radiance times 2^exposure, and 1 where the mesh is.
void shade(PictureTargets& targets, const ShadingPrograms& programs, const ShadingInput& input);

// The mean over n x n pixels drawn; `coverage` gets that of their fourth component.
Image read_picture(const Framebuffer& radiance, int antialias, std::vector<float>& coverage);

}  // namespace parian

// What the renderer keeps between changes.
#pragma once

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "gl/shading.h"
#include "gl/splat_fit.h"
#include "gl/splat_levels.h"
#include "gl/splat_renderer.h"
#include "mesh/ray_tracer.h"
#include "mesh/surface_samples.h"

namespace parian {

// Changes when a field of another kind or size comes.
struct MaterialPrograms {
  std::vector<std::string> defines;  // what they were made with
  bool is_sparse = false;
  Program rows, resolve_single, resolve_group;
};

struct SplatRenderer::Impl {
  Scene scene;
  SplatParams params;
  SplatFormat format;
  SplatReport report;

  std::unique_ptr<RayTracer> tracer;
  std::vector<SurfacePoint> samples;  // in groups
  double area_mm2 = 0;
  NearRadii near;

  MeshBuffers mesh_buffers;
  Program geometry_program;
  ShadingPrograms shading_programs;
  LampProgram flux_program;
  SplatPrograms splat_programs;
  SourcePrograms source_programs;
  FitPrograms fit_programs;

  // The material as samples and pixels see it. Where layers count, each has textures of its own.
  double max_support_mm = 0;
  RadialLevels radial;
  std::unique_ptr<MaterialTextures> material, of_pixels;
  bool is_layered = false;
  bool pixels_are_old = true;                 // of_pixels
  SampleGrid grid;                            // of the material itself
  MaterialPrograms programs, other_programs;  // those before: edits often go back and forth
  Vec4 near_kernel{};

  Sources sources;
  std::vector<Rgb> flux;  // traced: of all lights, or of environments alone
  LightObjects lit;
  SelfOcclusion occlusion;
  bool flux_is_kept = false;
  bool groups_are_old = true;

  SplatCamera camera;
  PictureTargets targets;
  ViewPyramid pyramid;
  bool view_is_old = true;  // its textures
  bool geometry_is_drawn = false, pyramid_is_drawn = false;
  std::vector<float> coverage;

  void make_programs();
  void make_samples(const Progress& progress);

  // splat_material.cpp
  void set_material(const Material& next);
  void place_samples();
  void make_material_programs();
  void make_pixel_textures(const Progress& progress);

  void trace_flux(const std::vector<Light>& lights, const Progress& progress);
  void put_flux();
  void make_groups();
  void make_view();
  void resolve(int first, int count);
  ShadingInput shading_input() const {
    return {
        scene, camera, lit, occlusion, material->boundary, material->eta, params.reflection_rays};
  }
  TexelSizes texel_sizes() const { return {std::sqrt(area_mm2), params.texel, params.group_texel}; }
  SplatInput input() const {
    return {radial, material->reference, near_kernel, near, max_support_mm};
  }
};

}  // namespace parian

// A still picture that gets better while nothing moves: render() in small steps, tile by tile from
// the middle outwards. The first pass takes the tree at its quality; the next ones certify
// half-widths of the scattered light that halve from pass to pass, and tiles that hold a pass's
// half-width already are left alone. Where certifying costs more than the sum over all samples, the
// sum is taken, whose half-width is 0.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "image/image.h"
#include "render/render.h"

namespace parian {

struct RefinementParams {
  RenderParams render;           // its shading is always per pixel; method and tolerance rule here
  double first_tolerance = 0.2;  // of the second pass
  double tolerance = 0;          // of the last one; below least_certified every sample is summed
  int tile = 32;                 // pixels of a side
  // Half-widths below this one cost more than the sum over all samples (docs/rendering.md).
  static constexpr double least_certified = 0.1;
};
// Without those of `render`.
ParamList describe(RefinementParams& params);

struct RefinementReport {
  int pass = 0, passes = 0;  // passes: known once the preparation is done
  double tolerance = 1;      // of this pass; 1: by quality
  double done = 0;           // part of this pass
  // Certified relative half-widths of the exitance over all pixels that see the mesh; -1 until each
  // has one, or where profiles that rise allow no bracket. About the samples that were drawn: what
  // their number and the lights' rays cost in precision is not in them.
  double max_half_width = -1, mean_half_width = -1;
  double seconds = 0;  // of all steps
  std::vector<std::string> warnings;
};

// Nothing is computed until advance. What an edit does not touch is kept.
class Refinement {
 public:
  // Throws Error for parameters and layers as render does, and for memory beyond the machine's.
  explicit Refinement(Scene scene, const RefinementParams& params = {});
  ~Refinement();
  Refinement(Refinement&&) noexcept;
  Refinement& operator=(Refinement&&) noexcept;

  // Each starts the passes again. Samples stay; light does where the material changes but for its
  // boundary and index; everything but the view does where the camera changes.
  void set_material(const SurfaceMaterial& material);
  // With other layers over it, which are checked as the first ones.
  void set_material(const SurfaceMaterial& material, const std::vector<SurfaceLayer>& layers);
  void set_lights(const std::vector<Light>& lights);
  void set_camera(const Camera& camera);
  // What was gathered stays: the picture is shaded anew at once.
  void set_exposure(double stops);

  bool is_done() const;
  // One stage of the preparation, or one tile. Throws as render does; a step that throws, also on
  // cancellation, leaves the state as it was and can be done again. The same bits for any number of
  // threads.
  void advance(const Progress& progress = {});

  // As RenderResult::image, of the camera's size; black where half_width is nothing_yet.
  const Image& image() const;
  // [y][x], the largest of the pixel's surfaces: certified; no_bracket where there is a value
  // without one, nothing_yet where there is no value, 0 where the mesh is not seen.
  static constexpr float no_bracket = -1, nothing_yet = -2;
  const std::vector<float>& half_width() const;
  const RefinementReport& report() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

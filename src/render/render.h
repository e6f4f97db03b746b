// The CPU renderer: two passes (irradiance at area-uniform samples, then the gather) and a
// rough-dielectric reflection on top.
//
//   L(o) = T M(o) / pi + specular,  T = Fresnel transmission towards the viewer where the
//   material's boundary is excluded, otherwise 1
//
// The reflection sees lights and environment; where the object itself is in the way it is black
// (no inter-reflection). Directional and point lights are reflected in closed form, environments by
// a fixed number of rays, half of them by brightness (MIS). Highlights are widened by the spread of
// the normals within a sub-pixel, so that they do not sparkle.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/params.h"
#include "base/progress.h"
#include "image/image.h"
#include "scene/scene.h"

namespace parian {

// A table without a fit has no moments: it is gathered by brute force with either.
enum class GatherMethod { brute, tree };
// pixel: one gather per pixel and surface seen in it; Fresnel factor and reflection per ray.
// vertex: one per vertex, interpolated over the triangles.
enum class Shading { pixel, vertex };

struct RenderParams {
  GatherMethod method = GatherMethod::tree;
  Shading shading = Shading::pixel;
  int samples = 200000;     // irradiance samples on the surface
  int rays = 128;           // per sample and environment light
  int antialias = 3;        // n x n rays per pixel
  double quality = 0.0005;  // TreeGatherParams
  double tolerance = 0;     // TreeGatherParams
  std::uint64_t seed = 1;
};
ParamList describe(RenderParams& params);

// Seconds and counts, for the report and --json.
struct RenderReport {
  double sampling_s = 0, irradiance_s = 0, tree_s = 0, gather_s = 0, shading_s = 0, total_s = 0;
  std::string gather;  // what was done: "tree", "brute", or "table" (without a fit)
  std::size_t triangles = 0, vertices = 0, samples = 0, targets = 0;
  double area_mm2 = 0;
  double sample_spacing_mm = 0;
  double escaping_fraction = 0;                      // of rays sent inwards: holes in the mesh
  double max_half_width = -1, mean_half_width = -1;  // certified, relative; -1: none
  std::size_t certified = 0;
  double nodes_per_target = 0;
  std::vector<std::string> warnings;
};

struct RenderResult {
  // Linear radiance times 2^exposure, 3 channels; a background colour is put in as it is.
  Image image;
  RenderReport report;
};

// Bytes that render will need at most, from sizes alone, beside the scene itself.
std::size_t estimate_memory(const Scene& scene, const RenderParams& params);

// Of the machine; 0: unknown.
std::size_t physical_memory();

// Throws Error(resource) where `needed` exceeds the limit (0: physical memory). `advice` says what
// would need less.
void check_memory(std::size_t needed, std::size_t limit, const std::string& advice);

// Throws Error when more than 1 % of inward rays escape (names the mesh), and for memory beyond
// `memory_limit` bytes (0: physical memory). Holes, a camera inside the mesh and one that sees
// nothing of it are warnings. The same bits for any number of threads.
RenderResult render(const Scene& scene, const RenderParams& params = {},
                    const Progress& progress = {}, std::size_t memory_limit = 0);

}  // namespace parian

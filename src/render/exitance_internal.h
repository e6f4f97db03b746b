// The two passes: flux that enters at samples spread over the surface, and what leaves at targets.
#pragma once

#include <vector>

#include "base/progress.h"
#include "base/stopwatch.h"
#include "mesh/ray_tracer.h"
#include "mesh/surface_samples.h"
#include "render/places_internal.h"
#include "render/render.h"

namespace parian {

// M in W/mm^2 at each target; fills the report's times, method and brackets.
std::vector<Rgb> compute_exitance(const Scene& scene, const RayTracer& tracer,
                                  const SurfaceSamples& samples,
                                  const std::vector<MeshPlace>& targets, const RenderParams& params,
                                  RenderReport& report, const Progress& progress);

// Flux that enters at each sample, W.
std::vector<Rgb> compute_flux(const Scene& scene, const RayTracer& tracer,
                              const SurfaceSamples& samples, const RenderParams& params,
                              const Progress& progress);

// Light that scatters once, as exitance that looks the same from the camera: pi L / F_t.
std::vector<Rgb> compute_single_exitance(const GatherInput& input, const RayTracer& tracer,
                                         const Dipole& material, std::uint64_t seed,
                                         const Progress& progress);
// Of a scene of one homogeneous material that asks for it; otherwise null.
const Dipole* find_single_scattering(const Scene& scene, std::vector<std::string>& warnings);

// A place for each vertex.
std::vector<MeshPlace> vertex_places(const TriangleMesh& mesh);

}  // namespace parian

// The two passes: flux that enters at samples spread over the surface, and what leaves at targets.
#pragma once

#include <vector>

#include "base/progress.h"
#include "base/stopwatch.h"
#include "mesh/ray_tracer.h"
#include "mesh/surface_samples.h"
#include "render/primary_internal.h"
#include "render/render.h"

namespace parian {

// M in W/mm^2 at each target; fills the report's times, method and brackets.
std::vector<Rgb> compute_exitance(const Scene& scene, const RayTracer& tracer,
                                  const SurfaceSamples& samples,
                                  const std::vector<MeshPlace>& targets, const RenderParams& params,
                                  RenderReport& report, const Progress& progress);

// A place for each vertex.
std::vector<MeshPlace> vertex_places(const TriangleMesh& mesh);

}  // namespace parian

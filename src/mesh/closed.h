// Whether a surface is closed, as light inside sees it.
#pragma once

#include <string>
#include <vector>

#include "mesh/ray_tracer.h"
#include "mesh/surface_samples.h"

namespace parian {

// Part of the rays sent inwards from the samples that leave without meeting the inside of a face.
double measure_escapes(const SurfaceSamples& samples, const RayTracer& tracer);

// The same; throws Error naming the mesh when more than 1 % escape, and adds a warning for fewer.
double check_closed(const SurfaceSamples& samples, const RayTracer& tracer,
                    const std::string& mesh_name, std::vector<std::string>& warnings);

}  // namespace parian

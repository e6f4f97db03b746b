// Whether a surface is closed, as light inside sees it.
#pragma once

#include <string>
#include <vector>

#include "mesh/ray_tracer.h"
#include "mesh/surface_samples.h"

namespace parian {

// Whether the surface has no boundary and looks outward: along every edge, counted by where it is,
// as many triangles go one way as the other, and it encloses a positive volume. From outside no
// inside of a face is then seen. Wrong for one open surface in 2^64.
bool is_watertight(const TriangleMesh& mesh);

// Part of the rays sent inwards from the samples that leave without meeting the inside of a face.
double measure_escapes(const SurfaceSamples& samples, const RayTracer& tracer);

// The same; throws Error naming the mesh when more than 1 % escape, and adds a warning for fewer.
double check_closed(const SurfaceSamples& samples, const RayTracer& tracer,
                    const std::string& mesh_name, std::vector<std::string>& warnings);

}  // namespace parian

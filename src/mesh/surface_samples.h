// Points spread evenly over a surface, whatever its tessellation: each stands for the same area.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "mesh/mesh.h"

namespace parian {

// Triangles along a space-filling curve (Morton's) through their middles, so that consecutive ones
// are patches of the surface whatever the order in the file.
std::vector<std::uint32_t> order_triangles(const TriangleMesh& mesh);

// One at random in each of `count` equal parts of the area.
std::vector<Vec3> spread_points(const TriangleMesh& mesh, std::size_t count,
                                std::uint64_t seed = 1);

struct SurfaceSamples {
  std::vector<SurfacePoint> points;
  double area_mm2 = 0;        // of each: surface area / number of points
  double spacing_mm() const;  // sqrt(area_mm2)
};

// `count` blue-noise points: area-uniform candidates thinned by sample elimination (Yuksel 2015).
// Distances are straight lines; points whose triangles' normals are more than 107 degrees apart, as
// on the two sides of a thin sheet, are not neighbours. Neighbours keep about 0.55 spacing_mm().
// The same points for any number of threads; another seed gives other points.
SurfaceSamples make_surface_samples(const TriangleMesh& mesh, std::size_t count,
                                    std::uint64_t seed = 1, const Progress& progress = {});

}  // namespace parian

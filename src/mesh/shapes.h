// Closed shapes made by code, with normals and texture coordinates, centred on the origin: for
// tests, and for scenes without a mesh file.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mesh/mesh.h"

namespace parian {

// Longest side 1 mm unless said otherwise; use fit_to_size. `detail` >= 1 multiplies the
// resolution.
TriangleMesh make_sphere(int subdivisions);  // radius 1: icosahedron, 4^subdivisions * 20 faces
TriangleMesh make_box(Vec3 size, int divisions = 1);
TriangleMesh make_plane(double size, int divisions = 1);  // open, in the xz plane, facing +y
// A trefoil knot of varying thickness with knobs: thin, knobbly, closed.
TriangleMesh make_knot(int detail = 1);
// A draped, folded sheet with thickness: strong back-lighting.
TriangleMesh make_fin(int detail = 1);

// By name, for scene files: "sphere", "box", "slab", "knot", "fin".
const std::vector<std::string>& shape_names();
TriangleMesh make_shape(std::string_view name);  // throws Error naming the nearest known name

}  // namespace parian

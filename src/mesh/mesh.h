// Triangle meshes in mm, and points on them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "math/vec.h"

namespace parian {

// Counter-clockwise triangles seen from outside. normals and texcoords are per vertex and may be
// empty. Texture coordinates have v = 0 at the image's top row (io flips what other formats do).
struct TriangleMesh {
  std::vector<Vec3> positions;  // mm
  std::vector<Vec3> normals;    // unit length, outward
  std::vector<Vec2> texcoords;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  // What the vertices were before clean_mesh: index of each, and their number. Empty without it.
  std::vector<std::uint32_t> source;
  std::size_t source_vertices = 0;
};

// Vertices of the file that it is from.
inline std::size_t count_source_vertices(const TriangleMesh& mesh) {
  return mesh.source.empty() ? mesh.positions.size() : mesh.source_vertices;
}

Bounds3 bounds(const TriangleMesh& mesh);
double surface_area(const TriangleMesh& mesh);  // mm^2
double enclosed_volume(
    const TriangleMesh& mesh);  // mm^3, signed: positive where faces look outward

// A point of the surface: what hits, samples and vertices are turned into before they are shaded.
struct SurfacePoint {
  Vec3 position;
  Vec3 normal;            // interpolated, unit, outward
  Vec3 geometric_normal;  // of the triangle, unit, outward
  Vec2 texcoord;          // {0,0} without texture coordinates
  Vec3 dp_du;             // direction in which u (v) grows fastest, tangent to the triangle, mm per
  Vec3 dp_dv;             // unit of u (v); zero without texture coordinates
  std::uint32_t triangle = 0;
};
// barycentric = weights of the triangle's second and third vertex. The mesh has normals.
SurfacePoint get_surface_point(const TriangleMesh& mesh, std::uint32_t triangle, Vec2 barycentric);

// Area-weighted vertex normals from the triangles.
void compute_normals(TriangleMesh& mesh);

// What clean_mesh found and did.
struct MeshReport {
  std::size_t unused_vertices = 0;
  std::size_t merged_vertices = 0;
  std::size_t degenerate_triangles = 0;
  std::size_t cancelled_triangles = 0;  // pairs on the same places that look opposite ways
  std::size_t flipped_triangles = 0;
  std::size_t boundary_edges = 0;
  std::size_t nonmanifold_edges = 0;
};

// Makes a mesh from outside ready for use: drops unused vertices and triangles without area, merges
// vertices that agree in every attribute (positions alone for the topology), removes pairs of faces
// on the same places that look opposite ways (flaps of decimated scans), turns the faces of each
// component so that they agree and look outward, and computes normals where there are none.
// Components are what manifold edges connect. Closed ones, small gaps aside, enclose a positive
// volume, but cavities (inside a larger one and wound against the largest) a negative one; open
// ones keep the side of most of their area, unless most of the closed ones were inside out. Normals
// of the file are turned to the side of their faces. Throws Error with `name` as its file for no
// faces, indices out of range, non-finite values (names the vertex), attribute arrays of another
// length, and when every triangle is degenerate.
MeshReport clean_mesh(TriangleMesh& mesh, const std::string& name);

// Uniformly scaled so that the longest side of its box is size_mm, and centred on the origin in x
// and z with its lowest point at y = 0. y is up.
void fit_to_size(TriangleMesh& mesh, double size_mm);

}  // namespace parian

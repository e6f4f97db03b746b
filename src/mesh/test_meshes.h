// Meshes and points of them made by code, for tests.
#pragma once

#include <cstdint>

#include "mesh/mesh.h"
#include "mesh/surface_samples.h"

namespace parian {

inline SurfacePoint make_surface_point(Vec3 position, Vec3 normal) {
  SurfacePoint point;
  point.position = position;
  point.normal = point.geometric_normal = normalize(normal);
  return point;
}

inline void append_mesh(TriangleMesh& mesh, const TriangleMesh& other, Vec3 offset) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : other.positions) mesh.positions.push_back(p + offset);
  mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
  mesh.texcoords.clear();
  for (const auto& t : other.triangles)
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

}  // namespace parian

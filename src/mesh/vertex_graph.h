// Which places of a mesh edges join: to walk over its surface from vertex to vertex.
#pragma once

#include <cstdint>
#include <vector>

#include "mesh/mesh.h"

namespace parian {

// Vertices at one place, as along seams of texture coordinates, count as the first of them.
struct VertexGraph {
  std::vector<std::uint32_t> place;  // of each vertex: the first one there
  // By place: the others that edges join it to are others[begin[p]] ... others[begin[p + 1] - 1],
  // each as often as it shares triangles with it.
  std::vector<std::uint32_t> begin, others;
  std::vector<Vec3> normals;  // by place, unit, of all faces around it; zero where there are none
  double edge_mm = 0;         // mean length of edges
};
VertexGraph make_vertex_graph(const TriangleMesh& mesh);

}  // namespace parian

#include "mesh/vertex_graph.h"

#include "mesh/topology_internal.h"

namespace parian {

VertexGraph make_vertex_graph(const TriangleMesh& mesh) {
  VertexGraph graph;
  graph.place = weld_positions(mesh.positions);
  const std::size_t vertices = mesh.positions.size();
  graph.begin.assign(vertices + 2, 0);
  graph.others.resize(6 * mesh.triangles.size());
  std::vector<Vec3d> normals(vertices);
  double sum_mm = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3d normal = double_area_normal(mesh, t);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = graph.place[t[k]], to = graph.place[t[(k + 1) % 3]];
      graph.begin[std::size_t{from} + 2] += 2;
      normals[from] = normals[from] + normal;
      sum_mm += length(to_double(mesh.positions[to]) - to_double(mesh.positions[from]));
    }
  }
  for (std::size_t v = 2; v < graph.begin.size(); ++v) graph.begin[v] += graph.begin[v - 1];
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      for (const std::size_t step : {1u, 2u})
        graph.others[graph.begin[std::size_t{graph.place[t[k]]} + 1]++] =
            graph.place[t[(k + step) % 3]];
  graph.begin.pop_back();
  graph.normals.reserve(vertices);
  for (const Vec3d& normal : normals) graph.normals.push_back(to_unit(normal));
  if (!mesh.triangles.empty())
    graph.edge_mm = sum_mm / (3 * static_cast<double>(mesh.triangles.size()));
  return graph;
}

}  // namespace parian

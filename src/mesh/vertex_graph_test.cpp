#include "mesh/vertex_graph.h"

#include <gtest/gtest.h>

#include <set>

#include "mesh/shapes.h"

namespace parian {
namespace {

std::set<std::uint32_t> others_of(const VertexGraph& graph, std::uint32_t place) {
  return {graph.others.begin() + graph.begin[place], graph.others.begin() + graph.begin[place + 1]};
}

TEST(VertexGraph, JoinsWhatEdgesJoinAcrossSeams) {
  for (const TriangleMesh& mesh : {make_sphere(2), make_box({1, 2, 3}, 4), make_knot()}) {
    const VertexGraph graph = make_vertex_graph(mesh);
    ASSERT_EQ(graph.place.size(), mesh.positions.size());
    std::size_t places = 0, links = 0;
    for (std::uint32_t v = 0; v < mesh.positions.size(); ++v) {
      EXPECT_EQ(mesh.positions[graph.place[v]], mesh.positions[v]);
      if (graph.place[v] != v) {
        EXPECT_EQ(graph.begin[v], graph.begin[v + 1]);
        continue;
      }
      ++places;
      const auto others = others_of(graph, v);
      links += others.size();
      EXPECT_FALSE(others.contains(v));
      for (const std::uint32_t other : others) EXPECT_TRUE(others_of(graph, other).contains(v));
    }
    // Of a closed surface: Euler's V - E + F = 2, or 0 for the knot, which is a ring.
    const double euler = static_cast<double>(places) - 0.5 * static_cast<double>(links) +
                         static_cast<double>(mesh.triangles.size());
    EXPECT_TRUE(euler == 2 || euler == 0) << euler;
  }
}

TEST(VertexGraph, KnowsNormalsAndEdges) {
  const VertexGraph sphere = make_vertex_graph(make_sphere(4));
  const TriangleMesh mesh = make_sphere(4);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    EXPECT_GT(dot(sphere.normals[sphere.place[v]], normalize(mesh.positions[v])), 0.999f);
  // The side of a triangle of a 20 * 4^4th of the area, nearly equilateral.
  EXPECT_NEAR(sphere.edge_mm, 0.0753, 0.004);
  // Around a corner of a box normals of all its faces count.
  const TriangleMesh box = make_box({2, 2, 2}, 1);
  const VertexGraph corners = make_vertex_graph(box);
  for (std::size_t v = 0; v < box.positions.size(); ++v)
    EXPECT_GT(dot(corners.normals[corners.place[v]], normalize(box.positions[v])), 0.8f);
}

}  // namespace
}  // namespace parian

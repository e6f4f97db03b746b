#include "scene/mask_brush.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/shapes.h"
#include "mesh/test_meshes.h"

namespace parian {
namespace {

// Where the mesh is nearest to a place: the middle of a triangle.
SurfacePoint nearest_point(const TriangleMesh& mesh, Vec3 place) {
  SurfacePoint best;
  float least = 1e30f;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const SurfacePoint point = get_surface_point(mesh, t, {1 / 3.0f, 1 / 3.0f});
    if (const float apart = length(point.position - place); apart < least) {
      least = apart;
      best = point;
    }
  }
  return best;
}

VertexMask nothing_on(const TriangleMesh& mesh) {
  return {std::vector<float>(mesh.positions.size(), 0)};
}

std::vector<float> paint_at(const TriangleMesh& mesh, const MaskBrush& brush,
                            const VertexMask& before, const std::vector<Vec3>& places) {
  const VertexGraph graph = make_vertex_graph(mesh);
  MaskStroke stroke = start_stroke(brush, before, mesh);
  for (const Vec3 place : places) touch(stroke, mesh, graph, nearest_point(mesh, place));
  return paint(stroke, mesh, graph).weights;
}

TEST(MaskBrush, TouchesWhatIsNear) {
  const TriangleMesh mesh = make_sphere(5);
  const SurfacePoint at = nearest_point(mesh, {0.3f, 0.8f, 0.5f});
  for (const double softness : {0.0, 0.4, 1.0}) {
    const MaskBrush brush{.radius_mm = 0.5, .softness = softness};
    const std::vector<float> weights =
        paint_at(mesh, brush, nothing_on(mesh), {{0.3f, 0.8f, 0.5f}});
    for (std::size_t v = 0; v < weights.size(); ++v) {
      const double t = (0.5 - static_cast<double>(length(mesh.positions[v] - at.position))) /
                       (0.5 * std::max(softness, 1e-9));
      const double s = std::clamp(t, 0.0, 1.0);
      EXPECT_NEAR(weights[v], s * s * (3 - 2 * s), 6e-4) << v;
    }
  }
}

TEST(MaskBrush, SlowStrokesAreLikeQuickOnes) {
  const TriangleMesh mesh = make_sphere(4);
  const MaskBrush brush{.radius_mm = 0.4, .softness = 0.6, .strength = 0.5};
  const std::vector<Vec3> once{{1, 0, 0}, {0, 1, 0}},
      twice{{1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  const std::vector<float> quick = paint_at(mesh, brush, nothing_on(mesh), once);
  EXPECT_EQ(quick, paint_at(mesh, brush, nothing_on(mesh), twice));
  // A second stroke goes over the first.
  const std::vector<float> second = paint_at(mesh, brush, {quick}, once);
  EXPECT_EQ(*std::max_element(quick.begin(), quick.end()), 0.5f);
  EXPECT_EQ(*std::max_element(second.begin(), second.end()), 0.75f);
  // And the eraser takes away the same part of what is there.
  MaskBrush eraser = brush;
  eraser.erases = true;
  const std::vector<float> erased = paint_at(mesh, eraser, {second}, once);
  for (std::size_t v = 0; v < erased.size(); ++v) {
    const double w = second[v], part = quick[v];
    EXPECT_NEAR(erased[v], w * (1 - part), 1.5e-3);
    EXPECT_LE(erased[v], second[v]);
  }
  eraser.strength = 1;
  eraser.softness = 0;
  eraser.radius_mm = 3;
  for (const float w : paint_at(mesh, eraser, {second}, {{1, 0, 0}, {-1, 0, 0}})) EXPECT_EQ(w, 0);
}

TEST(MaskBrush, StaysOnTheSideThatItTouches) {
  // The other side of a slab is near, and joined around the rim.
  const TriangleMesh slab = make_box({4, 0.2f, 4}, 24);
  const std::vector<float> weights =
      paint_at(slab, {.radius_mm = 0.8, .softness = 0}, nothing_on(slab), {{1.9f, 0.1f, 0}});
  int above = 0, rim = 0;
  for (std::size_t v = 0; v < weights.size(); ++v) {
    const Vec3 p = slab.positions[v];
    if (p.y < -0.09f && std::abs(p.x) < 1.9f) {
      EXPECT_EQ(weights[v], 0) << v;
    }
    above += p.y > 0.09f && weights[v] > 0 ? 1 : 0;
    rim += p.x > 1.99f && weights[v] > 0 ? 1 : 0;
  }
  EXPECT_GT(above, 20);
  EXPECT_GT(rim, 3);  // it goes around the edge
  // Another part of the object that is near is not joined.
  TriangleMesh two = make_sphere(3);
  const std::size_t first = two.positions.size();
  append_mesh(two, make_sphere(3), {2.05f, 0, 0});
  const std::vector<float> one =
      paint_at(two, {.radius_mm = 0.6, .softness = 0}, nothing_on(two), {{0.9f, 0.2f, 0}});
  EXPECT_GT(*std::max_element(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(first)), 0);
  EXPECT_EQ(*std::max_element(one.begin() + static_cast<std::ptrdiff_t>(first), one.end()), 0);
}

TEST(MaskBrush, ReachesVerticesThatAreFarApart) {
  const TriangleMesh mesh = make_box({2, 2, 2}, 2);
  const std::vector<float> weights =
      paint_at(mesh, {.radius_mm = 0.01, .softness = 0.5}, nothing_on(mesh), {{0.4f, 1, 0.3f}});
  EXPECT_GT(*std::max_element(weights.begin(), weights.end()), 0.5f);
}

TEST(MaskBrush, SamplesAnyMask) {
  TriangleMesh mesh = make_sphere(3);
  const SurfaceMask mask{{GradientMask{{0, -1, 0}, {0, 1, 0}}},
                         {SphereMask{{1, 0, 0}, 1, 0.5}, true}};
  const VertexMask sampled = sample_at_vertices(mask, mesh);
  ASSERT_EQ(sampled.weights.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    EXPECT_NEAR(sampled.weights[v],
                eval_mask(mask, mesh, make_surface_point(mesh.positions[v], mesh.positions[v])),
                5.1e-4);
  EXPECT_EQ(sample_at_vertices({}, mesh).weights, std::vector<float>(mesh.positions.size(), 1));
  // Weights stand where the file has the vertices; what no face has is 0.
  const std::size_t count = mesh.positions.size();
  for (std::size_t v = 0; v < count; ++v)
    mesh.source.push_back(static_cast<std::uint32_t>(2 * (count - v) - 1));
  mesh.source_vertices = 2 * count;
  const VertexMask spread = sample_at_vertices(mask, mesh);
  for (std::size_t v = 0; v < count; ++v) {
    EXPECT_EQ(spread.weights[mesh.source[v]], sampled.weights[v]);
    EXPECT_EQ(spread.weights[mesh.source[v] - 1], 0);
  }
  // A stroke too.
  const std::vector<float> painted = paint_at(mesh, {.radius_mm = 0.5}, spread, {{0, -1, 0}});
  EXPECT_NO_THROW(check({{VertexMask{painted}}}, mesh, {}, {}));
  std::size_t changed = 0;
  for (std::size_t i = 0; i < painted.size(); ++i)
    changed += painted[i] != spread.weights[i] && i % 2 == 1 ? 1 : 0;
  EXPECT_GT(changed, 20u);
}

}  // namespace
}  // namespace parian

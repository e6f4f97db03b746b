#include "mesh/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/test_errors.h"

namespace parian {
namespace {

void expect_closed(TriangleMesh mesh, const std::string& name) {
  const std::size_t vertices = mesh.positions.size();
  ASSERT_EQ(mesh.normals.size(), vertices) << name;
  ASSERT_EQ(mesh.texcoords.size(), vertices) << name;
  for (std::size_t v = 0; v < vertices; ++v) {
    EXPECT_NEAR(length(mesh.normals[v]), 1, 1e-5) << name;
    EXPECT_TRUE(mesh.texcoords[v].x >= 0 && mesh.texcoords[v].x <= 1) << name;
    EXPECT_TRUE(mesh.texcoords[v].y >= 0 && mesh.texcoords[v].y <= 1) << name;
  }
  EXPECT_GT(enclosed_volume(mesh), 0) << name;
  const Vec3 middle = center(bounds(mesh));
  EXPECT_LT(length(middle), 1e-5f) << name;
  std::size_t against = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const SurfacePoint point = get_surface_point(mesh, t, {0.3f, 0.3f});
    if (dot(point.normal, point.geometric_normal) < 0.5f) ++against;
  }
  EXPECT_LE(against, mesh.triangles.size() / 200) << name;
  const MeshReport report = clean_mesh(mesh, name);
  EXPECT_EQ(report.boundary_edges, 0u) << name;
  EXPECT_EQ(report.nonmanifold_edges, 0u) << name;
  EXPECT_EQ(report.degenerate_triangles, 0u) << name;
  EXPECT_EQ(report.flipped_triangles, 0u) << name;
}

TEST(Shapes, AreClosed) {
  for (const std::string& name : shape_names()) expect_closed(make_shape(name), name);
  expect_closed(make_knot(2), "knot 2");
  expect_closed(make_fin(2), "fin 2");
  expect_closed(make_sphere(0), "icosahedron");
  expect_closed(make_box({1, 2, 3}, 7), "box 7");
}

TEST(Shapes, HaveTheirSizes) {
  for (const char* name : {"knot", "fin", "box", "slab"}) {
    const Vec3 size = extent(bounds(make_shape(name)));
    EXPECT_NEAR(std::max({size.x, size.y, size.z}), 1, 1e-5) << name;
  }
  EXPECT_EQ(make_sphere(3).triangles.size(), 20u * 64u);
  EXPECT_EQ(make_box({1, 1, 1}, 3).triangles.size(), 108u);
  EXPECT_EQ(make_plane(2, 3).triangles.size(), 18u);
  EXPECT_NEAR(surface_area(make_plane(2, 3)), 4, 1e-6);
}

// Thin means: a small volume for its surface. Mean thickness of a sheet = 2 V / A, of a rod 4 V /
// A.
TEST(Shapes, KnotAndFinAreThin) {
  const TriangleMesh knot = make_knot();
  EXPECT_LT(4 * enclosed_volume(knot) / surface_area(knot), 0.12);
  const TriangleMesh fin = make_fin();
  EXPECT_LT(2 * enclosed_volume(fin) / surface_area(fin), 0.02);
}

TEST(Shapes, PlaneFacesUpWithVAtTheBack) {
  const TriangleMesh plane = make_plane(2, 2);
  const SurfacePoint point = get_surface_point(plane, 0, {0.25f, 0.25f});
  EXPECT_EQ(point.geometric_normal, (Vec3{0, 1, 0}));
  EXPECT_LT(distance(point.dp_du, {2, 0, 0}), 1e-5f);
  EXPECT_LT(distance(point.dp_dv, {0, 0, 2}), 1e-5f);
}

TEST(Shapes, UnknownNamesGetAHint) {
  EXPECT_EQ(error_of([&] { make_shape("knott"); }),
            "shape: expected 'sphere', 'box', 'slab', 'knot' or 'fin', found 'knott' (did you "
            "mean 'knot'?)");
}

}  // namespace
}  // namespace parian

#include "mesh/mesh.h"

#include <gtest/gtest.h>

#include <numbers>

#include "mesh/shapes.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

TEST(Mesh, BoxHasItsAreaAndVolume) {
  TriangleMesh box = make_box({1, 2, 3}, 4);
  EXPECT_NEAR(surface_area(box), 22, 1e-5);
  EXPECT_NEAR(enclosed_volume(box), 6, 1e-5);
  // Far from the origin too.
  for (Vec3& p : box.positions) p += {1000, 2000, -500};
  EXPECT_NEAR(enclosed_volume(box), 6, 1e-3);
  for (auto& t : box.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(enclosed_volume(box), -6, 1e-3);
}

TEST(Mesh, SphereConvergesAsTheSquareOfTheEdge) {
  const double coarse = 4 * pi - surface_area(make_sphere(3));
  const double fine = 4 * pi - surface_area(make_sphere(4));
  EXPECT_NEAR(coarse / fine, 4, 0.05);
  EXPECT_NEAR(enclosed_volume(make_sphere(5)), 4 * pi / 3, 4e-3);
}

TEST(Mesh, NormalsOfASphereArePositions) {
  TriangleMesh sphere = make_sphere(4);
  const std::vector<Vec3> expected = sphere.normals;
  sphere.normals.clear();
  compute_normals(sphere);
  for (std::size_t v = 0; v < expected.size(); ++v)
    EXPECT_GT(dot(sphere.normals[v], expected[v]), 0.9999f);
}

TEST(Mesh, TextureSeamsAreNoCreases) {
  // Two halves of a roof that share positions but no vertices.
  TriangleMesh roof;
  roof.positions = {{0, 1, 0}, {0, 1, 1}, {1, 0, 0}, {0, 1, 1}, {0, 1, 0}, {-1, 0, 0}};
  roof.triangles = {{0, 1, 2}, {3, 4, 5}};
  compute_normals(roof);
  EXPECT_EQ(roof.normals[0], roof.normals[4]);
  EXPECT_NE(roof.normals[2], roof.normals[5]);
}

TEST(Mesh, ZeroThicknessStillHasNormals) {
  TriangleMesh sheet;
  sheet.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 1}};
  compute_normals(sheet);
  for (const Vec3& n : sheet.normals) EXPECT_EQ(n, (Vec3{0, 0, 1}));
}

TEST(Mesh, FitToSizeStandsOnTheGround) {
  TriangleMesh box = make_box({1, 4, 2});
  for (Vec3& p : box.positions) p += {7, 8, 9};
  fit_to_size(box, 80);
  const Bounds3 b = bounds(box);
  EXPECT_NEAR(extent(b).y, 80, 1e-4);
  EXPECT_NEAR(b.lower.y, 0, 1e-4);
  EXPECT_NEAR(center(b).x, 0, 1e-4);
  EXPECT_NEAR(center(b).z, 0, 1e-4);
}

// Texture coordinates u = x / 4 + z / 8, v = z: not at right angles.
TEST(Mesh, TextureFrameIsWhereCoordinatesGrowFastest) {
  TriangleMesh plane = make_plane(2);
  for (std::size_t v = 0; v < plane.positions.size(); ++v) {
    const Vec3 p = plane.positions[v];
    plane.texcoords[v] = {p.x / 4 + p.z / 8, p.z};
  }
  const SurfacePoint point = get_surface_point(plane, 0, {0.2f, 0.3f});
  EXPECT_NEAR(point.texcoord.x, point.position.x / 4 + point.position.z / 8, 1e-6);
  EXPECT_NEAR(point.texcoord.y, point.position.z, 1e-6);
  const Vec3 gradient{1 / 4.0f, 0, 1 / 8.0f};
  EXPECT_LT(distance(point.dp_du, gradient / dot(gradient, gradient)), 1e-5f);
  EXPECT_LT(distance(point.dp_dv, {0, 0, 1}), 1e-6f);
  EXPECT_EQ(point.geometric_normal, (Vec3{0, 1, 0}));
}

TEST(Mesh, PointsInterpolate) {
  const TriangleMesh sphere = make_sphere(2);
  for (std::uint32_t t = 0; t < sphere.triangles.size(); t += 7) {
    const SurfacePoint point = get_surface_point(sphere, t, {0.25f, 0.5f});
    const auto& [a, b, c] = sphere.triangles[t];
    const Vec3 p =
        sphere.positions[a] * 0.25f + sphere.positions[b] * 0.25f + sphere.positions[c] * 0.5f;
    EXPECT_LT(distance(point.position, p), 1e-6f);
    EXPECT_LT(distance(point.normal, normalize(p)), 1e-6f);
    EXPECT_GT(dot(point.geometric_normal, point.normal), 0.97f);
    EXPECT_NEAR(dot(point.dp_du, point.geometric_normal), 0, 1e-4f * length(point.dp_du));
    EXPECT_EQ(point.triangle, t);
  }
}

}  // namespace
}  // namespace parian

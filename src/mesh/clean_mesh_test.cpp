#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/random.h"
#include "base/test_errors.h"
#include "mesh/mesh.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

std::string clean_error(TriangleMesh mesh) {
  return error_of([&] { clean_mesh(mesh, "m.ply"); });
}

TriangleMesh bare_sphere(int subdivisions) {
  TriangleMesh mesh = make_sphere(subdivisions);
  mesh.normals.clear();
  mesh.texcoords.clear();
  return mesh;
}

void append(TriangleMesh& mesh, const TriangleMesh& other, float scale, Vec3 offset,
            bool reversed = false) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  for (const Vec3& p : other.positions) mesh.positions.push_back(p * scale + offset);
  for (auto t : other.triangles) {
    if (reversed) std::swap(t[1], t[2]);
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
}

void flip_some(TriangleMesh& mesh, double share) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    if (hash_to_uniform(hash_u64(t)) < share) std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
}

TEST(CleanMesh, LeavesACleanMeshAlone) {
  for (const std::string& name : shape_names()) {
    const TriangleMesh original = make_shape(name);
    TriangleMesh mesh = original;
    const MeshReport report = clean_mesh(mesh, name);
    EXPECT_EQ(report.unused_vertices + report.degenerate_triangles + report.flipped_triangles, 0u)
        << name;
    EXPECT_EQ(report.boundary_edges + report.nonmanifold_edges, 0u) << name;
    EXPECT_EQ(mesh.triangles.size(), original.triangles.size());
  }
}

TEST(CleanMesh, FacesAgreeAndLookOutward) {
  for (const double share : {0.1, 0.9, 1.0}) {
    TriangleMesh mesh = bare_sphere(3);
    const double volume = enclosed_volume(mesh);
    flip_some(mesh, share);
    const MeshReport report = clean_mesh(mesh, "m");
    EXPECT_DOUBLE_EQ(enclosed_volume(mesh), volume);
    EXPECT_GT(report.flipped_triangles, 0u);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      EXPECT_GT(dot(mesh.normals[v], mesh.positions[v]), 0.99f);
  }
}

TEST(CleanMesh, SeparatePiecesEachLookOutward) {
  TriangleMesh mesh = bare_sphere(2);
  append(mesh, bare_sphere(2), 0.5f, {3, 0, 0}, true);
  clean_mesh(mesh, "m");
  EXPECT_NEAR(enclosed_volume(mesh), 1.125 * enclosed_volume(bare_sphere(2)), 1e-5);
}

TEST(CleanMesh, CavitiesStayCavities) {
  const double ball = enclosed_volume(bare_sphere(2));
  // A shell wound against the ball around it, then with a core inside; all of it inside out, too.
  for (const bool reversed : {false, true}) {
    TriangleMesh mesh;
    append(mesh, bare_sphere(2), 1, {}, reversed);
    append(mesh, bare_sphere(2), 0.5f, {}, !reversed);
    TriangleMesh cored = mesh;
    append(cored, bare_sphere(2), 0.25f, {}, reversed);
    clean_mesh(mesh, "m");
    EXPECT_NEAR(enclosed_volume(mesh), ball * (1 - 0.125), 1e-5);
    clean_mesh(cored, "m");
    EXPECT_NEAR(enclosed_volume(cored), ball * (1 - 0.125 + 0.015625), 1e-5);
  }
  // Within the box of the large one, but not inside it.
  TriangleMesh mesh = bare_sphere(2);
  append(mesh, bare_sphere(2), 0.05f, {0.8f, 0.8f, 0.8f}, true);
  clean_mesh(mesh, "m");
  EXPECT_NEAR(enclosed_volume(mesh), ball * (1 + 0.000125), 1e-6);
}

TEST(CleanMesh, OpenMeshesKeepTheirSide) {
  for (const bool down : {false, true}) {
    TriangleMesh mesh = make_plane(1, 8);
    mesh.normals.clear();
    if (down)
      for (auto& t : mesh.triangles) std::swap(t[0], t[1]);
    std::swap(mesh.triangles[20][0], mesh.triangles[20][1]);
    const MeshReport report = clean_mesh(mesh, "m");
    EXPECT_EQ(report.flipped_triangles, 1u);
    EXPECT_EQ(report.boundary_edges, 32u);
    for (const Vec3& n : mesh.normals) EXPECT_EQ(n.y, down ? -1 : 1);
  }
}

TEST(CleanMesh, HolesDoNotHideWhichSideIsOut) {
  TriangleMesh mesh = bare_sphere(3);
  flip_some(mesh, 1);
  mesh.triangles.resize(mesh.triangles.size() - 40);
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 50)
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
  const MeshReport report = clean_mesh(mesh, "m");
  EXPECT_GT(report.boundary_edges, 50u);
  EXPECT_GT(enclosed_volume(mesh), 3);
}

TEST(CleanMesh, DropsAndMerges) {
  TriangleMesh mesh = bare_sphere(1);
  const std::size_t vertices = mesh.positions.size();
  const std::size_t triangles = mesh.triangles.size();
  mesh.positions.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});  // unused
  mesh.positions.push_back(mesh.positions[3]);
  for (std::uint32_t& v : mesh.triangles[0]) v = v == 3 ? 43 : v;
  mesh.triangles.push_back({1, 2, 2});
  mesh.triangles.push_back({1, 43, 3});
  const MeshReport report = clean_mesh(mesh, "m");
  EXPECT_EQ(vertices, 42u);
  EXPECT_EQ(report.unused_vertices, 1u);
  EXPECT_EQ(report.merged_vertices, 1u);
  EXPECT_EQ(report.degenerate_triangles, 2u);
  EXPECT_EQ(report.boundary_edges, 0u);
  EXPECT_EQ(mesh.positions.size(), vertices);
  EXPECT_EQ(mesh.triangles.size(), triangles);
}

TEST(CleanMesh, SeamsAreNoBoundaries) {
  // A box keeps 24 vertices (its normals differ), but has 8 positions and no boundary.
  TriangleMesh mesh = make_box({1, 1, 1});
  EXPECT_EQ(clean_mesh(mesh, "m").boundary_edges, 0u);
  EXPECT_EQ(mesh.positions.size(), 24u);
  // Three faces on one edge.
  mesh.positions = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}};
  mesh.normals.clear();
  mesh.texcoords.clear();
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
  const MeshReport report = clean_mesh(mesh, "m");
  EXPECT_EQ(report.nonmanifold_edges, 1u);
  EXPECT_EQ(report.boundary_edges, 6u);
}

TEST(CleanMesh, GivenNormalsFollowTheFaces) {
  TriangleMesh mesh = make_sphere(3);
  const std::vector<Vec3> expected = mesh.normals;
  for (Vec3& n : mesh.normals) n = n * -3.0f;
  mesh.normals[5] = {};
  mesh.normals[6] = -mesh.normals[6];
  clean_mesh(mesh, "m");
  for (std::size_t v = 0; v < expected.size(); ++v)
    EXPECT_GT(dot(mesh.normals[v], expected[v]), v == 5 || v == 6 ? 0.99f : 0.999999f);
}

TEST(CleanMesh, ErrorsNameTheFault) {
  const TriangleMesh good = make_sphere(0);
  TriangleMesh mesh = good;
  mesh.triangles.clear();
  EXPECT_EQ(clean_error(mesh), "m.ply: expected a mesh with faces, found no faces");
  mesh = good;
  mesh.triangles[3][1] = 12;
  EXPECT_EQ(clean_error(mesh), "m.ply: triangle 3: expected a vertex below 12, found 12");
  mesh = good;
  mesh.positions[7].y = std::numeric_limits<float>::quiet_NaN();
  mesh.positions[7].x = mesh.positions[7].z = 1;
  EXPECT_EQ(clean_error(mesh),
            "m.ply: vertex 7: expected coordinates that are finite and below 1e15, found (1, nan, "
            "1)");
  mesh = good;
  mesh.normals[2] = {0, std::numeric_limits<float>::infinity(), 0};
  EXPECT_EQ(clean_error(mesh), "m.ply: vertex 2: expected a finite normal, found (0, inf, 0)");
  mesh = good;
  mesh.texcoords[2] = {0, std::numeric_limits<float>::infinity()};
  EXPECT_EQ(clean_error(mesh),
            "m.ply: vertex 2: expected finite texture coordinates, found (0, inf)");
  mesh = good;
  mesh.normals.pop_back();
  EXPECT_EQ(clean_error(mesh), "m.ply: normals: expected 12, one per vertex, found 11");
  mesh = good;
  mesh.triangles = {{0, 0, 1}, {2, 3, 3}};
  EXPECT_EQ(clean_error(mesh),
            "m.ply: expected a mesh with faces, found 2 triangles, none of which has an area");
}

// A flap glued onto a face: two triangles back to back on the same places.
TEST(CleanMesh, CancelsFlaps) {
  TriangleMesh box = make_box({1, 1, 1}, 2);
  box.normals.clear();
  box.texcoords.clear();
  TriangleMesh plain = box;
  clean_mesh(plain, "box");
  const auto tip = static_cast<std::uint32_t>(box.positions.size());
  box.positions.push_back({2, 2, 2});
  box.triangles.push_back({0, 1, tip});
  box.triangles.push_back({tip, 1, 0});
  const MeshReport report = clean_mesh(box, "box");
  EXPECT_EQ(report.cancelled_triangles, 2u);
  EXPECT_EQ(report.nonmanifold_edges + report.boundary_edges, 0u);
  EXPECT_EQ(box.triangles.size(), plain.triangles.size());
  EXPECT_EQ(box.positions.size(), plain.positions.size());
  EXPECT_EQ(surface_area(box), surface_area(plain));
}

// A sheet with two sides is all flaps, and stays.
TEST(CleanMesh, LeavesTwoSidedSheets) {
  TriangleMesh sheet = make_plane(1, 2);
  const std::size_t count = sheet.triangles.size();
  for (std::size_t t = 0; t < count; ++t) {
    const std::array<std::uint32_t, 3> v = sheet.triangles[t];
    sheet.triangles.push_back({v[0], v[2], v[1]});
  }
  EXPECT_EQ(clean_mesh(sheet, "sheet").cancelled_triangles, 0u);
  EXPECT_EQ(sheet.triangles.size(), 2 * count);
}

}  // namespace
}  // namespace parian

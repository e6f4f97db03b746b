#include "mesh/closed.h"

#include <gtest/gtest.h>

#include <utility>

#include "base/error.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

constexpr std::size_t samples = 4000;

struct Findings {
  double fraction = 0;
  std::vector<std::string> warnings;
  std::string error;
};

Findings look(const TriangleMesh& mesh) {
  const RayTracer tracer(mesh);
  const SurfaceSamples surface = make_surface_samples(mesh, samples);
  Findings findings;
  findings.fraction = measure_escapes(surface, tracer);
  try {
    EXPECT_EQ(check_closed(surface, tracer, "ball.ply", findings.warnings), findings.fraction);
  } catch (const Error& error) {
    findings.error = error.what();
  }
  return findings;
}

void turn_inside_out(TriangleMesh& mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  for (Vec3& normal : mesh.normals) normal = -normal;
}

TEST(Closed, ClosedMeshesHaveNoEscapes) {
  for (const TriangleMesh& mesh : {make_sphere(3), make_box({1, 2, 3}), make_knot()}) {
    const Findings findings = look(mesh);
    EXPECT_EQ(findings.fraction, 0);
    EXPECT_TRUE(findings.warnings.empty());
    EXPECT_EQ(findings.error, "");
  }
}

// Rays through the centre of a ball leave where its faces are missing: that part of all.
TEST(Closed, EscapesAreThePartThatIsMissing) {
  const TriangleMesh whole = make_sphere(4);
  for (const std::size_t missing : {std::size_t{20}, std::size_t{400}}) {
    TriangleMesh mesh = whole;
    mesh.triangles.resize(whole.triangles.size() - missing);
    const double expected =
        static_cast<double>(missing) / static_cast<double>(whole.triangles.size());
    const Findings findings = look(mesh);
    EXPECT_NEAR(findings.fraction, expected, 0.3 * expected);
    const std::string found = findings.error.empty() ? findings.warnings.at(0) : findings.error;
    EXPECT_NE(found.find(" of 4000 rays into the mesh escape ("), std::string::npos) << found;
    EXPECT_EQ(findings.error.empty(), missing == 20);  // 0.4 % is a warning, 8 % an error
    EXPECT_EQ(findings.error.starts_with("ball.ply: faces: expected a closed surface, found "),
              missing == 400);
  }
}

TEST(Closed, MeshesInsideOutAreRefused) {
  TriangleMesh mesh = make_sphere(3);
  turn_inside_out(mesh);
  const Findings findings = look(mesh);
  EXPECT_EQ(findings.fraction, 1);
  EXPECT_EQ(findings.error,
            "ball.ply: faces: expected a closed surface, found 4000 of 4000 rays into the mesh "
            "escape (100 %): it has holes");
}

TEST(Closed, WatertightMeshesHaveNoBoundaryAndLookOutward) {
  for (const std::string& name : shape_names())
    EXPECT_TRUE(is_watertight(make_shape(name))) << name;
  EXPECT_FALSE(is_watertight(make_plane(1)));
  TriangleMesh inside_out = make_sphere(2);
  turn_inside_out(inside_out);
  EXPECT_FALSE(is_watertight(inside_out));
  for (const std::size_t triangle : {std::size_t{0}, std::size_t{17}}) {
    TriangleMesh holed = make_sphere(2), bent = make_sphere(2), apart = make_sphere(2);
    holed.triangles.erase(holed.triangles.begin() + static_cast<std::ptrdiff_t>(triangle));
    EXPECT_FALSE(is_watertight(holed));
    std::swap(bent.triangles[triangle][0], bent.triangles[triangle][1]);
    EXPECT_FALSE(is_watertight(bent));
    // Vertices that are there twice, as along a seam of a texture, count as one; moved, as a gap.
    std::uint32_t& corner = apart.triangles[triangle][2];
    apart.positions.push_back(apart.positions[corner]);
    corner = static_cast<std::uint32_t>(apart.positions.size() - 1);
    EXPECT_TRUE(is_watertight(apart));
    apart.positions.back() += Vec3{1e-6f, 0, 1e-6f};
    EXPECT_FALSE(is_watertight(apart));
  }
}

}  // namespace
}  // namespace parian

#include "transport/precompute.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/test_errors.h"
#include "mesh/shapes.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

Scene make_ball(double radius, const Dipole& material) {
  Scene scene;
  scene.mesh = make_sphere(4);
  scene.mesh_name = "ball";
  fit_to_size(scene.mesh, 2 * radius);
  scene.material = Material(material);
  EnvironmentLight white{.image = make_image(4, 2, 3, 1.0f)};
  scene.lights = {white};
  return scene;
}

PrecomputeParams quick_params() {
  PrecomputeParams params;
  params.samples = 6000;
  params.rays = 256;
  params.single = false;
  return params;
}

// What enters where light of radiance 1 comes from everywhere: int F_t cos dw.
double entering_flux(double eta) {
  constexpr int steps = 2000;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double mu = (i + 0.5) / steps;
    sum +=
        mu / steps *
        static_cast<double>(fresnel_transmission(static_cast<float>(eta), static_cast<float>(mu)));
  }
  return 2 * pi * sum;
}

// On a sphere the surface between the chords r and r + dr is 2 pi r dr, as in the plane, and the
// longest chord is its diameter: exitance is flux times the part of R_d within that, so that no
// more leaves than enters.
TEST(Precompute, ABallUnderLightFromEverywhereHasAClosedForm) {
  constexpr double radius = 10;
  for (const double eta : {1.0, 1.3}) {
    Dipole material{.channels = {{1e-6, 1.0}}, .eta = eta};
    const Scene scene = make_ball(radius, material);
    const HomogeneousTransport transport = precompute_transport(scene, quick_params());
    const SplineProjection projection =
        make_reflectance_projection(transport.multiple_basis, transport.knots);
    for (const DipoleCoefficients medium :
         {DipoleCoefficients{1e-6, 1}, {0.01, 0.5}, {0.05, 1}, {0.1, 3}}) {
      const auto reflectance = [&](double r) { return eval_dipole(medium, eta, r); };
      constexpr int steps = 20000;
      double part = 0;
      for (int i = 0; i < steps; ++i) {  // r = 2 R t^2 is dense where R_d is steep
        const double t = (i + 0.5) / steps, r = 2 * radius * t * t;
        part += 2 * pi * r * reflectance(r) * 4 * radius * t / steps;
      }
      EXPECT_LT(part, 1);
      const std::vector<double> c = projection.fit(reflectance);
      const double expected = entering_flux(eta) * part;
      double mean = 0, deviation = 0;
      for (std::size_t v = 0; v < transport.places; ++v) {
        double exitance = 0;
        for (std::size_t j = 0; j < c.size(); ++j)
          exitance += c[j] * static_cast<double>(unpack(transport.lights[0].multiple, v, j, 1));
        deviation +=
            std::abs(exitance - expected) / static_cast<double>(transport.places);  // of samples
        mean += exitance / static_cast<double>(transport.places);
      }
      EXPECT_NEAR(mean, expected, 0.01 * expected) << eta << ' ' << medium.sigma_a;
      EXPECT_LT(deviation, 0.03 * expected) << eta << ' ' << medium.sigma_a;
      EXPECT_LT(mean, entering_flux(eta));
    }
  }
}

TEST(Precompute, RefusesMeshesThatAreNotClosed) {
  Scene scene = make_ball(10, {.channels = {{0.01, 1}}});
  scene.mesh.triangles.resize(scene.mesh.triangles.size() / 2);
  const RayTracer tracer(scene.mesh);
  EXPECT_THAT(error_of([&] { const Precompute refused(scene, tracer, quick_params()); }),
              testing::StartsWith("ball: faces: expected a closed surface, found "));
  // A small hole is a warning.
  Scene holed = make_ball(10, {.channels = {{0.01, 1}}});
  holed.mesh.triangles.resize(holed.mesh.triangles.size() - 12);
  const RayTracer other(holed.mesh);
  const Precompute work(holed, other, quick_params());
  ASSERT_EQ(work.report().warnings.size(), 1u);
  EXPECT_NE(work.report().warnings[0].find(" of 6000 rays into the mesh escape ("),
            std::string::npos);
}

}  // namespace
}  // namespace parian

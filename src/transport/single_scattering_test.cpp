#include "transport/single_scattering.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/parallel.h"
#include "base/test_errors.h"
#include "mesh/shapes.h"
#include "scene/environment.h"
#include "transport/irradiance.h"
#include "transport/test_single_scattering.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

DirectionalLight sun_at(double angle_deg) {
  const double angle = angle_deg * pi / 180;
  return {
      .direction = {static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0},
      .irradiance = {2, 1, 0.5}};
}

// The largest relative error of the nodes for e^{-a s}, a up to `steepest`.
double path_error(int count, double steepest) {
  float s[256], weight[256];
  double worst = 0;
  for (const double length : {0.1, 1.0, 5.0, 20.0, 60.0, 100.0}) {
    make_path_nodes(length, count, path_scale_mm, s, weight);
    for (double a = 0.2; a <= steepest; a *= 1.15) {
      double sum = 0;
      for (int i = 0; i < count; ++i)
        sum += static_cast<double>(weight[i]) * std::exp(-a * static_cast<double>(s[i]));
      worst = std::max(worst, std::abs(sum / (-std::expm1(-a * length) / a) - 1));
    }
  }
  return worst;
}

TEST(PathNodes, IntegrateAttenuationAsStated) {
  EXPECT_LT(path_error(32, 40), 1e-4);
  EXPECT_LT(path_error(16, 40), 1e-3);
  EXPECT_LT(path_error(8, 40), 0.07);
  EXPECT_GT(path_error(8, 40), 0.01);
  float s[8], weight[8];
  make_path_nodes(0, 8, path_scale_mm, s, weight);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(weight[i], 0.0f);
}

TEST(PathLength, IsToTheBackFaceAndPastEntries) {
  TriangleMesh mesh = make_box({10, 4, 10});
  const Vec3 down{0, -1, 0};
  const SurfacePoint top = make_surface_point({0.3f, 2, 0.1f}, {0, 1, 0});
  EXPECT_NEAR(find_path_length(top, down, bounds(mesh), RayTracer(mesh)), 4, 1e-5);
  // A box inside: its entry is passed, and the path ends where its back is met.
  append_mesh(mesh, make_box({2, 1, 2}), {0, 0, 0});
  EXPECT_NEAR(find_path_length(top, down, bounds(mesh), RayTracer(mesh)), 2.5, 1e-5);
  // No back: to the mesh's box.
  TriangleMesh open = make_plane(10);
  append_mesh(open, make_plane(1), {20, -3, 0});
  EXPECT_NEAR(find_path_length(make_surface_point({1, 0, 1}, {0, 1, 0}), down, bounds(open),
                               RayTracer(open)),
              3, 1e-5);
}

TEST(SingleTransport, HalfSpaceIsTheClosedForm) {
  const TriangleMesh mesh = make_box({200, 20, 200});
  const RayTracer tracer(mesh);
  const SplineBasis basis = make_attenuation_basis(45);
  const std::vector<SurfacePoint> points{make_surface_point({0.3f, 10, 0.7f}, {0, 1, 0})};
  for (const double eta : {1.0, 1.3, 1.5})
    for (const double angle : {0.0, 40.0, 75.0})
      for (const EntryMethod method : {EntryMethod::depth_layers, EntryMethod::rays}) {
        const DirectionalLight sun = sun_at(angle);
        const std::vector<float> value = compute_single_transport(
            basis, points, sun, mesh, tracer, eta, {.method = method, .resolution = 256});
        const double sine = std::sin(angle * pi / 180) / eta, mu = std::sqrt(1 - sine * sine);
        const double transmitted =
            static_cast<double>(fresnel_transmission(static_cast<float>(eta), sun.direction.y));
        for (const double sigma_t : {0.5, 2.0, 8.0}) {
          const std::vector<double> e = fit_attenuation(basis, sigma_t);
          const double expected = 2 * transmitted / sigma_t * mu / (1 + mu);
          EXPECT_NEAR(attenuate(e, value, 0), expected, 0.01 * expected)
              << eta << ' ' << angle << ' ' << sigma_t;
          // Components: w_i' with its sign; channels: the light's colour.
          EXPECT_NEAR(attenuate(e, value, 0, 1), sine * expected, 0.01 * expected);
          EXPECT_NEAR(attenuate(e, value, 0, 2), mu * expected, 0.01 * expected);
          EXPECT_NEAR(attenuate(e, value, 0, 0, 2), expected / 4, 0.003 * expected);
        }
      }
}

TEST(SingleTransport, SphereHasTheLengthsOfGeometry) {
  // Without attenuation: int F_t ds along the path, with exact entries.
  const TriangleMesh mesh = make_sphere(5);
  const RayTracer tracer(mesh);
  const SplineBasis basis = make_attenuation_basis(6);
  const DirectionalLight sun = sun_at(0);
  for (const double angle : {10.0, 60.0, 120.0, 170.0}) {
    const double x = std::sin(angle * pi / 180), y = std::cos(angle * pi / 180);
    const Vec3 place{static_cast<float>(x), static_cast<float>(y), 0};
    const std::vector<float> value = compute_single_transport(
        basis, {make_surface_point(place, place)}, sun, mesh, tracer, 1.3, {.resolution = 512});
    double expected = 0;
    for (int i = 0; i < 400; ++i) {
      const double rest = 1 - 2 * (i + 0.5) / 400;  // x_s = rest * place
      const double cosine = std::sqrt(1 - rest * rest * x * x);
      expected += 2 * 2.0 / 400 *
                  static_cast<double>(fresnel_transmission(1.3f, static_cast<float>(cosine)));
    }
    EXPECT_NEAR(sum_functions(basis, value, 0), expected, 0.01 * expected) << angle;
  }
}

TEST(SingleTransport, DegreesAgree) {
  const TriangleMesh mesh = make_sphere(3);
  const RayTracer tracer(mesh);
  const auto points = pick_surface_points(mesh, 5);
  const SplineBasis hats = make_attenuation_basis(5),
                    smooth = make_attenuation_basis(5, {.degree = 2});
  const auto flat = fit_attenuation(hats, 1), round = fit_attenuation(smooth, 1);
  const auto a = compute_single_transport(hats, points, sun_at(20), mesh, tracer, 1.3,
                                          {.resolution = 256}),
             b = compute_single_transport(smooth, points, sun_at(20), mesh, tracer, 1.3,
                                          {.resolution = 256});
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(sum_functions(hats, a, i), sum_functions(smooth, b, i), 1e-5);
    const double expected = attenuate(flat, a, i);
    EXPECT_NEAR(attenuate(round, b, i), expected, 0.02 * expected + 1e-4);
  }
}

struct Difference {
  double mean = 0, total = 0;
};
// Of depth layers from rays, for L1's scalar part: mean |difference|, and difference of the means.
std::vector<Difference> compare_methods(const TriangleMesh& mesh,
                                        const std::vector<double>& sigma_t) {
  const RayTracer tracer(mesh);
  const SplineBasis basis = make_attenuation_basis(40);
  const auto points = pick_surface_points(mesh, 60);
  const EnvironmentLight sky{.image = make_sky_image(64, 32)};
  const auto compute = [&](EntryMethod method) {
    return compute_single_transport(
        basis, points, sky, mesh, tracer, 1.3,
        {.path_samples = 16, .directions = 16, .method = method, .resolution = 256});
  };
  const auto layers = compute(EntryMethod::depth_layers), rays = compute(EntryMethod::rays);
  std::vector<Difference> differences;
  for (const double sigma : sigma_t) {
    const std::vector<double> e = fit_attenuation(basis, sigma);
    double difference = 0, sum = 0, other = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double a = attenuate(e, layers, i), b = attenuate(e, rays, i);
      difference += std::abs(a - b);
      other += a;
      sum += b;
    }
    differences.push_back({difference / sum, std::abs(other / sum - 1)});
  }
  return differences;
}

TEST(SingleTransport, DepthLayersAgreeWithRays) {
  TriangleMesh sphere = make_sphere(4), knot = make_knot();
  fit_to_size(sphere, 20);
  fit_to_size(knot, 20);
  const auto round = compare_methods(sphere, {0.5, 5}), curled = compare_methods(knot, {0.5, 5});
  EXPECT_LT(round[0].mean, 0.002);
  EXPECT_LT(round[1].mean, 0.005);
  EXPECT_LT(curled[0].mean, 0.01);
  EXPECT_LT(curled[1].mean, 0.02);
  for (const Difference& difference : {round[0], round[1], curled[0], curled[1]})
    EXPECT_LT(difference.total, 0.01);
}

TEST(SingleTransport, AnotherPartShadows) {
  // A lid over the box's top; only what comes from below is left.
  TriangleMesh mesh = make_box({10, 2, 10});
  append_mesh(mesh, make_box({20, 1, 20}), {0, 4, 0});
  const RayTracer tracer(mesh);
  const SplineBasis basis = make_attenuation_basis(10);
  const std::vector<SurfacePoint> points{make_surface_point({0.4f, 1, 0.3f}, {0, 1, 0})};
  for (const EntryMethod method : {EntryMethod::depth_layers, EntryMethod::rays}) {
    const SingleScatteringParams params{.method = method, .resolution = 256};
    const auto sum = [&](const Light& light) {
      return sum_functions(
          basis, compute_single_transport(basis, points, light, mesh, tracer, 1.3, params), 0);
    };
    EXPECT_EQ(sum(sun_at(10)), 0);
    EXPECT_GT(sum(sun_at(170)), 1);
    EXPECT_EQ(sum(PointLight{.position = {0, 30, 0}}), 0);
    EXPECT_GT(sum(PointLight{.position = {0, 2, 0}}), 0.1);  // below the lid
  }
}

TEST(SingleTransport, FarLampIsASun) {
  TriangleMesh mesh = make_sphere(3);
  const RayTracer tracer(mesh);
  const SplineBasis basis = make_attenuation_basis(6);
  const auto points = pick_surface_points(mesh, 8);
  const DirectionalLight sun = sun_at(30);
  const float d = 5000;
  const PointLight lamp{.position = sun.direction * d, .intensity = sun.irradiance * (d * d)};
  const auto a = compute_single_transport(basis, points, lamp, mesh, tracer, 1.3);
  const auto b = compute_single_transport(basis, points, sun, mesh, tracer, 1.3,
                                          {.method = EntryMethod::rays});
  const std::vector<double> e = fit_attenuation(basis, 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_NEAR(attenuate(e, a, i), attenuate(e, b, i), 2e-3);
}

TEST(SingleTransport, UniformEnvironmentIsTheIntegralOverDirections) {
  // At eta = 1 on a convex body: all of 4 pi L comes to each point of the path.
  const TriangleMesh mesh = make_sphere(3);
  const RayTracer tracer(mesh);
  const SplineBasis basis = make_attenuation_basis(6);
  const auto points = pick_surface_points(mesh, 10);
  const EnvironmentLight light{.image = make_image(16, 8, 3, 0.5f)};
  const auto value = compute_single_transport(basis, points, light, mesh, tracer, 1,
                                              {.directions = 32, .resolution = 128});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double path = find_path_length(points[i], -points[i].normal, bounds(mesh), tracer);
    const double expected = 4 * pi * 0.5 * path;
    EXPECT_NEAR(sum_functions(basis, value, i), expected, 0.02 * expected);
    EXPECT_NEAR(sum_functions(basis, value, i, 2), 0, 0.05 * expected);
  }
}

// Two batches and two blocks of places.
struct Setting {
  TriangleMesh mesh = make_sphere(2);
  RayTracer tracer{mesh};
  SplineBasis basis = make_attenuation_basis(6);
  std::vector<SurfacePoint> points = pick_surface_points(mesh, 100);
  EnvironmentLight light{.image = make_sky_image(32, 16)};
  SingleScatteringParams params{.path_samples = 8, .directions = 24, .resolution = 64};

  SingleTransportState make() const { return {basis, points, light, mesh, tracer, 1.3, params}; }
  std::vector<float> compute(const Progress& progress = {}) const {
    return compute_single_transport(basis, points, light, mesh, tracer, 1.3, params, progress);
  }
};

TEST(SingleTransport, SameBitsForAnyNumberOfThreads) {
  Setting setting;
  for (const EntryMethod method : {EntryMethod::depth_layers, EntryMethod::rays}) {
    setting.params.method = method;
    std::vector<float> one, two;
    {
      const ThreadLimit limit(1);
      one = setting.compute();
    }
    {
      const ThreadLimit limit(2);
      two = setting.compute();
    }
    EXPECT_EQ(one, two);
  }
}

TEST(SingleTransport, ResumedIsUninterrupted) {
  const Setting setting;
  SingleTransportState stopped = setting.make();
  ASSERT_EQ(stopped.steps(), 6u);
  stopped.advance();
  EXPECT_EQ(stopped.step(), 1u);
  SingleTransportState resumed = setting.make();
  resumed.restore(stopped.step(), stopped.value());
  while (resumed.step() < resumed.steps()) resumed.advance();
  const std::vector<float> whole = setting.compute();
  EXPECT_EQ(resumed.value(), whole);
  EXPECT_NE(stopped.value(), whole);
  resumed.advance();  // nothing left
  EXPECT_EQ(resumed.value(), whole);
}

TEST(SingleTransport, RefusesWhatCannotBe) {
  const Setting setting;
  SingleTransportState state = setting.make();
  EXPECT_EQ(error_of([&] { state.restore(7, state.value()); }),
            "step: expected at most 6, found 7");
  EXPECT_EQ(error_of([&] {
              state.restore(1, {0, 1});
            }),
            "single scattering: expected 20400 values, found 2");
  std::vector<float> bad = state.value();
  bad[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_of([&] { state.restore(1, bad); }),
            "single scattering: expected finite values, found nan");
  Setting few;
  few.params.path_samples = 7;
  EXPECT_EQ(error_of([&] { few.make(); }), "path-samples: expected a value in [8, 256], found 7");
  EXPECT_EQ(error_of([&] { setting.compute({.report = {}, .is_cancelled = [] { return true; }}); }),
            "cancelled");
}

TEST(SingleTransport, NothingComesOfNothing) {
  Setting setting;
  setting.light.image = make_image(8, 4, 3, 0.0f);
  EXPECT_EQ(setting.make().steps(), 0u);
  for (const float x : setting.compute()) ASSERT_EQ(x, 0.0f);
  setting.points.clear();
  EXPECT_TRUE(setting.compute().empty());
}

TEST(SingleTransport, HolesLeaveFiniteValues) {
  Setting setting;
  setting.mesh.triangles.resize(setting.mesh.triangles.size() * 2 / 3);
  setting.tracer = RayTracer(setting.mesh);
  for (const EntryMethod method : {EntryMethod::depth_layers, EntryMethod::rays}) {
    setting.params.method = method;
    const auto value = setting.compute();
    for (const float x : value) ASSERT_TRUE(std::isfinite(x));
    for (std::size_t i = 0; i < setting.points.size(); ++i)
      ASSERT_GE(sum_functions(setting.basis, value, i), 0);
  }
}

}  // namespace
}  // namespace parian

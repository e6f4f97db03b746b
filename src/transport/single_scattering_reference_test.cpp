#include "transport/single_scattering_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "base/test_errors.h"
#include "mesh/shapes.h"
#include "scene/environment.h"
#include "transport/irradiance.h"
#include "transport/test_single_scattering.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 tilt(double angle_deg) {
  const double angle = angle_deg * pi / 180;
  return {static_cast<float>(std::sin(angle)), static_cast<float>(std::cos(angle)), 0};
}

Dipole make_medium(double sigma_a, double sigma_s, double g, double eta = 1.3) {
  return {.channels = {{sigma_a, sigma_s * (1 - g), g}}, .eta = eta};
}

// The top of a flat box `thickness` mm thick.
struct Slab {
  explicit Slab(float thickness)
      : mesh(make_box({400, thickness, 400})),
        point(make_surface_point({0.3f, thickness / 2, 0.7f}, {0, 1, 0})) {}
  TriangleMesh mesh;
  RayTracer tracer{mesh};
  SurfacePoint point;

  Rgb look(const std::vector<Light>& lights, const Dipole& medium, Vec3 to_eye = {0, 1, 0},
           const SingleReferenceParams& params = {}) const {
    return integrate_single_scattering({{point, to_eye}}, lights, mesh, tracer, medium, params)[0];
  }
};

double transmission(double eta, double angle_deg) {
  return static_cast<double>(fresnel_transmission(
      static_cast<float>(eta), static_cast<float>(std::cos(angle_deg * pi / 180))));
}
double refracted_cosine(double eta, double angle_deg) {
  const double sine = std::sin(angle_deg * pi / 180) / eta;
  return std::sqrt(1 - sine * sine);
}

TEST(SingleReference, HalfSpaceIsTheClosedForm) {
  const Slab slab(100);
  for (const double eta : {1.0, 1.3, 1.5})
    for (const double angle : {0.0, 35.0, 80.0})
      for (const double sigma_s : {0.5, 2.0, 12.0}) {
        const double sigma_a = 0.1, g = 0.2, mu = refracted_cosine(eta, angle);
        const double phase = (1 - 3 * g * mu) / (4 * pi);
        const double expected = sigma_s / (sigma_a + sigma_s) * phase * transmission(eta, angle) *
                                transmission(eta, 0) * 3 * mu / (1 + mu);
        const Light sun = DirectionalLight{.direction = tilt(angle), .irradiance = {3, 6, 0}};
        const Rgb radiance = slab.look({sun}, make_medium(sigma_a, sigma_s, g, eta));
        EXPECT_NEAR(static_cast<double>(radiance.x), expected, 1e-3 * expected);
        EXPECT_NEAR(static_cast<double>(radiance.y), 2 * expected, 2e-3 * expected);
        EXPECT_EQ(radiance.z, 0.0f);
      }
}

// Along the refracted view mu / (1 + mu) becomes mu / (mu + mu_o).
TEST(SingleReference, NormalPathIsDarkerAtAnAngle) {
  const Slab slab(100);
  const Dipole medium = make_medium(0, 2, 0);
  const Light sun = DirectionalLight{.direction = {0, 1, 0}, .irradiance = {1, 1, 1}};
  const double normal = static_cast<double>(slab.look({sun}, medium, tilt(60)).x),
               view = static_cast<double>(
                   slab.look({sun}, medium, tilt(60), {.path = ScatteringPath::view}).x);
  const double expected = transmission(1.3, 60) * transmission(1.3, 0) / (4 * pi);
  EXPECT_NEAR(normal, expected / 2, 1e-3 * normal);
  EXPECT_NEAR(view, expected / (1 + refracted_cosine(1.3, 60)), 1e-3 * view);
  EXPECT_NEAR(normal / view - 1, -0.127, 2e-3);
}

TEST(SingleReference, ForwardScatteringBrightensTheBackLit) {
  const Slab slab(2);
  const Light front = DirectionalLight{.direction = {0, 1, 0}, .irradiance = {1, 1, 1}},
              back = DirectionalLight{.direction = {0, -1, 0}, .irradiance = {1, 1, 1}};
  const auto look = [&](const Light& light, double g) {
    return static_cast<double>(slab.look({light}, make_medium(0.1, 1, g)).x);
  };
  EXPECT_NEAR(look(back, 0.2) / look(back, 0), 1.6, 1e-4);
  EXPECT_NEAR(look(front, 0.2) / look(front, 0), 0.4, 1e-4);
  // Clamped: never negative.
  EXPECT_NEAR(look(back, 0.9) / look(back, 0), 2, 1e-4);
  EXPECT_NEAR(look(front, 0.9) / look(front, 0), 0, 1e-4);
  EXPECT_NEAR(look(front, -0.9) / look(front, 0), 2, 1e-4);
  // Straight through: sigma_s t e^{-sigma_t t}, whichever way it came.
  const double t = transmission(1.3, 0);
  EXPECT_NEAR(look(back, 0), t * t * 2 * std::exp(-2.2) / (4 * pi), 1e-5);
}

TEST(SingleReference, LightsAndChannelsAdd) {
  TriangleMesh mesh = make_knot();
  fit_to_size(mesh, 10);
  const RayTracer tracer(mesh);
  std::vector<SurfaceView> views;
  for (const SurfacePoint& point : pick_surface_points(mesh, 10))
    views.push_back({point, point.normal});
  const Dipole medium{.channels = {{0.1, 1, 0.2}, {0, 3, 0}, {0.5, 0.5, -0.3}}, .eta = 1.3};
  const std::vector<Light> lights{
      DirectionalLight{.direction = tilt(50), .irradiance = {3, 2, 1}},
      PointLight{.position = {3, 30, 5}, .intensity = {2000, 1000, 3000}},
      EnvironmentLight{.image = make_sky_image(32, 16)}};
  const SingleReferenceParams params{.path_samples = 16, .directions = 16};
  const auto look = [&](const std::vector<Light>& some, const Dipole& dipole) {
    return integrate_single_scattering(views, some, mesh, tracer, dipole, params);
  };
  const auto all = look(lights, medium);
  std::vector<Rgb> sum(views.size());
  for (const Light& light : lights) {
    const auto one = look({light}, medium);
    for (std::size_t i = 0; i < views.size(); ++i) sum[i] += one[i];
  }
  const auto green = look(lights, {.channels = {medium.channels[1]}, .eta = 1.3});
  Dipole doubled = medium;
  doubled.attenuation_gain = {{0, 2}};
  const auto twice = look(lights, doubled);
  for (std::size_t i = 0; i < views.size(); ++i) {
    EXPECT_NEAR(twice[i].x, 2 * all[i].x, 1e-5f * all[i].x);
    EXPECT_NEAR(all[i].x, sum[i].x, 1e-5f * sum[i].x);
    EXPECT_NEAR(all[i].z, sum[i].z, 1e-5f * sum[i].z);
    EXPECT_EQ(all[i].y, green[i].y);
    EXPECT_GT(all[i].y, 0);
  }
}

// The same directions and entries: what is left are the basis and the nodes.
TEST(SingleReference, AgreesWithTransport) {
  TriangleMesh mesh = make_knot();
  fit_to_size(mesh, 10);
  const RayTracer tracer(mesh);
  const auto points = pick_surface_points(mesh, 16);
  const Light sky = EnvironmentLight{.image = make_sky_image(32, 16)};
  const SplineBasis basis = make_attenuation_basis(20);
  const auto value =
      compute_single_transport(basis, points, sky, mesh, tracer, 1.3,
                               {.directions = 16, .method = EntryMethod::rays, .seed = 4});
  for (const double sigma_s : {0.4, 4.0}) {
    const double g = 0.25;
    const std::vector<double> e = fit_attenuation(basis, sigma_s + 0.1);
    double error = 0, total = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 n = points[i].normal;
      const double exact = static_cast<double>(
          integrate_single_scattering({{points[i], n}}, {sky}, mesh, tracer,
                                      make_medium(0.1, sigma_s, g),
                                      {.path_samples = 64, .directions = 16, .seed = 4})[0]
              .x);
      double sum = attenuate(e, value, i);
      for (int axis = 0; axis < 3; ++axis)
        sum -= 3 * g * static_cast<double>(component(n, axis)) *
               attenuate(e, value, i, 1 + static_cast<std::size_t>(axis));
      error += std::abs(sum * transmission(1.3, 0) * sigma_s / (4 * pi) - exact);
      total += exact;
    }
    EXPECT_LT(error / total, 0.01) << sigma_s;
  }
}

// At eta = 1 along the view: what leaves a sphere by one scattering is no more than came in, and
// sigma_s V L where hardly any is scattered.
TEST(SingleReference, KeepsEnergyOnAConvexBody) {
  const TriangleMesh mesh = make_sphere(3);
  const RayTracer tracer(mesh);
  const auto power = [&](double sigma_s) {
    std::vector<SurfaceView> views;
    Rng rng = make_rng(9);
    for (const SurfacePoint& point : pick_surface_points(mesh, 600)) {
      const double r = std::sqrt(sample_uniform(rng)), phi = 2 * pi * sample_uniform(rng);
      const Vec3 local{static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
                       static_cast<float>(std::sqrt(1 - r * r))};
      views.push_back({point, to_world(make_frame(point.normal), local)});
    }
    const Light sun = DirectionalLight{.direction = tilt(25), .irradiance = {1, 1, 1}};
    double sum = 0;
    for (const Rgb& radiance :
         integrate_single_scattering(views, {sun}, mesh, tracer, make_medium(0, sigma_s, 0, 1),
                                     {.path = ScatteringPath::view, .path_samples = 8}))
      sum += static_cast<double>(radiance.x);
    return sum * pi * surface_area(mesh) / static_cast<double>(views.size());
  };
  const double volume = enclosed_volume(mesh);
  EXPECT_NEAR(power(1e-3), 1e-3 * volume, 5e-5 * volume);
  EXPECT_LT(power(1), pi);
  EXPECT_GT(power(1), 0.2 * pi);
}

TEST(SingleReference, SameBitsForAnyNumberOfThreads) {
  const TriangleMesh mesh = make_sphere(2);
  const RayTracer tracer(mesh);
  std::vector<SurfaceView> views;
  for (const SurfacePoint& point : pick_surface_points(mesh, 40))
    views.push_back({point, point.normal});
  const auto look = [&](int threads) {
    const ThreadLimit limit(threads);
    return integrate_single_scattering(views,
                                       {PointLight{.position = {3, 1, 2}, .intensity = {9, 9, 9}}},
                                       mesh, tracer, make_medium(0.1, 1, 0), {.path_samples = 8});
  };
  EXPECT_EQ(look(1), look(2));
}

TEST(SingleReference, RefusesAndStops) {
  const Slab slab(2);
  const Light sun = DirectionalLight{};
  EXPECT_EQ(error_of([&] {
              slab.look({sun}, make_medium(0, 1, 0), {0, 1, 0}, {.path_samples = 0});
            }),
            "path-samples: expected a value in [8, 256], found 0");
  const auto stop = [&] {
    integrate_single_scattering({{slab.point, {0, 1, 0}}}, {sun}, slab.mesh, slab.tracer,
                                make_medium(0, 1, 0), {},
                                {.report = {}, .is_cancelled = [] { return true; }});
  };
  EXPECT_EQ(catch_error(stop).kind, ErrorKind::cancelled);
  EXPECT_EQ(slab.look({sun}, make_medium(0, 1, 0), {0, -1, 0}), Rgb{});  // from behind
  EXPECT_EQ(slab.look({sun}, make_medium(1, 0, 0)), Rgb{});
  EXPECT_EQ(slab.look({}, make_medium(1, 1, 0)), Rgb{});
}

}  // namespace
}  // namespace parian

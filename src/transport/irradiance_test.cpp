#include "transport/irradiance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"
#include "base/test_errors.h"
#include "mesh/shapes.h"
#include "mesh/test_meshes.h"
#include "scene/environment.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

// Far away and tiny: nothing that shadows.
const RayTracer& empty_tracer() {
  static const RayTracer tracer(
      TriangleMesh{.positions = {{1e4f, 0, 0}, {1e4f, 1, 0}, {1e4f, 0, 1}},
                   .normals = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0}},
                   .texcoords = {},
                   .triangles = {{0, 1, 2}}});
  return tracer;
}

std::vector<SurfacePoint> triangle_centres(const TriangleMesh& mesh) {
  std::vector<SurfacePoint> points;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    points.push_back(get_surface_point(mesh, i, {0.31f, 0.36f}));
  return points;
}

EnvironmentLight constant_environment(float radiance) {
  return {.image = make_image(16, 8, 3, radiance)};
}

Rgb irradiance_at(const SurfacePoint& point, const Light& light, IrradianceParams params = {},
                  Boundary boundary = Boundary::included, double eta = 1.3) {
  return compute_irradiance({point}, {light}, empty_tracer(), boundary, eta, params)[0];
}

// int L(w) weight(w) dw over midpoints of each pixel's parts.
Vec3 integrate(const EnvironmentLight& light, int parts, const std::function<Vec3(Vec3)>& weight) {
  const int width = light.image.width * parts, height = light.image.height * parts;
  double sum[3] = {};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec2 uv{(static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                    (static_cast<float>(y) + 0.5f) / static_cast<float>(height)};
      const double solid_angle =
          2 * pi / width * pi / height * std::sin(pi * static_cast<double>(uv.y));
      const Vec3 value = eval_environment_at(light, uv) * weight(environment_direction(light, uv));
      sum[0] += solid_angle * value.x, sum[1] += solid_angle * value.y;
      sum[2] += solid_angle * value.z;
    }
  return {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
}

// The textbook's reflectance, in double.
double fresnel_reflectance(double eta, double cos_i) {
  const double cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / (eta * eta));
  const double r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
  const double r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
  return (r_s * r_s + r_p * r_p) / 2;
}

TEST(Fresnel, IsTheExactFormula) {
  for (const double eta : {1.0, 1.1, 1.3, 1.5, 2.5})
    for (double cosine = 0.01; cosine <= 1; cosine += 0.01)
      EXPECT_NEAR(fresnel_transmission(static_cast<float>(eta), static_cast<float>(cosine)),
                  1 - fresnel_reflectance(eta, cosine), 2e-6);
  EXPECT_NEAR(fresnel_transmission(1.5f, 1), 0.96, 1e-6);
  EXPECT_EQ(fresnel_transmission(1.5f, 0), 0);
  EXPECT_EQ(fresnel_transmission(1.5f, -0.3f), 0);
  EXPECT_EQ(fresnel_transmission(1, 1e-4f), 1);
  // Outwards: the same transmission along the same path, and total reflection.
  const float cos_t = std::sqrt(1 - (1 - 0.25f) / (1.5f * 1.5f));
  EXPECT_NEAR(fresnel_transmission(1 / 1.5f, cos_t), fresnel_transmission(1.5f, 0.5f), 1e-5);
  EXPECT_EQ(fresnel_transmission(1 / 1.5f, 0.7f), 0);
}

TEST(Irradiance, UnderLightFromEverywhereIsPi) {
  const TriangleMesh sphere = make_sphere(4);
  const RayTracer tracer(sphere);
  const auto points = triangle_centres(sphere);
  const auto irradiance =
      compute_irradiance(points, {constant_environment(1)}, tracer, Boundary::included, 1.3);
  double sum = 0, squares = 0;
  for (const Rgb& e : irradiance) {
    ASSERT_EQ(e.x, e.z);
    sum += e.y, squares += (e.y - pi) * (e.y - pi);
  }
  const auto count = static_cast<double>(points.size());
  EXPECT_NEAR(sum / count, pi, 0.002 * pi);
  EXPECT_LT(std::sqrt(squares / count), 0.03 * pi);
}

TEST(Irradiance, UnderTheUpperHemisphere) {
  EnvironmentLight sky{.image = make_image(64, 128, 3)};
  std::fill_n(sky.image.values.begin(), sky.image.values.size() / 2, 1.0f);
  Rng rng = make_rng(4);
  const auto uniform = [&] { return static_cast<float>(2 * sample_uniform(rng) - 1); };
  for (int i = 0; i < 20; ++i) {
    const SurfacePoint point = make_surface_point({}, {uniform(), uniform(), uniform()});
    EXPECT_NEAR(irradiance_at(point, sky, {.rays = 8192}).y, pi * (1 + point.normal.y) / 2, 0.008)
        << point.normal.y;
  }
  EXPECT_NEAR(irradiance_at(make_surface_point({}, {0, -1, 0}), sky, {.rays = 8192}).y, 0, 0.001);
}

TEST(Irradiance, SunDiscInAnImage) {
  EnvironmentLight light{.image = make_image(512, 256, 3), .rotation_deg = 20};
  const Vec3 sun = normalize({0.3f, 0.5f, 0.4f});
  const double radius = 4 * pi / 180;
  for (int y = 0; y < 256; ++y)
    for (int x = 0; x < 512; ++x) {
      const Vec2 uv{(static_cast<float>(x) + 0.5f) / 512, (static_cast<float>(y) + 0.5f) / 256};
      if (dot(environment_direction(light, uv), sun) > std::cos(radius))
        for (int c = 0; c < 3; ++c) at(light.image, x, y, c) = 1000;
    }
  const double perpendicular = 1000 * pi * std::pow(std::sin(radius), 2);
  const Vec3 vector = integrate(light, 2, [](Vec3 direction) { return direction; });
  // The image's x, y and z are equal, so that `vector` is the vector irradiance.
  EXPECT_NEAR(dot(vector, sun), perpendicular, 0.02 * perpendicular);
  for (const Vec3 normal : {Vec3{0, 1, 0}, sun, Vec3{1, 0, 0}, Vec3{1, 1, -0.2f}}) {
    const SurfacePoint point = make_surface_point({}, normal);
    const double expected = dot(vector, point.normal);
    EXPECT_NEAR(irradiance_at(point, light, {.rays = 2048}).x, expected, 0.004 * perpendicular);
  }
  EXPECT_EQ(irradiance_at(make_surface_point({}, -sun), light).x, 0);
}

TEST(Irradiance, DirectionalLight) {
  const Vec3 sun = normalize({1, 2, 3});
  const DirectionalLight light{.direction = sun, .irradiance = {1, 2, 4}};
  SurfacePoint point = make_surface_point({5, 6, 7}, {0, 1, 0});
  EXPECT_NEAR(irradiance_at(point, light).z, 4 * sun.y, 1e-6);
  EXPECT_NEAR(irradiance_at(point, light, {}, Boundary::excluded, 1.5).y,
              2 * sun.y * (1 - fresnel_reflectance(1.5, sun.y)), 1e-5);
  EXPECT_EQ(irradiance_at(make_surface_point({}, {0, 0, -1}), light).x, 0);
  // Behind the triangle, though not behind the interpolated normal.
  point.geometric_normal = normalize({-1, -1, 0.5f});
  EXPECT_EQ(irradiance_at(point, light).x, 0);
}

TEST(Irradiance, PointLightFallsWithTheSquareOfTheDistance) {
  for (const float r : {1.0f, 2.0f, 10.0f}) {
    const PointLight light{.position = Vec3{3, 4, 0} * (r / 5), .intensity = {10, 20, 30}};
    EXPECT_NEAR(irradiance_at(make_surface_point({}, {0, 1, 0}), light).y, 20 * 0.8 / (r * r),
                1e-4 / (r * r));
  }
  const PointLight here{.position = {}, .intensity = {1, 1, 1}};
  EXPECT_EQ(irradiance_at(make_surface_point({}, {0, 1, 0}), here), (Rgb{}));
}

// A ball above a floor.
TEST(Irradiance, OneObjectShadowsAnother) {
  TriangleMesh mesh = make_plane(20, 4);
  append_mesh(mesh, make_sphere(4), {0, 3, 0});
  const RayTracer tracer(mesh);
  const auto on_floor = [](float x) { return make_surface_point({x, 0, 0.1f}, {0, 1, 0}); };
  const DirectionalLight sun{.direction = {0, 1, 0}};
  const PointLight above{.position = {0, 8, 0}, .intensity = {64, 64, 64}};
  const PointLight below{.position = {0, 1, 0}, .intensity = {1, 1, 1}};
  const std::vector<SurfacePoint> points{on_floor(0), on_floor(0.95f), on_floor(1.05f),
                                         on_floor(4)};
  const auto under_sun = compute_irradiance(points, {sun}, tracer, Boundary::included, 1.3);
  EXPECT_EQ(under_sun[0].x, 0);
  EXPECT_EQ(under_sun[1].x, 0);
  EXPECT_EQ(under_sun[2].x, 1);
  EXPECT_EQ(under_sun[3].x, 1);
  // The lamp's shadow is wider: tangent at 1 / sqrt(24) of 8 mm = 1.63 mm.
  const auto under_lamp = compute_irradiance({on_floor(1.55f), on_floor(1.7f)}, {above}, tracer,
                                             Boundary::included, 1.3);
  EXPECT_EQ(under_lamp[0].x, 0);
  EXPECT_GT(under_lamp[1].x, 0.8f);
  // What is behind the lamp casts no shadow.
  EXPECT_GT(compute_irradiance({on_floor(0)}, {below}, tracer, Boundary::included, 1.3)[0].x, 0.9f);
  // A ball of radius 1 at distance 3, on the normal, hides sin^2 = 1/9 of pi.
  double sum = 0;
  const std::vector<SurfacePoint> copies(200, make_surface_point({0, 0, 0}, {0, 1, 0}));
  for (const Rgb& e :
       compute_irradiance(copies, {constant_environment(1)}, tracer, Boundary::included, 1.3))
    sum += e.y / 200;
  EXPECT_NEAR(sum, pi * 8 / 9, 0.01);
}

TEST(Irradiance, DoesNotDependOnTheOrientationOfTheWorld) {
  TriangleMesh mesh = make_box({2, 0.4f, 2}, 8);
  append_mesh(mesh, make_sphere(3), {0.3f, 2, 0.1f});
  const Frame turned = make_frame(normalize({1, -2, 0.5f}));
  const auto turn = [&](Vec3 v) { return to_world(turned, v); };
  TriangleMesh other = mesh;
  for (Vec3& p : other.positions) p = turn(p);
  for (Vec3& n : other.normals) n = turn(n);
  const Vec3 sun = normalize({0.3f, 1, 0.2f}), lamp{3, 2, -1};
  const auto a = compute_irradiance(
      triangle_centres(mesh), {DirectionalLight{.direction = sun}, PointLight{.position = lamp}},
      RayTracer(mesh), Boundary::excluded, 1.4);
  const auto b = compute_irradiance(
      triangle_centres(other),
      {DirectionalLight{.direction = turn(sun)}, PointLight{.position = turn(lamp)}},
      RayTracer(other), Boundary::excluded, 1.4);
  std::size_t different = 0, lit = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    different += std::abs(a[i].x - b[i].x) > 1e-4f ? 1 : 0;  // at shadows' edges
    lit += a[i].x > 0.5f ? 1 : 0;
  }
  EXPECT_LE(different, a.size() / 200);
  EXPECT_GT(lit, a.size() / 10);
}

TEST(Irradiance, EnvironmentsTurnWithTheWorld) {
  const Image sky = make_sky_image(128, 64);
  const double degrees = 50;
  const auto c = static_cast<float>(std::cos(degrees * pi / 180));
  const auto s = static_cast<float>(std::sin(degrees * pi / 180));
  for (const Vec3 n : {Vec3{0.2f, 0.5f, 0.9f}, Vec3{-1, 0.1f, 0}, Vec3{0.3f, -0.8f, 0.4f}}) {
    const Vec3 turned{c * n.x + s * n.z, n.y, c * n.z - s * n.x};
    const Rgb a =
        irradiance_at(make_surface_point({}, n), EnvironmentLight{.image = sky}, {.rays = 8192});
    const Rgb b =
        irradiance_at(make_surface_point({}, turned),
                      EnvironmentLight{.image = sky, .rotation_deg = degrees}, {.rays = 8192});
    EXPECT_NEAR(a.x, b.x, 0.01 * a.x);
    EXPECT_NEAR(a.z, b.z, 0.01 * a.z);
  }
}

// Means of independent estimates against quadrature: |z| < 4.
TEST(Irradiance, IsUnbiasedUnderPeakedLight) {
  EnvironmentLight light{.image = make_image(32, 16, 3), .rotation_deg = 33, .scale = {1, 0.5f, 2}};
  Rng rng = make_rng(11);
  for (float& value : light.image.values)
    value = static_cast<float>(0.2 + 200 * std::pow(sample_uniform(rng), 40));
  for (const Boundary boundary : {Boundary::included, Boundary::excluded})
    for (const Vec3 normal : {Vec3{0.1f, 1, 0.3f}, Vec3{0.7f, -0.4f, -0.5f}})
      for (const int rays : {1, 2, 7, 32}) {
        const SurfacePoint point = make_surface_point({}, normal);
        const Vec3 exact = integrate(light, 12, [&](Vec3 direction) {
          const double cosine = std::max(0.0f, dot(direction, point.normal));
          const bool excluded = boundary == Boundary::excluded && cosine > 0;
          const auto w = static_cast<float>(
              excluded ? cosine * (1 - fresnel_reflectance(1.5, cosine)) : cosine);
          return Vec3{w, w, w};
        });
        const std::size_t count = 5000;
        const auto estimates = compute_irradiance(std::vector<SurfacePoint>(count, point), {light},
                                                  empty_tracer(), boundary, 1.5, {.rays = rays});
        double sum = 0, squares = 0;
        for (const Rgb& e : estimates) sum += e.z, squares += e.z * e.z;
        const double mean = sum / count;
        const double error = std::sqrt((squares / count - mean * mean) / (count - 1.0));
        EXPECT_LT(std::abs(mean - exact.z), 4 * error + 2e-4 * exact.z)
            << "rays " << rays << ", mean " << mean << ", exact " << exact.z;
        EXPECT_LT(error, (rays == 1 ? 0.1 : 0.04) * exact.z);
      }
}

// Half the rays by brightness: far less noise than by the cosine alone under a small sun.
TEST(Irradiance, NoiseUnderASkyIsSmall) {
  const EnvironmentLight sky{.image = make_sky_image()};
  const SurfacePoint point = make_surface_point({}, {-0.3f, 0.8f, 0.4f});
  const double exact = integrate(sky, 2, [&](Vec3 w) {
                         return Vec3{1, 1, 1} * std::max(0.0f, dot(w, point.normal));
                       }).y;
  double squares = 0;
  const auto estimates = compute_irradiance(std::vector<SurfacePoint>(500, point), {sky},
                                            empty_tracer(), Boundary::included, 1.3);
  for (const Rgb& e : estimates) squares += std::pow(e.y / exact - 1, 2) / 500;
  EXPECT_LT(std::sqrt(squares), 0.03);
}

TEST(Irradiance, TransmittedPartOfLightFromEverywhere) {
  for (const double eta : {1.0, 1.3, 1.5}) {
    double transmitted = 0;  // 2 pi int (1 - F) c dc
    for (int i = 0; i < 20000; ++i) {
      const double c = (i + 0.5) / 20000;
      transmitted += 2 * pi * (1 - fresnel_reflectance(eta, c)) * c / 20000;
    }
    if (eta == 1.5) {
      EXPECT_NEAR(transmitted, pi * (1 - 0.0918), 2e-3);
    }
    const Rgb e = irradiance_at(make_surface_point({}, {1, 2, 3}), constant_environment(1),
                                {.rays = 16384}, Boundary::excluded, eta);
    EXPECT_NEAR(e.y, transmitted, 0.002 * pi) << eta;
  }
}

TEST(Irradiance, IsLinearInLight) {
  TriangleMesh mesh = make_box({1, 1, 1}, 2);
  append_mesh(mesh, make_sphere(2), {1, 1.2f, 0});
  const RayTracer tracer(mesh);
  const auto points = triangle_centres(mesh);
  EnvironmentLight sky{.image = make_sky_image(64, 32)};
  const DirectionalLight sun{.direction = {0, 1, 0}};
  const auto compute = [&](const std::vector<Light>& lights) {
    return compute_irradiance(points, lights, tracer, Boundary::excluded, 1.3);
  };
  const auto a = compute({sky}), b = compute({sun}), both = compute({sky, sun});
  sky.scale = {3, 3, 3};
  const auto scaled = compute({sky});
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_NEAR(both[i].x, a[i].x + b[i].x, 1e-5);
    ASSERT_NEAR(scaled[i].y, 3 * a[i].y, 1e-5 * (1 + scaled[i].y));
  }
}

TEST(Irradiance, SameBitsForAnyNumberOfThreadsAndOtherSeedsDiffer) {
  const TriangleMesh mesh = make_box({1, 1, 1}, 6);
  const RayTracer tracer(mesh);
  const auto points = triangle_centres(mesh);
  const std::vector<Light> lights{EnvironmentLight{.image = make_studio_image(64, 32)},
                                  PointLight{.position = {0, 3, 0}}};
  const auto compute = [&](int threads, std::uint64_t seed) {
    const ThreadLimit limit(threads);
    return compute_irradiance(points, lights, tracer, Boundary::excluded, 1.3,
                              {.rays = 32, .seed = seed});
  };
  EXPECT_EQ(compute(1, 1), compute(2, 1));
  EXPECT_NE(compute(1, 1), compute(1, 2));
}

TEST(Irradiance, WithoutLightIsZero) {
  const SurfacePoint point = make_surface_point({}, {0, 1, 0});
  EXPECT_EQ(irradiance_at(point, constant_environment(0)), (Rgb{}));
  EXPECT_EQ(compute_irradiance({point}, {}, empty_tracer(), Boundary::included, 1.3)[0], (Rgb{}));
  EXPECT_TRUE(
      compute_irradiance({}, {constant_environment(1)}, empty_tracer(), Boundary::included, 1.3)
          .empty());
}

TEST(Irradiance, ReportsAndCanBeCancelled) {
  const std::vector<SurfacePoint> points(10000, make_surface_point({}, {0, 1, 0}));
  std::vector<double> done;
  Progress progress{.report = [&](std::string_view stage, double part) {
    EXPECT_EQ(stage, "irradiance");
    done.push_back(part);
  }};
  const auto compute = [&] {
    compute_irradiance(points, {DirectionalLight{}}, empty_tracer(), Boundary::included, 1.3, {},
                       progress);
  };
  compute();
  EXPECT_GE(done.size(), 3u);
  EXPECT_EQ(done.front(), 0);
  EXPECT_EQ(done.back(), 1);
  EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
  progress.is_cancelled = [] { return true; };
  EXPECT_EQ(catch_error([&] { compute(); }).kind, ErrorKind::cancelled);
}

TEST(Irradiance, ParametersAreChecked) {
  EXPECT_EQ(error_of([&] {
              irradiance_at(make_surface_point({}, {0, 1, 0}), DirectionalLight{}, {.rays = 0});
            }),
            "rays: expected a value in [1, 1048576], found 0");
}

}  // namespace
}  // namespace parian

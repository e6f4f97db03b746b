#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/random.h"
#include "mesh/shapes.h"
#include "render/specular_internal.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

constexpr float eta = 1.5f;
constexpr Vec3 up{0, 1, 0};

Vec3 at_angle(double theta, double phi = 0.3) {
  return {static_cast<float>(std::sin(theta) * std::cos(phi)), static_cast<float>(std::cos(theta)),
          static_cast<float>(std::sin(theta) * std::sin(phi))};
}

// Integral over the sphere of directions by the midpoint rule.
template <typename Function>
double integrate_sphere(int rings, const Function& function) {
  double sum = 0;
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < 2 * rings; ++j) {
      const double theta = std::numbers::pi * (i + 0.5) / rings;
      const double phi = std::numbers::pi * (j + 0.5) / rings;
      sum += function(at_angle(theta, phi)) * std::sin(theta);
    }
  return sum * std::numbers::pi / rings * std::numbers::pi / rings;
}

Reflector make_reflector(Vec3 view, float alpha) {
  return {{0, 0, 0}, up, up, view, alpha};
}

// A tracer whose mesh is far below the origin, so that it hides nothing.
RayTracer make_free_tracer() {
  TriangleMesh mesh = make_box({1, 1, 1});
  for (Vec3& p : mesh.positions) p.y -= 100;
  return RayTracer(mesh);
}

EnvironmentLight make_environment(const std::function<Rgb(Vec3)>& radiance) {
  EnvironmentLight light;
  light.image = make_image(128, 64, 3);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 128; ++x) {
      const Rgb value = radiance(environment_direction(
          light, {(static_cast<float>(x) + 0.5f) / 128, (static_cast<float>(y) + 0.5f) / 64}));
      at(light.image, x, y, 0) = value.x;
      at(light.image, x, y, 1) = value.y;
      at(light.image, x, y, 2) = value.z;
    }
  return light;
}

TEST(specular, pdf_of_visible_normals_is_normalised) {
  // Directions below the horizon are part of it.
  for (const float alpha : {0.15f, 0.4f, 1.0f})
    for (const double theta : {0.0, 0.7, 1.3}) {
      const Vec3 view = at_angle(theta);
      const double sum = integrate_sphere(
          400, [&](Vec3 light) { return static_cast<double>(pdf_ggx(alpha, up, view, light)); });
      EXPECT_NEAR(sum, 1, 0.01) << alpha << " " << theta;
    }
}

TEST(specular, samples_follow_their_pdf) {
  Rng rng = make_rng(4);
  const Vec3 view = at_angle(0.9);
  const float alpha = 0.3f;
  // E[f / p] = integral of f over where p > 0.
  double sum = 0, mean_y = 0;
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const Vec3 light = sample_ggx(
        alpha, up, view,
        {static_cast<float>(sample_uniform(rng)), static_cast<float>(sample_uniform(rng))});
    ASSERT_NEAR(length(light), 1, 1e-4);
    mean_y += static_cast<double>(light.y) / count;
    sum += static_cast<double>(eval_ggx(alpha, eta, up, view, light) /
                               pdf_ggx(alpha, up, view, light)) /
           count;
  }
  const double expected_y = integrate_sphere(400, [&](Vec3 light) {
    return static_cast<double>(pdf_ggx(alpha, up, view, light) * light.y);
  });
  const double expected = integrate_sphere(
      400, [&](Vec3 light) { return static_cast<double>(eval_ggx(alpha, eta, up, view, light)); });
  EXPECT_NEAR(mean_y, expected_y, 0.004);
  EXPECT_NEAR(sum, expected, 0.01 * expected);
}

TEST(specular, reflects_no_more_than_it_gets) {
  // With an enormous index all is reflected, and masking alone takes light away.
  for (const float alpha : {0.1f, 0.3f, 0.6f, 1.0f})
    for (const double theta : {0.0, 0.5, 1.0, 1.4}) {
      const Vec3 view = at_angle(theta);
      const double sum = integrate_sphere(300, [&](Vec3 light) {
        return static_cast<double>(eval_ggx(alpha, 1e4f, up, view, light));
      });
      EXPECT_LT(sum, 1.01) << alpha << " " << theta;
      EXPECT_GT(sum, 0.85 - 0.6 * static_cast<double>(alpha)) << alpha << " " << theta;
      // For alpha = 1 and n.v = 1: int mu / (1 + mu) dmu.
      if (alpha == 1 && theta == 0) {
        EXPECT_NEAR(sum, 1 - std::log(2), 0.002);
      }
    }
}

TEST(specular, is_reciprocal) {
  const Vec3 a = at_angle(0.4), b = at_angle(1.1, 2.5);
  for (const float alpha : {0.01f, 0.2f, 0.9f})
    EXPECT_NEAR(eval_ggx(alpha, eta, up, a, b) / b.y, eval_ggx(alpha, eta, up, b, a) / a.y,
                1e-5f * eval_ggx(alpha, eta, up, a, b) / b.y);
}

TEST(specular, directional_light_in_closed_form) {
  // The half vector is the normal: D = 1 / (pi alpha^2), and Smith's terms of one angle.
  const RayTracer tracer = make_free_tracer();
  const float alpha = 0.25f, theta = 0.6f;
  const Vec3 view = at_angle(0.6), light{-view.x, view.y, -view.z};
  const std::vector<Light> lights{DirectionalLight{light, {2, 3, 4}}};
  const SpecularShader shader(lights, tracer, static_cast<double>(eta));
  const Rgb found = eval_specular(shader, make_reflector(view, alpha), {1, 1}, 0, 1);
  const float c = std::cos(theta), tan2 = 1 / (c * c) - 1;
  const float lambda = (std::sqrt(1 + alpha * alpha * tan2) - 1) / 2;
  const float f = 1 - fresnel_transmission(eta, c);
  const float expected =
      f / (std::numbers::pi_v<float> * alpha * alpha) / (1 + 2 * lambda) / (4 * c * c) * c;
  EXPECT_NEAR(found.x, 2 * expected, 1e-4f * expected);
  EXPECT_NEAR(found.z, 4 * expected, 1e-4f * expected);
}

TEST(specular, point_light_falls_with_the_square_of_distance) {
  const RayTracer tracer = make_free_tracer();
  const std::vector<Light> near{PointLight{{0, 2, 0}, {1, 1, 1}}};
  const std::vector<Light> far{PointLight{{0, 6, 0}, {1, 1, 1}}};
  const auto eval = [&](const std::vector<Light>& lights) {
    const SpecularShader shader(lights, tracer, 1.5);
    return eval_specular(shader, make_reflector(at_angle(0.2), 0.3f), {1, 1}, 0, 1).x;
  };
  EXPECT_NEAR(eval(near) / eval(far), 9, 1e-3);
}

TEST(specular, smooth_surface_mirrors_the_environment) {
  const RayTracer tracer = make_free_tracer();
  const std::vector<Light> lights{make_environment([](Vec3 d) {
    return Rgb{1, 1, 1} * (1.5f + d.x) + Rgb{0, 1, 0} * (d.z * d.z);
  })};
  const auto& environment = std::get<EnvironmentLight>(lights[0]);
  const SpecularShader shader(lights, tracer, static_cast<double>(eta));
  for (const double theta : {0.1, 0.6, 1.2}) {
    const Vec3 view = at_angle(theta), mirrored{-view.x, view.y, -view.z};
    const Rgb found =
        eval_specular(shader, make_reflector(view, specular_alpha(0)), {7, 64}, 0, 64);
    const Rgb expected =
        eval_environment(environment, mirrored) * (1 - fresnel_transmission(eta, view.y));
    EXPECT_NEAR(found.x, expected.x, 0.01f * expected.x) << theta;
    EXPECT_NEAR(found.y, expected.y, 0.01f * expected.y) << theta;
  }
}

TEST(specular, rays_find_a_small_bright_light) {
  // A sun of a few pixels that facet sampling alone would hit once in thousands of rays.
  const RayTracer tracer = make_free_tracer();
  const Vec3 sun = at_angle(0.5, 1.0);
  const std::vector<Light> lights{make_environment([&](Vec3 d) {
    return dot(d, sun) > 0.999f ? Rgb{1000, 1000, 1000} : Rgb{0.1f, 0.1f, 0.1f};
  })};
  const auto& environment = std::get<EnvironmentLight>(lights[0]);
  const SpecularShader shader(lights, tracer, static_cast<double>(eta));
  const Vec3 view = at_angle(0.7, -1.0);
  const double expected = integrate_sphere(1000, [&](Vec3 light) {
    return static_cast<double>(eval_ggx(0.5f, eta, up, view, light) *
                               eval_environment(environment, light).x);
  });
  double mean = 0, square = 0;
  for (int pixel = 0; pixel < 100; ++pixel) {
    const PixelSequence sequence{hash_u64(static_cast<std::uint64_t>(pixel)), 9};
    const double value =
        static_cast<double>(eval_specular(shader, make_reflector(view, 0.5f), sequence, 0, 9).x);
    mean += value / 100;
    square += value * value / 100;
  }
  EXPECT_NEAR(mean, expected, 0.03 * expected);
  EXPECT_LT(std::sqrt(square - mean * mean), 0.25 * expected);  // no fireflies
}

TEST(specular, what_is_hidden_is_not_reflected) {
  TriangleMesh mesh = make_box({10, 1, 10});
  for (Vec3& p : mesh.positions) p.y += 5;
  const RayTracer tracer(mesh);
  const std::vector<Light> lights{DirectionalLight{up, {1, 1, 1}}, PointLight{{0, 9, 0}, {1, 1, 1}},
                                  PointLight{{0, 2, 0}, {1, 1, 1}}};
  const auto eval = [&](std::size_t i) {
    const std::vector<Light> one{lights[i]};
    const SpecularShader shader(one, tracer, 1.5);
    return eval_specular(shader, make_reflector(up, 0.3f), {1, 1}, 0, 1).x;
  };
  EXPECT_EQ(eval(0), 0);
  EXPECT_EQ(eval(1), 0);
  EXPECT_GT(eval(2), 0);  // below the box
}

}  // namespace
}  // namespace parian

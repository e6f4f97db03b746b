// Environments made by code: a clear sky and a studio.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "scene/environment.h"

namespace parian {
namespace {

constexpr float degrees = std::numbers::pi_v<float> / 180;

float smooth_step(float low, float high, float x) {
  const float t = std::clamp((x - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

Rgb mix(Rgb a, Rgb b, float t) {
  return a * (1 - t) + b * t;
}

// Azimuth from -z towards +x.
Vec3 towards(float azimuth_deg, float elevation_deg) {
  const float a = azimuth_deg * degrees, e = elevation_deg * degrees;
  return {std::sin(a) * std::cos(e), std::sin(e), -std::cos(a) * std::cos(e)};
}

Rgb eval_sky(Vec3 direction) {
  const Vec3 sun = towards(-135, 40);
  const float angle = std::acos(std::clamp(dot(direction, sun), -1.0f, 1.0f)) / degrees;
  const float height = std::max(0.0f, direction.y);
  Rgb sky = mix({0.36f, 0.41f, 0.48f}, {0.09f, 0.16f, 0.33f}, std::pow(height, 0.45f));
  sky += Rgb{0.9f, 0.75f, 0.5f} * (0.6f * std::exp(-angle / 9));
  sky += Rgb{1.0f, 0.9f, 0.74f} * (180 * (1 - smooth_step(3, 5, angle)));
  const Rgb ground =
      mix({0.16f, 0.145f, 0.125f}, {0.10f, 0.09f, 0.08f}, std::max(0.0f, -direction.y));
  return mix(ground, sky, smooth_step(-0.03f, 0.02f, direction.y));
}

// A rectangle that faces the origin, seen in its tangent plane, with soft edges.
struct SoftBox {
  float azimuth_deg, elevation_deg, half_width_deg, half_height_deg;
  Rgb radiance;
};
constexpr std::array<SoftBox, 3> soft_boxes{{{-140, 38, 24, 18, {7.5f, 7.1f, 6.6f}},
                                             {112, 14, 12, 34, {2.0f, 2.2f, 2.6f}},
                                             {18, 30, 30, 9, {8.0f, 8.3f, 9.0f}}}};

Rgb eval_studio(Vec3 direction) {
  Rgb radiance = mix({0.025f, 0.024f, 0.023f}, {0.05f, 0.052f, 0.056f}, 0.5f + 0.5f * direction.y);
  for (const SoftBox& box : soft_boxes) {
    const Vec3 axis = towards(box.azimuth_deg, box.elevation_deg);
    const Vec3 right = normalize(cross(axis, Vec3{0, 1, 0})), up = cross(right, axis);
    const float depth = dot(direction, axis);
    if (depth <= 0) continue;
    const float x =
        std::abs(dot(direction, right)) / (depth * std::tan(box.half_width_deg * degrees));
    const float y =
        std::abs(dot(direction, up)) / (depth * std::tan(box.half_height_deg * degrees));
    const float inside = (1 - smooth_step(0.85f, 1, x)) * (1 - smooth_step(0.85f, 1, y));
    radiance += box.radiance * (inside * (1 - 0.3f * std::min(1.0f, (x * x + y * y) / 2)));
  }
  return radiance;
}

Image draw(int width, int height, Rgb (*eval)(Vec3)) {
  EnvironmentLight light;
  light.image = make_image(width, height, 3);
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    const auto y = static_cast<int>(row);
    for (int x = 0; x < width; ++x) {
      const Vec2 uv{(static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                    (static_cast<float>(y) + 0.5f) / static_cast<float>(height)};
      const Rgb radiance = eval(environment_direction(light, uv));
      at(light.image, x, y, 0) = radiance.x;
      at(light.image, x, y, 1) = radiance.y;
      at(light.image, x, y, 2) = radiance.z;
    }
  });
  return std::move(light.image);
}

}  // namespace

Image make_sky_image(int width, int height) {
  return draw(width, height, eval_sky);
}

Image make_studio_image(int width, int height) {
  return draw(width, height, eval_studio);
}

}  // namespace parian

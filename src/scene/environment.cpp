#include "scene/environment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "image/color.h"

namespace parian {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

// Azimuth over 2 pi of the image's middle column, as a part of its width.
float rotation_of(const EnvironmentLight& light) {
  return static_cast<float>(light.rotation_deg / 360 - std::floor(light.rotation_deg / 360));
}

// In [0, 1); a float's rounding must not reach 1.
float wrap(float u) {
  u -= std::floor(u);
  return u < 1 ? u : 0;
}

// The pixels around a place, interpolated along their rows.
struct TwoRows {
  Rgb above;
  Rgb below;
  std::size_t y0 = 0;
  std::size_t y1 = 0;
  float fraction = 0;  // from above to below
};

// cdf[0] = 0 ... cdf[count] = 1 of `weight`; returns the sum. All 0 where the sum is 0.
double accumulate(const std::vector<double>& weight, float* cdf) {
  double sum = 0, running = 0;
  for (const double w : weight) sum += w;
  *cdf = 0;
  for (const double w : weight) {
    running += w;
    *++cdf = sum > 0 ? static_cast<float>(std::min(1.0, running / sum)) : 0;
  }
  if (sum > 0) *cdf = 1;
  return sum;
}

// The interval that holds `random`, and where in it; intervals without width are never chosen.
struct Drawn {
  std::size_t index = 0;
  float part = 0;  // in [0, 1)
};
Drawn draw(const float* cdf, std::size_t count, float random) {
  // Last of cdf[0 .. count - 1] that is <= random; without branches that cannot be predicted.
  const float* low = cdf;
  for (std::size_t rest = count; rest > 1;) {
    const std::size_t half = rest / 2;
    low += low[half] <= random ? half : 0;
    rest -= half;
  }
  const float width = low[1] - low[0];
  return {static_cast<std::size_t>(low - cdf),
          width > 0 ? std::min((random - *low) / width, 0x1.fffffep-1f) : 0};
}

TwoRows lookup(const EnvironmentLight& light, Vec2 uv) {
  const int width = light.image.width, height = light.image.height;
  const float x = uv.x * static_cast<float>(width) - 0.5f;
  const float y = uv.y * static_cast<float>(height) - 0.5f;
  const auto left = static_cast<int>(std::floor(x)), top = static_cast<int>(std::floor(y));
  const float fx = x - static_cast<float>(left);
  const int x0 = left < 0 ? width - 1 : std::min(left, width - 1);
  const int x1 = left + 1 >= width ? 0 : left + 1;
  const auto y0 = static_cast<std::size_t>(std::clamp(top, 0, height - 1));
  const auto y1 = static_cast<std::size_t>(std::clamp(top + 1, 0, height - 1));
  const auto pixel = [&](int column, std::size_t row) {
    const float* p = &light.image.values[3 * (row * static_cast<std::size_t>(width) +
                                              static_cast<std::size_t>(column))];
    return Rgb{p[0], p[1], p[2]} * light.scale;
  };
  return {pixel(x0, y0) * (1 - fx) + pixel(x1, y0) * fx,
          pixel(x0, y1) * (1 - fx) + pixel(x1, y1) * fx, y0, y1, y - static_cast<float>(top)};
}

float luminance_of(Rgb color) {
  return luminance(color.x, color.y, color.z);
}

// Distributed as 1 - |x| over [-1, 1].
float sample_tent(float random) {
  return random < 0.5f ? std::sqrt(2 * random) - 1 : 1 - std::sqrt(2 * (1 - random));
}

}  // namespace

Image make_environment_image(Image image, const std::string& name, std::size_t* negative) {
  if (image.width < 1 || image.height < 1 || (image.channels != 1 && image.channels != 3))
    throw Error({name, "", "an image of 1 or 3 channels",
                 fmt::format("{} x {} pixels of {}", image.width, image.height, image.channels)});
  if (image.width != 2 * image.height)
    throw Error({name, "", "a latitude-longitude image, twice as wide as high",
                 fmt::format("{} x {} pixels", image.width, image.height)});
  Image rgb = make_image(image.width, image.height, 3);
  std::size_t below = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const float value = at(image, x, y, image.channels == 1 ? 0 : c);
        if (!(std::abs(value) <= static_cast<float>(max_radiance)))
          throw Error({name, fmt::format("pixel ({}, {}), channel {}", x, y, c),
                       fmt::format("a radiance of at most {}", max_radiance),
                       fmt::format("{}", value)});
        if (value < 0) ++below;
        at(rgb, x, y, c) = std::max(value, 0.0f);
      }
  if (negative != nullptr) *negative = below;
  return rgb;
}

Vec3 environment_direction(const EnvironmentLight& light, Vec2 uv) {
  const float phi = 2 * pi * wrap(uv.x - 0.5f - rotation_of(light));
  const float theta = pi * uv.y;
  const float sine = std::sin(theta);
  return {sine * std::sin(phi), std::cos(theta), -sine * std::cos(phi)};
}

Vec2 environment_uv(const EnvironmentLight& light, Vec3 direction) {
  const float phi = std::atan2(direction.x, -direction.z);
  const float sine = std::sqrt(direction.x * direction.x + direction.z * direction.z);
  return {wrap(phi / (2 * pi) + 0.5f + rotation_of(light)),
          std::min(std::atan2(sine, direction.y) / pi, 0x1.fffffep-1f)};
}

Rgb eval_environment_at(const EnvironmentLight& light, Vec2 uv) {
  const TwoRows rows = lookup(light, uv);
  return rows.above * (1 - rows.fraction) + rows.below * rows.fraction;
}

Rgb eval_environment(const EnvironmentLight& light, Vec3 direction) {
  return eval_environment_at(light, environment_uv(light, direction));
}

EnvironmentSampler make_environment_sampler(const EnvironmentLight& light) {
  PARIAN_CHECK_EQ(light.image.channels, 3);
  PARIAN_CHECK_LE(1, light.image.width);
  PARIAN_CHECK_LE(1, light.image.height);
  const auto width = static_cast<std::size_t>(light.image.width);
  const auto height = static_cast<std::size_t>(light.image.height);
  EnvironmentSampler sampler;
  sampler.light = &light;
  sampler.row_sine.resize(height);
  sampler.row_cdf.resize(height + 1);
  sampler.column_cdf.resize(height * (width + 1));
  std::vector<double> row_weight(height);
  parallel_for(height, [&](std::size_t y) {
    std::vector<double> weight(width);
    for (std::size_t x = 0; x < width; ++x) {
      const float* p = &light.image.values[3 * (y * width + x)];
      weight[x] = luminance_of(Rgb{p[0], p[1], p[2]} * light.scale);
    }
    const double sine =
        std::sin(std::numbers::pi * (static_cast<double>(y) + 0.5) / static_cast<double>(height));
    sampler.row_sine[y] = static_cast<float>(sine);
    row_weight[y] = sine * accumulate(weight, &sampler.column_cdf[y * (width + 1)]);
  });
  const double total = accumulate(row_weight, sampler.row_cdf.data());
  if (total > 0)
    sampler.density =
        static_cast<float>(static_cast<double>(width) * static_cast<double>(height) / total);
  return sampler;
}

DirectionSample sample_environment(const EnvironmentSampler& sampler, Vec2 random) {
  const auto width = static_cast<std::size_t>(sampler.light->image.width);
  const auto height = static_cast<std::size_t>(sampler.light->image.height);
  const Drawn row = draw(sampler.row_cdf.data(), height, random.y);
  const Drawn column = draw(&sampler.column_cdf[row.index * (width + 1)], width, random.x);
  DirectionSample sample;
  sample.uv.x = wrap((static_cast<float>(column.index) + 0.5f + sample_tent(column.part)) /
                     static_cast<float>(width));
  // What would be beyond a pole is reflected, as the lookup repeats the first and last rows.
  const float v =
      (static_cast<float>(row.index) + 0.5f + sample_tent(row.part)) / static_cast<float>(height);
  sample.uv.y = std::min(v < 0 ? -v : std::min(v, 2 - v), 0x1.fffffep-1f);
  sample.direction = environment_direction(*sampler.light, sample.uv);
  sample.pdf = eval_with_pdf(sampler, sample.uv).pdf;
  return sample;
}

EnvironmentValue eval_with_pdf(const EnvironmentSampler& sampler, Vec2 uv) {
  const TwoRows rows = lookup(*sampler.light, uv);
  const float part = rows.fraction;
  const float weight = luminance_of(rows.above) * sampler.row_sine[rows.y0] * (1 - part) +
                       luminance_of(rows.below) * sampler.row_sine[rows.y1] * part;
  // From places to solid angle: dw = 2 pi^2 sin(pi v) du dv.
  const float sine = std::max(std::sin(pi * uv.y), 1e-6f);
  return {rows.above * (1 - part) + rows.below * part,
          weight * sampler.density / (2 * pi * pi * sine)};
}

float pdf_environment(const EnvironmentSampler& sampler, Vec3 direction) {
  return eval_with_pdf(sampler, environment_uv(*sampler.light, direction)).pdf;
}

}  // namespace parian

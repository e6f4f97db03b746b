#include "scene/environment.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "image/color.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

EnvironmentLight random_environment(int width, int height, double rotation_deg = 0) {
  EnvironmentLight light{.image = make_image(width, height, 3), .rotation_deg = rotation_deg};
  Rng rng = make_rng(7);
  for (float& value : light.image.values)
    value = static_cast<float>(std::pow(sample_uniform(rng), 6));
  return light;
}

TEST(Environment, DirectionsOfTheImage) {
  EnvironmentLight light{.image = make_image(8, 4, 3)};
  const auto expect_direction = [&](Vec2 uv, Vec3 direction) {
    EXPECT_NEAR(distance(environment_direction(light, uv), direction), 0, 1e-6);
    EXPECT_NEAR(environment_uv(light, direction).x, uv.x, 1e-6);
    EXPECT_NEAR(environment_uv(light, direction).y, uv.y, 1e-6);
  };
  expect_direction({0.5f, 0.5f}, {0, 0, -1});  // the middle column
  expect_direction({0.75f, 0.5f}, {1, 0, 0});  // to its right, seen from inside
  expect_direction({0.25f, 0.5f}, {-1, 0, 0});
  EXPECT_NEAR(environment_direction(light, {0.3f, 0}).y, 1, 1e-6);  // row 0
  // A quarter turn about +y takes -z to -x.
  light.rotation_deg = 90;
  expect_direction({0.5f, 0.5f}, {-1, 0, 0});
  light.rotation_deg = -270;
  expect_direction({0.5f, 0.5f}, {-1, 0, 0});
}

TEST(Environment, PlacesAndDirectionsAreInverse) {
  Rng rng = make_rng(3);
  const EnvironmentLight light = random_environment(16, 8, 77);
  for (int i = 0; i < 1000; ++i) {
    const Vec2 uv{static_cast<float>(sample_uniform(rng)), static_cast<float>(sample_uniform(rng))};
    const Vec2 back = environment_uv(light, environment_direction(light, uv));
    ASSERT_NEAR(std::remainder(back.x - uv.x, 1.0f), 0, 1e-6 / std::sin(pi * uv.y));
    ASSERT_NEAR(back.y, uv.y, 1e-6);
    ASSERT_TRUE(back.x >= 0 && back.x < 1 && back.y >= 0 && back.y < 1);
  }
}

TEST(Environment, LookupIsBilinearAndWrapsAround) {
  EnvironmentLight light{.image = make_image(4, 2, 3), .scale = {1, 2, 3}};
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 2; ++y)
      for (int c = 0; c < 3; ++c) at(light.image, x, y, c) = static_cast<float>(x + 10 * y);
  EXPECT_EQ(eval_environment_at(light, {0.125f, 0.25f}), (Rgb{0, 0, 0}));
  EXPECT_NEAR(eval_environment_at(light, {0.625f, 0.25f}).x, 2, 1e-5);
  EXPECT_NEAR(eval_environment_at(light, {0.75f, 0.5f}).y, 2 * (2.5 + 5), 1e-5);
  // Between the last and the first column.
  EXPECT_NEAR(eval_environment_at(light, {0, 0.75f}).z, 3 * 11.5, 1e-5);
  EXPECT_NEAR(eval_environment_at(light, {0.99999994f, 0.75f}).z, 3 * 11.5, 1e-4);
  EXPECT_NEAR(eval_environment_at(light, {0.125f, 0.99999994f}).x, 10, 1e-5);
}

TEST(EnvironmentSampler, PdfIntegratesToOne) {
  for (const auto& [width, height] : {std::pair{1, 1}, {16, 8}, {7, 5}}) {
    const EnvironmentLight light = random_environment(width, height, 40);
    const EnvironmentSampler sampler = make_environment_sampler(light);
    double sum = 0;
    const int n = 70;  // per pixel and axis: midpoints, exact in azimuth, O(1/n^2) in height
    for (int y = 0; y < height * n; ++y) {
      const double theta = (y + 0.5) / (height * n) * pi;
      for (int x = 0; x < width; ++x) {
        const Vec2 uv{static_cast<float>((x + 0.5) / width),
                      static_cast<float>((y + 0.5) / (height * n))};
        sum += pdf_environment(sampler, environment_direction(light, uv)) * std::sin(theta) *
               (pi / (height * n)) * (2 * pi / width);
      }
    }
    EXPECT_NEAR(sum, 1, 2e-4);
  }
}

// Counts per cell, of half a pixel each way, against the pdf's integral over the cell.
TEST(EnvironmentSampler, SamplesFollowThePdf) {
  const int width = 12, height = 6, columns = 2 * width, rows = 2 * height, count = 400000;
  const EnvironmentLight light = random_environment(width, height, 123);
  const EnvironmentSampler sampler = make_environment_sampler(light);
  std::vector<int> found(static_cast<std::size_t>(columns * rows));
  Rng rng = make_rng(5);
  for (int i = 0; i < count; ++i) {
    const DirectionSample sample = sample_environment(
        sampler,
        {static_cast<float>(sample_uniform(rng)), static_cast<float>(sample_uniform(rng))});
    ASSERT_NEAR(length(sample.direction), 1, 1e-5);
    ASSERT_NEAR(pdf_environment(sampler, sample.direction), sample.pdf, 1e-3 * sample.pdf + 1e-6);
    ++found[static_cast<std::size_t>(static_cast<int>(sample.uv.y * rows) * columns +
                                     static_cast<int>(sample.uv.x * columns))];
  }
  double chi_square = 0, sum = 0, rare = 0;  // cells with few samples count together
  int cells = 0, rare_found = 0;
  const int parts = 16;
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      double probability = 0;
      for (int k = 0; k < parts * parts; ++k) {
        const int across = k % parts, down = k / parts;
        const Vec2 uv{static_cast<float>((x + (across + 0.5) / parts) / columns),
                      static_cast<float>((y + (down + 0.5) / parts) / rows)};
        probability += eval_with_pdf(sampler, uv).pdf * std::sin(pi * uv.y) * 2 * pi * pi /
                       (columns * rows * parts * parts);
      }
      sum += probability;
      const int here = found[static_cast<std::size_t>(y * columns + x)];
      if (probability * count < 60) {
        rare += probability * count, rare_found += here;
        continue;
      }
      ++cells;
      chi_square += std::pow(here - probability * count, 2) / (probability * count);
    }
  ASSERT_GT(rare, 20);
  chi_square += std::pow(rare_found - rare, 2) / rare;
  EXPECT_NEAR(sum, 1, 1e-5);
  // Mean `cells`, deviation sqrt(2 cells).
  EXPECT_GT(cells, 200);
  EXPECT_LT(chi_square, cells + 4 * std::sqrt(2.0 * cells));
}

// Proportional to the luminance of the interpolated image, but for the sine across a row.
TEST(EnvironmentSampler, FollowsTheInterpolatedImage) {
  const EnvironmentLight light = random_environment(16, 128);
  const EnvironmentSampler sampler = make_environment_sampler(light);
  Rng rng = make_rng(9);
  double ratio = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec2 uv{static_cast<float>(sample_uniform(rng)),
                  static_cast<float>(0.2 + 0.6 * sample_uniform(rng))};
    const EnvironmentValue value = eval_with_pdf(sampler, uv);
    EXPECT_EQ(value.radiance, eval_environment_at(light, uv));
    const double here = value.pdf / luminance(value.radiance.x, value.radiance.y, value.radiance.z);
    if (i == 0) ratio = here;
    EXPECT_NEAR(here / ratio, 1, 0.06);
  }
}

// Where the bilinear image is not black the sampler can go, also beside a single bright pixel.
TEST(EnvironmentSampler, CoversWhatIsInterpolated) {
  EnvironmentLight light{.image = make_image(16, 8, 3)};
  at(light.image, 0, 3, 1) = 100;
  const EnvironmentSampler sampler = make_environment_sampler(light);
  Rng rng = make_rng(1);
  for (int i = 0; i < 2000; ++i) {
    const Vec2 uv{static_cast<float>(sample_uniform(rng)), static_cast<float>(sample_uniform(rng))};
    if (eval_environment_at(light, uv) != Rgb{}) {
      ASSERT_GT(eval_with_pdf(sampler, uv).pdf, 0) << uv.x << ' ' << uv.y;
    }
  }
}

TEST(EnvironmentSampler, BlackImagesHaveNoPdf) {
  const EnvironmentLight light{.image = make_image(4, 2, 3)};
  const EnvironmentSampler sampler = make_environment_sampler(light);
  EXPECT_EQ(sample_environment(sampler, {0.3f, 0.4f}).pdf, 0);
  EXPECT_EQ(pdf_environment(sampler, {0, 0, 1}), 0);
}

TEST(Environment, SkiesAreLight) {
  for (const Image& image : {make_sky_image(), make_studio_image(), make_sky_image(2, 1)})
    for (const float value : image.values) ASSERT_TRUE(value > 0 && value < 1000) << value;
  // The sun stands where the header says.
  const EnvironmentLight sky{.image = make_sky_image()};
  const auto azimuth = static_cast<float>(-135 * pi / 180),
             elevation = static_cast<float>(40 * pi / 180);
  const Vec3 sun{std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                 -std::cos(azimuth) * std::cos(elevation)};
  EXPECT_LT(sun.x, 0);
  EXPECT_GT(sun.z, 0);  // in front of an object that is seen from +z
  EXPECT_GT(eval_environment(sky, sun).x, 100);
  EXPECT_LT(eval_environment(sky, -sun).x, 0.2f);
}

}  // namespace
}  // namespace parian

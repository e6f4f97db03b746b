#include "edit/recolor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "image/color_spaces.h"

namespace parian {
namespace {

Color random_albedo(Rng& rng) {
  Color color;
  for (double& value : color) value = 0.05 + 0.9 * sample_uniform(rng);
  return color;
}

Color recolor_one(Color albedo, const Recolor& recolor, float amount) {
  recolor_planes(albedo.data(), 1, recolor, &amount);
  return albedo;
}

void expect_near(const Color& a, const Color& b, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}

TEST(Recolor, NothingChangesNothing) {
  Rng rng = make_rng(1);
  for (int i = 0; i < 100; ++i) {
    const Color albedo = random_albedo(rng);
    EXPECT_EQ(recolor_one(albedo, {}, 1), albedo);
    EXPECT_EQ(recolor_one(albedo, {90, 2, 0.5}, 0), albedo);
  }
}

TEST(Recolor, HueTurnsBackAndKeepsLightnessAndChroma) {
  Rng rng = make_rng(2);
  for (int i = 0; i < 100; ++i) {
    Color albedo = random_albedo(rng);
    albedo = recolor_one(albedo, {0, 0.3, 1}, 1);  // inside the gamut whatever the hue
    const Color turned = recolor_one(albedo, {50, 1, 1}, 1);
    expect_near(recolor_one(turned, {-50, 1, 1}, 1), albedo, 1e-9);
    const Color a = oklab_to_oklch(linear_to_oklab(albedo)),
                b = oklab_to_oklch(linear_to_oklab(turned));
    EXPECT_NEAR(a[0], b[0], 1e-9);
    EXPECT_NEAR(a[1], b[1], 1e-9);
    EXPECT_NEAR(std::cos(b[2] - a[2]), std::cos(50 * std::numbers::pi / 180), 1e-6);
  }
}

TEST(Recolor, LightnessKeepsHueAndGreysStayGrey) {
  const Color albedo{0.6, 0.3, 0.2};
  const Color darker = recolor_one(albedo, {0, 1, 0.5}, 1);
  EXPECT_NEAR(oklab_to_oklch(linear_to_oklab(albedo))[2],
              oklab_to_oklch(linear_to_oklab(darker))[2], 1e-9);
  // Lightness times l scales cone responses, and so all channels, by l^3.
  expect_near(darker, {0.6 / 8, 0.3 / 8, 0.2 / 8}, 1e-9);
  const Color grey = recolor_one({0.4, 0.4, 0.4}, {120, 3, 1}, 1);
  expect_near(grey, {0.4, 0.4, 0.4}, 1e-14);
}

TEST(Recolor, StaysWithinThePossible) {
  Rng rng = make_rng(3);
  for (int i = 0; i < 200; ++i) {
    const Color rgb = recolor_one(random_albedo(rng), {360 * sample_uniform(rng), 10, 1}, 1);
    for (double value : rgb) EXPECT_GE(value, 0);
  }
}

// A colour on the gamut's edge: hue and lightness are kept, and one channel is 0.
TEST(Recolor, VividColoursLoseChromaAlone) {
  Rng rng = make_rng(4);
  for (int i = 0; i < 200; ++i) {
    const Color albedo = random_albedo(rng);
    const Color before = oklab_to_oklch(linear_to_oklab(albedo));
    if (before[1] < 0.02) continue;
    const Color rgb = recolor_one(albedo, {0, 10, 1}, 1);
    const Color after = oklab_to_oklch(linear_to_oklab(rgb));
    EXPECT_NEAR(after[0], before[0], 1e-4);
    EXPECT_NEAR(after[2], before[2], 1e-3);
    EXPECT_GE(after[1], before[1]);
    const double least = std::min({rgb[0], rgb[1], rgb[2]});
    EXPECT_TRUE(least < 1e-8 || after[1] > 9.99 * before[1]);
  }
}

TEST(Recolor, AmountsTakePartOfTheChange) {
  Rng rng = make_rng(5);
  for (int i = 0; i < 50; ++i) {
    const Color albedo = random_albedo(rng);
    expect_near(recolor_one(albedo, {80, 0.5, 1.5}, 0.25),
                recolor_one(albedo, {20, 0.875, 1.125}, 1), 1e-12);
  }
}

TEST(Recolor, PlanesAreRecolouredPixelByPixel) {
  constexpr std::size_t pixels = 3000;
  Rng rng = make_rng(6);
  std::vector<double> planes(3 * pixels);
  for (double& value : planes) value = sample_uniform(rng);
  std::vector<float> amount(pixels);
  for (std::size_t i = 0; i < pixels; ++i)
    amount[i] = i % 3 == 2 ? static_cast<float>(sample_uniform(rng)) : static_cast<float>(i % 3);
  const std::vector<double> before = planes;
  const Recolor recolor{130, 1.6, 0.8};
  recolor_planes(planes.data(), pixels, recolor, amount.data());
  for (std::size_t i = 0; i < pixels; ++i) {
    const Color expected =
        recolor_one({before[i], before[pixels + i], before[2 * pixels + i]}, recolor, amount[i]);
    EXPECT_EQ((Color{planes[i], planes[pixels + i], planes[2 * pixels + i]}), expected);
  }
}

TEST(Recolor, ParametersAreChecked) {
  Recolor recolor;
  EXPECT_NO_THROW(check(describe(recolor)));
  recolor.saturation = -0.5;
  EXPECT_THROW(check(describe(recolor)), Error);
  recolor = {std::numeric_limits<double>::quiet_NaN(), 1, 1};
  EXPECT_THROW(check(describe(recolor)), Error);
}

}  // namespace
}  // namespace parian

#include "edit/recolor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"

namespace parian {
namespace {

Color random_albedo(Rng& rng) {
  Color color;
  for (double& value : color) value = 0.05 + 0.9 * sample_uniform(rng);
  return color;
}

void expect_near(const Color& a, const Color& b, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}

TEST(Recolor, NothingChangesNothing) {
  Rng rng = make_rng(1);
  for (int i = 0; i < 100; ++i) {
    const Color albedo = random_albedo(rng);
    EXPECT_EQ(recolor_albedo(albedo, {}, 1), albedo);
    EXPECT_EQ(recolor_albedo(albedo, {90, 2, 0.5}, 0), albedo);
  }
}

TEST(Recolor, HueTurnsBackAndKeepsLightnessAndChroma) {
  Rng rng = make_rng(2);
  for (int i = 0; i < 100; ++i) {
    Color albedo = random_albedo(rng);
    albedo = recolor_albedo(albedo, {0, 0.3, 1}, 1);  // inside the gamut whatever the hue
    const Color turned = recolor_albedo(albedo, {50, 1, 1}, 1);
    expect_near(recolor_albedo(turned, {-50, 1, 1}, 1), albedo, 1e-9);
    const Color a = oklab_to_oklch(linear_to_oklab(albedo)),
                b = oklab_to_oklch(linear_to_oklab(turned));
    EXPECT_NEAR(a[0], b[0], 1e-9);
    EXPECT_NEAR(a[1], b[1], 1e-9);
    EXPECT_NEAR(std::cos(b[2] - a[2]), std::cos(50 * std::numbers::pi / 180), 1e-6);
  }
}

TEST(Recolor, LightnessKeepsHueAndGreysStayGrey) {
  const Color albedo{0.6, 0.3, 0.2};
  const Color darker = recolor_albedo(albedo, {0, 1, 0.5}, 1);
  EXPECT_NEAR(oklab_to_oklch(linear_to_oklab(albedo))[2],
              oklab_to_oklch(linear_to_oklab(darker))[2], 1e-9);
  // Lightness times l scales cone responses, and so all channels, by l^3.
  expect_near(darker, {0.6 / 8, 0.3 / 8, 0.2 / 8}, 1e-9);
  const Color grey = recolor_albedo({0.4, 0.4, 0.4}, {120, 3, 1}, 1);
  expect_near(grey, {0.4, 0.4, 0.4}, 1e-6);
}

TEST(Recolor, StaysWithinThePossible) {
  Rng rng = make_rng(3);
  for (int i = 0; i < 200; ++i) {
    const Color rgb = recolor_albedo(random_albedo(rng), {360 * sample_uniform(rng), 10, 1}, 1);
    for (double value : rgb) EXPECT_GE(value, 0);
  }
}

}  // namespace
}  // namespace parian

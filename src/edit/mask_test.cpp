#include "edit/mask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/error.h"
#include "base/random.h"
#include "edit/mask_shapes.h"

namespace parian {
namespace {

double sum(const Mask& mask) {
  return std::accumulate(mask.weight.begin(), mask.weight.end(), 0.0);
}

Mask random_mask(std::uint64_t seed, int width = 23, int height = 17) {
  Mask mask = make_mask(width, height, 0);
  Rng rng = make_rng(seed);
  for (float& weight : mask.weight) weight = static_cast<float>(sample_uniform(rng));
  return mask;
}

TEST(Mask, ShapesCoverTheirArea) {
  Mask rectangle = make_mask(40, 30, 0);
  draw_rectangle(rectangle, {3.25, 4.5}, {20.5, 11.75});
  EXPECT_NEAR(sum(rectangle), 17.25 * 7.25, 1e-4);
  Mask ellipse = make_mask(64, 64, 0);
  draw_ellipse(ellipse, {31.3, 32.1}, {20, 9}, 30);
  EXPECT_NEAR(sum(ellipse), std::numbers::pi * 20 * 9, 1.5);
  Mask triangle = make_mask(64, 64, 0);
  draw_polygon(triangle, {{2, 3}, {50, 10}, {20, 60}});
  EXPECT_NEAR(sum(triangle), 0.5 * std::abs(48 * 57 - 18 * 7), 1.5);
  Mask stroke = make_mask(64, 64, 0);
  draw_stroke(stroke, {{10, 20}, {40, 20}}, 6, 1);
  EXPECT_NEAR(sum(stroke), 30 * 12 + std::numbers::pi * 36, 1.0);
  Mask dab = make_mask(64, 64, 0);
  draw_stroke(dab, {{32, 32}}, 10, 0);  // integral of the smooth step over a disc: 0.3 pi r^2
  EXPECT_NEAR(sum(dab), 0.3 * std::numbers::pi * 100, 0.5);
}

TEST(Mask, ShapesMoveWithTheirPoints) {
  Mask here = make_mask(40, 40, 0), there = make_mask(40, 40, 0);
  draw_ellipse(here, {12.3, 11.6}, {7, 4}, 20);
  draw_ellipse(there, {17.3, 20.6}, {7, 4}, 20);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 34; ++x)
      EXPECT_NEAR(here.weight[static_cast<std::size_t>(y * 40 + x)],
                  there.weight[static_cast<std::size_t>((y + 9) * 40 + x + 5)], 0.07);
}

TEST(Mask, ShapesOutsideLeaveItEmpty) {
  Mask mask = make_mask(20, 20, 0);
  draw_rectangle(mask, {-10, -10}, {-1, -1});
  draw_ellipse(mask, {100, 10}, {5, 5}, 0);
  draw_stroke(mask, {{30, 30}, {40, 50}}, 3, 0.5);
  draw_polygon(mask, {{1, 1}, {5, 5}});
  EXPECT_TRUE(is_empty(mask));
}

TEST(Mask, GradientsRiseFromEndToEnd) {
  Mask mask = make_mask(50, 10, 0);
  draw_gradient(mask, {10, 5}, {40, 5});
  EXPECT_EQ(mask.weight[5], 0);
  EXPECT_EQ(mask.weight[45], 1);
  EXPECT_NEAR(mask.weight[24] + mask.weight[25], 1, 1e-6);
  for (std::size_t x = 1; x < 50; ++x) EXPECT_GE(mask.weight[x], mask.weight[x - 1]);
}

TEST(Mask, SetAlgebra) {
  const Mask a = random_mask(1), b = random_mask(2);
  EXPECT_EQ(intersect(a, a).weight, a.weight);
  EXPECT_EQ(unite(a, b).weight, unite(b, a).weight);
  EXPECT_EQ(invert(unite(a, b)).weight, intersect(invert(a), invert(b)).weight);
  EXPECT_EQ(subtract(a, b).weight, intersect(a, invert(b)).weight);
  EXPECT_TRUE(is_empty(subtract(make_mask(3, 3, 0.5f), make_mask(3, 3, 1))));
  const Mask twice = invert(invert(a));
  for (std::size_t i = 0; i < a.weight.size(); ++i)
    EXPECT_NEAR(twice.weight[i], a.weight[i], 1e-7f);
}

TEST(Mask, FeatheringKeepsConstantsAndTheMean) {
  const Mask constant = feather(make_mask(31, 22, 0.375f), 4);
  for (float weight : constant.weight) EXPECT_NEAR(weight, 0.375f, 1e-6f);
  const Mask mask = random_mask(3);
  EXPECT_NEAR(sum(feather(mask, 2.5)), sum(mask), 1e-3);
  EXPECT_EQ(feather(mask, 0).weight, mask.weight);
}

TEST(Mask, GrowingADiscAddsToItsRadius) {
  Mask disc = make_mask(80, 80, 0), larger = make_mask(80, 80, 0), smaller = make_mask(80, 80, 0);
  draw_ellipse(disc, {40, 40}, {15, 15}, 0);
  draw_ellipse(larger, {40, 40}, {21, 21}, 0);
  draw_ellipse(smaller, {40, 40}, {10, 10}, 0);
  EXPECT_NEAR(sum(grow(disc, 6)), sum(larger), 0.03 * sum(larger));
  EXPECT_NEAR(sum(grow(disc, -5)), sum(smaller), 0.05 * sum(smaller));
  const Mask grown = grow(random_mask(4), 1.5), mask = random_mask(4);
  for (std::size_t i = 0; i < mask.weight.size(); ++i) EXPECT_GE(grown.weight[i], mask.weight[i]);
}

TEST(Mask, ThresholdSelectsARange) {
  const double values[] = {0, 1, 2, 3, 4, 5};
  EXPECT_EQ(threshold(values, 6, 1, 2, 3, 0).weight, (std::vector<float>{0, 0, 1, 1, 0, 0}));
  EXPECT_EQ(threshold(values, 6, 1, 2, 3, 2).weight, (std::vector<float>{0, 0.5f, 1, 1, 0.5f, 0}));
}

std::string error_of(const Image& image) {
  try {
    make_mask(image, 3, 2);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(Mask, ImagesMustFit) {
  Image image = make_image(3, 2, 1, 0.5f);
  EXPECT_EQ(make_mask(image, 3, 2).weight, std::vector<float>(6, 0.5f));
  at(image, 1, 1, 0) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_of(image), "pixel (1, 1): expected a finite value, found nan");
  EXPECT_EQ(error_of(make_image(4, 2, 3)),
            "expected an image of 3 x 2 pixels, as the map, found 4 x 2");
}

}  // namespace
}  // namespace parian

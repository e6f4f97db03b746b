#include "edit/mask.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "base/random.h"
#include "base/test_errors.h"
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

// 16 points per pixel, so an area's error is that of a sum over points a quarter apart.
TEST(Mask, AreasConvergeWithSize) {
  for (int size : {16, 64, 256}) {
    const double r = 0.4 * size;
    Mask ellipse = make_mask(size, size, 0), kite = ellipse;
    draw_ellipse(ellipse, {0.5 * size, 0.5 * size}, {r, 0.6 * r}, 25);
    EXPECT_NEAR(sum(ellipse) / (0.6 * std::numbers::pi * r * r), 1, 0.25 / size);
    draw_polygon(kite, {{0.5 * size - r, 0.5 * size},
                        {0.5 * size, 0.5 * size - 0.7 * r},
                        {0.5 * size + r, 0.5 * size},
                        {0.5 * size, 0.5 * size + 0.9 * r}});
    EXPECT_NEAR(sum(kite) / (1.6 * r * r), 1, 0.25 / size);
  }
}

TEST(Mask, EdgesCoverPixelsInPart) {
  Mask mask = make_mask(4, 3, 0);
  draw_rectangle(mask, {0.5, 1.25}, {2.75, 2});
  EXPECT_EQ(mask.weight, (std::vector<float>{0, 0, 0, 0, 0.375f, 0.75f, 0.5625f, 0, 0, 0, 0, 0}));
  draw_rectangle(mask, {0, 0}, {1, 3});
  EXPECT_EQ(mask.weight, (std::vector<float>{1, 0, 0, 0, 1, 0.75f, 0.5625f, 0, 1, 0, 0, 0}));
}

// Each point by itself: inside when a ray to the left crosses the edges an odd number of times.
float count_points_inside(const std::vector<Point2>& points, int x, int y) {
  int count = 0;
  for (int point = 0; point < 16; ++point) {
    const int column = point % 4, row = point / 4;
    const double px = x + (column + 0.5) / 4, py = y + (row + 0.5) / 4;
    bool inside = false;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point2 &a = points[i], &b = points[(i + 1) % points.size()];
      if ((a.y > py) == (b.y > py)) continue;
      if (a.x + (py - a.y) * (b.x - a.x) / (b.y - a.y) <= px) inside = !inside;
    }
    count += inside ? 1 : 0;
  }
  return static_cast<float>(count) / 16;
}

TEST(Mask, PolygonsFollowTheEvenOddRule) {
  Rng rng = make_rng(7);
  for (int size : {3, 5, 12}) {
    std::vector<Point2> points(static_cast<std::size_t>(size));
    for (Point2& point : points)
      point = {50 * sample_uniform(rng) - 10, 40 * sample_uniform(rng) - 10};
    Mask mask = make_mask(31, 22, 0);
    draw_polygon(mask, points);
    for (int y = 0; y < 22; ++y)
      for (int x = 0; x < 31; ++x)
        EXPECT_EQ(mask.weight[static_cast<std::size_t>(y * 31 + x)],
                  count_points_inside(points, x, y));
  }
  Mask ring = make_mask(20, 20, 0);  // around twice: the inner square is outside
  draw_polygon(
      ring,
      {{2, 2}, {18, 2}, {18, 18}, {2, 18}, {2, 2}, {6, 6}, {14, 6}, {14, 14}, {6, 14}, {6, 6}});
  EXPECT_EQ(sum(ring), 16 * 16 - 8 * 8);
}

TEST(Mask, StrokesDoNotDependOnTheirNumberOfPoints) {
  std::vector<Point2> fine;
  fine.reserve(81);
  for (int i = 0; i <= 80; ++i) fine.push_back({4 + 0.25 * i, 7 + 0.125 * i});
  std::vector<Point2> twice = fine;
  twice.insert(twice.end(), fine.rbegin(), fine.rend());
  for (double radius : {0.6, 3.0})
    for (double hardness : {0.0, 0.5, 1.0}) {
      Mask coarse = make_mask(32, 24, 0), many = coarse, back = coarse;
      draw_stroke(coarse, {fine.front(), fine.back()}, radius, hardness);
      draw_stroke(many, fine, radius, hardness);
      draw_stroke(back, twice, radius, hardness);
      EXPECT_EQ(back.weight, many.weight);
      for (std::size_t i = 0; i < many.weight.size(); ++i)
        EXPECT_NEAR(many.weight[i], coarse.weight[i], 1e-6);
    }
}

void draw_all(Mask& mask, Point2 o) {
  draw_rectangle(mask, {o.x + 2.25, o.y + 20.5}, {o.x + 9.125, o.y + 25});
  draw_ellipse(mask, {o.x + 12.375, o.y + 11.625}, {7, 4}, 20);
  draw_polygon(mask, {{o.x + 15, o.y + 2.125}, {o.x + 27.625, o.y + 5}, {o.x + 20, o.y + 11.25}});
  draw_stroke(mask, {{o.x + 12, o.y + 20}, {o.x + 20, o.y + 18.5}, {o.x + 25, o.y + 24}}, 2.5, 0.5);
}

TEST(Mask, ShapesMoveWithTheirPoints) {
  Mask here = make_mask(40, 40, 0), there = here, cut = here;
  draw_all(here, {0, 0});
  draw_all(there, {5, 9});
  draw_all(cut, {-8, -6});
  for (int y = 0; y < 31; ++y)
    for (int x = 0; x < 35; ++x) {
      const float weight = here.weight[static_cast<std::size_t>(y * 40 + x)];
      EXPECT_EQ(weight, there.weight[static_cast<std::size_t>((y + 9) * 40 + x + 5)]);
      if (x < 8 || y < 6) continue;
      EXPECT_EQ(weight, cut.weight[static_cast<std::size_t>((y - 6) * 40 + x - 8)]);
    }
}

TEST(Mask, ShapesJoinWhatIsThere) {
  const Mask before = random_mask(5, 40, 40);
  Mask shapes = make_mask(40, 40, 0), joined = before;
  draw_all(shapes, {3, 4});
  draw_all(joined, {3, 4});
  EXPECT_EQ(joined.weight, unite(before, shapes).weight);
  EXPECT_FALSE(is_empty(shapes));
  const ThreadLimit limit(1);
  Mask alone = make_mask(40, 40, 0);
  draw_all(alone, {3, 4});
  EXPECT_EQ(alone.weight, shapes.weight);
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
  EXPECT_EQ(invert(intersect(a, b)).weight, unite(invert(a), invert(b)).weight);
  EXPECT_EQ(unite(a, a).weight, a.weight);
  EXPECT_EQ(intersect(a, make_mask(23, 17, 1)).weight, a.weight);
  EXPECT_TRUE(is_empty(intersect(a, make_mask(23, 17, 0))));
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
  const double mean = sum(mask) / static_cast<double>(mask.pixels());
  for (double sigma : {0.3, 2.5, 20.0})
    EXPECT_NEAR(sum(feather(mask, sigma)) / static_cast<double>(mask.pixels()), mean, 1e-7);
  EXPECT_EQ(feather(mask, 0).weight, mask.weight);
  EXPECT_EQ(feather(mask, 1e-200).weight, mask.weight);
  for (float weight : feather(mask, 1e9).weight) EXPECT_NEAR(weight, mean, 2e-6);
}

// A line repeated with its mirror image, summed far beyond the kernel's end.
double blurred_mirrored(const std::vector<float>& line, int at, double sigma) {
  const int size = static_cast<int>(line.size());
  double sum = 0, weights = 0;
  for (int j = -300; j <= 300; ++j) {
    const int k = ((at + j) % (2 * size) + 2 * size) % (2 * size);
    const double weight = std::exp(-0.5 * j * j / (sigma * sigma));
    sum +=
        weight * static_cast<double>(line[static_cast<std::size_t>(std::min(k, 2 * size - 1 - k))]);
    weights += weight;
  }
  return sum / weights;
}

TEST(Mask, FeatheringIsAMirroredGaussian) {
  for (int size : {1, 2, 19})
    for (double sigma : {0.8, 3.0, 15.0}) {
      const Mask row = random_mask(11, size, 1), column{1, size, row.weight};
      const Mask across = feather(row, sigma), down = feather(column, sigma);
      for (int i = 0; i < size; ++i)
        EXPECT_NEAR(across.weight[static_cast<std::size_t>(i)],
                    blurred_mirrored(row.weight, i, sigma), 1e-4);
      EXPECT_EQ(across.weight, down.weight);
    }
}

TEST(Mask, FeatheringADotGivesTheVarianceBothWays) {
  Mask dot = make_mask(61, 61, 0);
  dot.weight[30 * 61 + 30] = 1;
  const Mask blurred = feather(dot, 3);
  double xx = 0, xy = 0, yy = 0;
  for (int y = 0; y < 61; ++y)
    for (int x = 0; x < 61; ++x) {
      const auto weight = static_cast<double>(blurred.weight[static_cast<std::size_t>(y * 61 + x)]);
      xx += weight * (x - 30) * (x - 30);
      xy += weight * (x - 30) * (y - 30);
      yy += weight * (y - 30) * (y - 30);
    }
  EXPECT_NEAR(xx, 9, 0.02);
  EXPECT_NEAR(yy, 9, 0.02);
  EXPECT_NEAR(xy, 0, 1e-5);
}

// The definition: each pixel's largest weight times the part of its neighbour that a disc covers.
Mask grow_by_definition(const Mask& mask, double radius) {
  Mask grown = mask;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x)
      for (int v = 0; v < mask.height; ++v)
        for (int u = 0; u < mask.width; ++u) {
          const double part = std::clamp(radius - std::hypot(u - x, v - y) + 1, 0.0, 1.0);
          float& to = grown.weight[static_cast<std::size_t>(y * mask.width + x)];
          to = std::max(to, static_cast<float>(part) *
                                mask.weight[static_cast<std::size_t>(v * mask.width + u)]);
        }
  return grown;
}

TEST(Mask, GrowingTakesTheLargestWithinADisc) {
  for (const auto& [width, height] : {std::pair{23, 17}, {1, 9}, {9, 1}, {2, 2}}) {
    Mask mask = random_mask(6, width, height);
    for (std::size_t i = 0; i < mask.weight.size(); ++i)
      if (i % 7 != 0 || i / static_cast<std::size_t>(width) % 5 == 2) mask.weight[i] = 0;
    for (double radius : {0.25, 1.0, 1.5, 2.9, 5.0, 8.0, 13.6, 100.0})
      EXPECT_EQ(grow(mask, radius).weight, grow_by_definition(mask, radius).weight) << radius;
    EXPECT_EQ(grow(mask, -2.5).weight, invert(grow_by_definition(invert(mask), 2.5)).weight);
    EXPECT_EQ(grow(mask, 0).weight, mask.weight);
  }
}

TEST(Mask, GrowingMovesAnEdgeByTheRadius) {
  Mask half = make_mask(30, 9, 0);
  draw_rectangle(half, {0, 0}, {10, 9});
  for (double radius : {0.25, 3.0, 6.75, -0.5, -4.25})
    EXPECT_NEAR(sum(grow(half, radius)), 9 * (10 + radius), 1e-4);
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
  const double nan[] = {std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(threshold(nan, 1, 1, 0, 1, 0).weight[0], 0);
  EXPECT_EQ(threshold(nan, 1, 1, 0, 1, 1).weight[0], 0);
}

std::string error_of(const Image& image) {
  return parian::error_of([&] { make_mask(image, 3, 2); });
}

TEST(Mask, ImagesAreStretched) {
  // Ramps stay ramps, from edge to edge of the pixels.
  Image ramp = make_image(12, 7, 1);
  for (int y = 0; y < 7; ++y)
    for (int x = 0; x < 12; ++x)
      at(ramp, x, y, 0) = static_cast<float>((x + 0.5) / 12 * 0.6 + (y + 0.5) / 7 * 0.4);
  for (const auto& [width, height] : {std::array{36, 7}, std::array{4, 21}, std::array{5, 3}}) {
    // Where the sizes do not divide each other, tents do so nearly.
    const double tolerance = width == 5 ? 5e-3 : 1e-6;
    const Mask mask = make_mask(ramp, width, height);
    ASSERT_EQ(mask.weight.size(), mask.pixels());
    // Inside, where nothing beyond the ends counts.
    for (int y = height > 7 ? 2 : 1; y < height - (height > 7 ? 2 : 1); ++y)
      for (int x = width > 12 ? 2 : 1; x < width - (width > 12 ? 2 : 1); ++x)
        EXPECT_NEAR(mask.weight[static_cast<std::size_t>(y * width + x)],
                    (x + 0.5) / width * 0.6 + (y + 0.5) / height * 0.4, tolerance)
            << width << " " << x << " " << y;
  }
  // A half stays a half, whatever the size.
  Image half = make_image(40, 4, 3, 0);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 20; ++x)
      for (int c = 0; c < 3; ++c) at(half, x, y, c) = 1;
  for (const int width : {1, 6, 20, 80, 101}) {
    const Mask mask = make_mask(half, width, 3);
    double sum = 0;
    for (const float w : mask.weight) sum += static_cast<double>(w);
    EXPECT_NEAR(sum / static_cast<double>(mask.pixels()), 0.5, 1e-6);
    EXPECT_EQ(mask.weight.front(), width > 1 ? 1 : 0.5f);
  }
}

TEST(Mask, ImagesCountByTheirLuminance) {
  Image image = make_image(3, 2, 1, 0.5f);
  EXPECT_EQ(make_mask(image, 3, 2).weight, std::vector<float>(6, 0.5f));
  at(image, 0, 0, 0) = -2;
  at(image, 2, 0, 0) = 3;
  EXPECT_EQ(make_mask(image, 3, 2).weight, (std::vector<float>{0, 0.5f, 1, 0.5f, 0.5f, 0.5f}));
  Image green = make_image(1, 1, 3, 0);
  at(green, 0, 0, 1) = 1;
  EXPECT_EQ(make_mask(green, 1, 1).weight[0], 0.7152f);
  at(image, 1, 1, 0) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_of(image), "pixel (1, 1): expected a finite value, found NaN");
}

}  // namespace
}  // namespace parian

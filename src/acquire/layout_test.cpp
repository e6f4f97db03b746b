#include "acquire/layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "acquire/test_documents_internal.h"
#include "base/test_errors.h"

namespace parian {
namespace {

LayoutGrid grid_of(int materials, std::uint64_t seed = 1) {
  return {.width = 40, .height = 30, .pixel_pitch_mm = 0.5, .materials = materials, .seed = seed};
}

double mean_weight(const std::vector<float>& weights, const LayoutGrid& grid, int material) {
  const auto pixels = static_cast<std::size_t>(grid.width * grid.height);
  double sum = 0;
  for (std::size_t i = 0; i < pixels; ++i)
    sum += weights[static_cast<std::size_t>(material) * pixels + i];
  return sum / static_cast<double>(pixels);
}

TEST(Layout, WeightsAreNotNegativeAndSumToOne) {
  for (const std::string& kind : layout_kinds()) {
    Layout layout = make_layout(kind);
    if (auto* image = std::get_if<ImageLayout>(&layout)) image->map = make_image(3, 2, 3, 0.4f);
    const LayoutGrid grid = grid_of(kind == "uniform" ? 1 : 3);
    const auto weights = make_weights(layout, grid);
    const auto pixels = static_cast<std::size_t>(grid.width * grid.height);
    ASSERT_EQ(weights.size(), pixels * static_cast<std::size_t>(grid.materials)) << kind;
    for (std::size_t i = 0; i < pixels; ++i) {
      double sum = 0;
      for (std::size_t m = 0; m < static_cast<std::size_t>(grid.materials); ++m) {
        ASSERT_GE(weights[m * pixels + i], 0) << kind;
        sum += weights[m * pixels + i];
      }
      ASSERT_NEAR(sum, 1, 1e-6) << kind;
    }
  }
}

TEST(Layout, SeedsDecideTheNoise) {
  for (const std::string kind : {"stones", "veins", "layers", "mixing"}) {
    const Layout layout = make_layout(kind);
    EXPECT_EQ(make_weights(layout, grid_of(2, 1)), make_weights(layout, grid_of(2, 1))) << kind;
    EXPECT_NE(make_weights(layout, grid_of(2, 1)), make_weights(layout, grid_of(2, 2))) << kind;
  }
}

TEST(Layout, ChessboardAlternates) {
  const auto weights = make_weights(ChessboardLayout{.tile_mm = 5}, grid_of(2));  // 10 pixels
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 40; ++x)
      ASSERT_EQ(weights[static_cast<std::size_t>(y * 40 + x)],
                (x / 10 + y / 10) % 2 == 0 ? 1.f : 0.f);
}

// Twice the pixels at half the pitch show the same sample: 2 x 2 means agree with the coarse grid.
TEST(Layout, DoesNotDependOnThePitch) {
  const LayoutGrid coarse = grid_of(3);
  const LayoutGrid fine{
      .width = 80, .height = 60, .pixel_pitch_mm = 0.25, .materials = 3, .seed = 1};
  const auto a = make_weights(MixingLayout{}, coarse);
  const auto b = make_weights(MixingLayout{}, fine);
  for (std::size_t y = 0; y < 30; ++y)
    for (std::size_t x = 0; x < 40; ++x) {
      const std::size_t i = 2 * y * 80 + 2 * x;
      ASSERT_NEAR(a[y * 40 + x], 0.25f * (b[i] + b[i + 1] + b[i + 80] + b[i + 81]), 0.01f);
    }
}

TEST(Layout, SharesSteerTheAmounts) {
  LayersLayout layers{
      .thickness_mm = 0.5, .waviness_mm = 0, .irregularity = 0, .softness_mm = 0.05};
  layers.shares = {3, 1};
  EXPECT_NEAR(mean_weight(make_weights(layers, grid_of(2)), grid_of(2), 0), 0.75, 0.01);
  StonesLayout stones{.size_mm = 1, .coverage = 1, .gap_mm = 0};
  stones.shares = {0, 1};
  const auto weights = make_weights(stones, grid_of(3));
  EXPECT_EQ(mean_weight(weights, grid_of(3), 1), 0);
  EXPECT_GT(mean_weight(weights, grid_of(3), 2), 0.5);
  stones.coverage = 0;
  EXPECT_EQ(mean_weight(make_weights(stones, grid_of(3)), grid_of(3), 0), 1);
}

TEST(Layout, VeinsAreThin) {
  const auto area = [](double width_mm, double presence) {
    const VeinsLayout veins{
        .spacing_mm = 5, .width_mm = width_mm, .presence = presence, .octaves = 1};
    return mean_weight(make_weights(veins, grid_of(2)), grid_of(2), 1);
  };
  EXPECT_GT(area(0.5, 1), 0.01);
  EXPECT_NEAR(area(0.5, 1) / area(0.25, 1), 2, 0.2);
  EXPECT_LT(area(0.5, 0.2), area(0.5, 1));
}

TEST(Layout, ImagesAreMaps) {
  ImageLayout layout;
  layout.map = make_image(2, 1, 1);
  at(layout.map, 1, 0, 0) = 1;
  const auto mixed = make_weights(layout, grid_of(3));
  EXPECT_EQ(mixed[0], 1);                  // grey 0: the first material
  EXPECT_NEAR(mixed[1200 + 20], 1, 0.06);  // grey 1/2: the second of three
  EXPECT_EQ(mixed[2 * 1200 + 39], 1);      // grey 1: the last
  layout.thresholds = {0.5};
  const auto hard = make_weights(layout, grid_of(2));
  EXPECT_EQ(hard[19], 1);
  EXPECT_EQ(hard[1200 + 20], 1);
}

TEST(Layout, BadDescriptionsAreNamed) {
  const auto error = [](Document layout, int materials = 2, const ImageLoader& loader = {}) {
    return error_of([&] { read_layout(locate(std::move(layout), "/layout"), materials, loader); });
  };
  EXPECT_EQ(error(object({{"kind", "stnoes"}})),
            "s.json: /layout/kind: expected one of 'uniform', 'chessboard', 'stones', 'veins', "
            "'layers', 'mixing' or 'image', found 'stnoes' (did you mean 'stones'?)");
  EXPECT_EQ(
      error(object({{"kind", "chessboard"}, {"tilemm", 3}})),
      "s.json: /layout/tilemm: expected a known key, found 'tilemm' (did you mean 'tile_mm'?)");
  EXPECT_EQ(error(object({{"kind", "chessboard"}, {"tile_mm", 0}})),
            "s.json: /layout/tile_mm: expected a value in [0.0001, 1000], found 0");
  EXPECT_EQ(error(object({{"kind", "mixing"}, {"shares", array({1.0})}})),
            "s.json: /layout/shares: expected 2 shares, found 1");
  EXPECT_EQ(error(object({{"kind", "stones"}, {"shares", array({0.0})}})),
            "s.json: /layout/shares: expected a share above 0, found none");
  EXPECT_EQ(error(object({{"kind", "veins"}}), 1),
            "s.json: /layout/kind: expected at least two materials for this layout, or 'uniform', "
            "found veins with 1 material");
}

TEST(Layout, BadMapsAreNamed) {
  const auto error = [](Document layout, const ImageLoader& loader) {
    return error_of([&] { read_layout(locate(std::move(layout), "/layout"), 3, loader); });
  };
  const ImageLoader missing = [](const std::string& path) -> Image {
    throw Error({path, "", "a file", "none"});
  };
  const ImageLoader grey = [](const std::string&) { return make_image(4, 4, 1, 0.5f); };
  EXPECT_EQ(error(object({{"kind", "image"}, {"image", "map.png"}}), missing),
            "s.json: /layout/image: expected an image that can be read, found map.png: expected a "
            "file, found none");
  EXPECT_EQ(error(object({{"kind", "image"}}), grey),
            "s.json: /layout: expected the key 'image', found no such key");
  const Document unsorted =
      object({{"kind", "image"}, {"image", "map.png"}, {"thresholds", array({0.7, 0.2})}});
  EXPECT_EQ(error(unsorted, grey),
            "s.json: /layout/thresholds: expected thresholds that increase, found an array of 2");
}

}  // namespace
}  // namespace parian

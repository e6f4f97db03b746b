#include "app/studio/flat_zoom.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace parian {
namespace {

constexpr int columns = 72, rows = 64;
constexpr double width = 300, height = 350;

std::array<double, 2> on_map(const FlatZoom& zoom, double x, double y) {
  const FlatPlace place = place_flat(zoom, columns, rows, width, height);
  return {(x - place.x) / place.pixel, (y - place.y) / place.pixel};
}

TEST(FlatZoom, ShowsAllAtFirst) {
  const FlatPlace place = place_flat({}, columns, rows, width, height);
  EXPECT_DOUBLE_EQ(place.pixel * columns, width);
  EXPECT_NEAR(place.x, 0, 1e-9);
  EXPECT_NEAR(place.y, (height - place.pixel * rows) / 2, 1);
}

TEST(FlatZoom, WhatIsUnderThePointerStays) {
  FlatZoom zoom;
  const std::array at{100.0, 120.0};
  const auto seen = on_map(zoom, at[0], at[1]);
  for (const double factor : {1.2, 1.2, 1.5, 3.0, 1.4, 0.7}) {
    zoom = zoom_flat(zoom, factor, at[0], at[1], columns, rows, width, height);
    EXPECT_NEAR(on_map(zoom, at[0], at[1])[0], seen[0], 1e-9);
    EXPECT_NEAR(on_map(zoom, at[0], at[1])[1], seen[1], 1e-9);
  }
  EXPECT_NEAR(zoom.factor, 1.2 * 1.2 * 1.5 * 3 * 1.4 * 0.7, 1e-9);
  // Not beyond pixels of 64 x 64, and back to all of it.
  zoom = zoom_flat(zoom, 1e6, 10, 10, columns, rows, width, height);
  EXPECT_DOUBLE_EQ(place_flat(zoom, columns, rows, width, height).pixel, 64);
  EXPECT_EQ(zoom_flat(zoom, 1e-6, 290, 10, columns, rows, width, height), FlatZoom{});
}

TEST(FlatZoom, PansUpToTheBorders) {
  const FlatZoom zoom = zoom_flat({}, 8, 150, 170, columns, rows, width, height);
  const auto before = on_map(zoom, 50, 60);
  const FlatZoom panned = pan_flat(zoom, 30, -20, columns, rows, width, height);
  const auto after = on_map(panned, 80, 40);
  EXPECT_NEAR(after[0], before[0], 1e-9);
  EXPECT_NEAR(after[1], before[1], 1e-9);
  for (const double far : {1e5, -1e5}) {
    const FlatZoom moved = pan_flat(zoom, far, far, columns, rows, width, height);
    const auto middle = on_map(moved, width / 2, height / 2);
    EXPECT_NEAR(middle[0], far > 0 ? 0 : columns, 1e-9);
    EXPECT_NEAR(middle[1], far > 0 ? 0 : rows, 1e-9);
    // And back again at once.
    const FlatZoom back = pan_flat(moved, far > 0 ? -10 : 10, 0, columns, rows, width, height);
    EXPECT_NEAR(std::abs(on_map(back, width / 2, 0)[0] - middle[0]),
                10 / place_flat(moved, columns, rows, width, height).pixel, 1e-9);
  }
  // There is nothing to pan where all is seen.
  EXPECT_EQ(pan_flat({}, 50, 50, columns, rows, width, height), FlatZoom{});
}

}  // namespace
}  // namespace parian

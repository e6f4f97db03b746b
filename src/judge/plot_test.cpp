#include "judge/plot.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/test_errors.h"
#include "image/color.h"
#include "judge/canvas.h"
#include "judge/false_color.h"
#include "judge/test_tables.h"

namespace parian {
namespace {

using namespace testing_tables;

// How many pixels are redder than they are green.
int count_red(const Image& image) {
  int count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) count += at(image, x, y, 0) > at(image, x, y, 1) + 0.3f;
  return count;
}

TEST(Plot, TicksAreRoundNumbers) {
  EXPECT_EQ(plot_ticks(0, 12, false), (std::vector<double>{0, 2, 4, 6, 8, 10, 12}));
  EXPECT_EQ(plot_ticks(-0.5, 0.5, false).size(), 5u);
  const std::vector<double> decades = plot_ticks(1e-4, 20, true);
  ASSERT_EQ(decades.size(), 6u);
  EXPECT_DOUBLE_EQ(decades[1], 1e-3);
  const std::vector<double> steps = plot_ticks(1.5, 30, true);
  ASSERT_EQ(steps.size(), 4u);
  EXPECT_DOUBLE_EQ(steps[0], 2);
  EXPECT_EQ(format_tick(0.05), "0.05");
  EXPECT_EQ(format_tick(1e-5), "1e-5");
  EXPECT_EQ(format_tick(2e6), "2e6");
}

TEST(Plot, DrawsWhatIsFiniteAndSkipsTheRest) {
  Plot plot;
  plot.log_y = true;
  plot.series = {{"", {0, 1, 2, 3}, {nan, -1, 0, 5}, {1, 0, 0}, true, 9}};
  const int dot = count_red(draw_plot(plot));
  EXPECT_NEAR(dot, 3.14159 * 4.5 * 4.5, 16);
  plot.series[0].y = {nan, nan, nan, nan};
  EXPECT_EQ(count_red(draw_plot(plot)), 0);
}

TEST(Plot, LinesBreakAtMissingValues) {
  Plot plot;
  plot.series = {{"", {0, 1, 2, 3}, {1, 1, 1, 1}, {1, 0, 0}}};
  const int whole = count_red(draw_plot(plot));
  plot.series[0].y[1] = nan;
  EXPECT_NEAR(count_red(draw_plot(plot)) / static_cast<double>(whole), 1 / 3.0, 0.02);
}

TEST(Canvas, StrokesAndBoxesCoverTheirArea) {
  Image image = make_image(40, 20, 3, 0);
  const auto sum = [&] {
    double total = 0;
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 40; ++x) total += at(image, x, y, 1);
    return total;
  };
  fill_box(image, {2.5, 3.25, 6.75, 9.5}, {1, 1, 1});
  EXPECT_NEAR(sum(), 4.25 * 6.25, 1e-4);
  image = make_image(40, 20, 3, 0);
  draw_polyline(image, {{5, 10}, {15, 10}, {35, 10}}, 3, {1, 1, 1}, {0, 0, 40, 20});
  EXPECT_NEAR(sum(), 90, 9);
}

TEST(Canvas, TextHasAWidthAndAnyByteIsSafe) {
  EXPECT_EQ(text_width("ab", 2), 2 * text_width("ab", 1));
  Image image = make_image(30, 12, 3, 1);
  draw_text(image, {-20, -3}, std::string("\xff\n\x01 far outside of the image"), 2, {1, 0, 0});
  EXPECT_GT(count_red(image), 10);
}

TEST(FalseColor, LuminanceGrowsAndMissingIsGrey) {
  float last = -1;
  for (int i = 0; i <= 64; ++i) {
    const auto c = map_color(i / 64.0);
    EXPECT_GT(luminance(c[0], c[1], c[2]), last);
    last = luminance(c[0], c[1], c[2]);
  }
  Image values = make_image(2, 1, 1, nan);
  at(values, 1, 0, 0) = 9;
  const Image colored = false_color(values, 3);
  EXPECT_EQ(at(colored, 0, 0, 0), at(colored, 0, 0, 2));
  EXPECT_EQ(at(colored, 1, 0, 0), map_color(1)[0]);
  EXPECT_GT(draw_color_map(values, 3, 4, "error").width, 8);
}

TEST(PlotProfiles, ShowsDataAndModelOfThePixel) {
  BssrdfTable table = make_table(9, 8, 1, half_disc_offsets(3)), model = table;
  fill_random(table, 1);
  fill_random(model, 2);
  const Material map = make_profile_map(9, 8, 1, 1, {0, 1, 3}, -1);
  const auto t = make_slices(table, "t.h5"), m = make_slices(model);
  const auto images = plot_profiles(*t, *m, &map, {{4, 4}, {0, 0}}, 0);
  ASSERT_EQ(images.size(), 2u);
  EXPECT_GT(count_red(images[0]), 50);
  EXPECT_NE(images[0].values, plot_profiles(*t, *m, nullptr, {{4, 4}}, 0)[0].values);
  EXPECT_EQ(error_of([&] {
              plot_profiles(*t, *m, nullptr, {{9, 0}}, 0);
            }),
            "t.h5: pixel to plot: expected x in [0, 8], y in [0, 7], found (9, 0)");
}

}  // namespace
}  // namespace parian

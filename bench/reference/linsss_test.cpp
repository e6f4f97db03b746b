#include "bench/reference/linsss.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bench/reference/test_values.h"
#include "fit/test_tables.h"

namespace parian {
namespace {

TEST(Linsss, RecoversPlantedWeights) {
  BssrdfTable table = make_test_table(16, 14, 5, 1);
  const double sigma[2] = {0.5, 0.22 * 5};  // among the candidates
  const auto weight = random_values(2 * 16 * 14, 3);
  for (std::size_t i = 0; i < table.header.offsets.size(); ++i) {
    const Offset d = table.header.offsets[i];
    const PixelRange range = pairs_in_grid(table.header, d);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        double r = 0;
        for (std::size_t h = 0; h < 2; ++h)
          r += 0.5 *
               static_cast<double>(
                   weight[h * 224 + static_cast<std::size_t>(y * 16 + x)] +
                   weight[h * 224 + static_cast<std::size_t>((y + d.dy) * 16 + x + d.dx)]) *
               std::exp(-0.5 * std::pow(length_px(d) / sigma[h], 2));
        slice_of(table, 0, static_cast<int>(i))[y * 16 + x] = static_cast<float>(r + 1e-9);
      }
  }
  remove_pairs(table, 0.05, 3);
  LinsssParams params;
  params.gaussians = 2;
  params.iterations = 200;
  const LinsssChannel channel = fit_linsss(table, params)[0];
  EXPECT_DOUBLE_EQ(channel.sigma_px[0], sigma[0]);
  EXPECT_DOUBLE_EQ(channel.sigma_px[1], sigma[1]);
  EXPECT_LT(std::sqrt(channel.objective.back() / 224), 0.01);
  expect_not_rising(channel.objective, 0);
}

// Sum over pixels of the squared relative error, straight from the slices.
double relative_error2(const BssrdfTable& table, const SliceSource& model) {
  const std::size_t pixels = table.header.pixels();
  std::vector<double> error(pixels, 0.0), energy(pixels, 0.0);
  std::vector<float> slice(pixels);
  for (int c = 0; c < table.header.channels; ++c)
    for (std::size_t i = 0; i < table.header.offsets.size(); ++i) {
      model.read_slice(c, static_cast<int>(i), slice.data());
      const Offset d = table.header.offsets[i];
      const std::size_t shift =
          static_cast<std::size_t>(d.dy * table.header.width + d.dx);  // may wrap around
      for (std::size_t x = 0; x < pixels; ++x) {
        const auto r = static_cast<double>(slice_of(table, c, static_cast<int>(i))[x]);
        if (std::isnan(r)) continue;
        const double e = std::pow(static_cast<double>(slice[x]) - r, 2);
        for (const std::size_t at : {x, x + shift}) {
          error[at] += e;
          energy[at] += r * r;
          if (d == Offset{}) break;
        }
      }
    }
  double sum = 0;
  for (std::size_t x = 0; x < pixels; ++x) sum += error[x] / energy[x];
  return sum;
}

TEST(Linsss, MinimisesTheRelativeErrorOfThePixels) {
  BssrdfTable table = make_test_table(13, 12, 4, 3);
  remove_pairs(table, 0.1, 3);
  LinsssParams params;
  params.gaussians = 4;
  double objective = 0;
  for (const LinsssChannel& channel : fit_linsss(table, params)) {
    expect_not_rising(channel.objective, 0);
    objective += channel.objective.back();
  }
  const Rival rival = compress_linsss(table, 4 * 4 * 3 * 13 * 12);
  EXPECT_EQ(rival.bytes, 4u * 4 * 3 * 13 * 12);
  EXPECT_NEAR(relative_error2(table, *rival.slices), objective, 1e-3 * objective);
  EXPECT_LT(objective / (13 * 12), 0.01);
}

}  // namespace
}  // namespace parian

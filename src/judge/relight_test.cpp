#include "judge/relight.h"

#include <gtest/gtest.h>

#include <string>

#include "base/parallel.h"
#include "base/test_errors.h"
#include "judge/row_sums.h"
#include "judge/test_tables.h"

namespace parian {
namespace {

using namespace testing_tables;

Image make_noise(int width, int height, int channels, std::uint64_t seed) {
  Image image = make_image(width, height, channels);
  Rng rng = make_rng(seed);
  for (float& value : image.values) value = static_cast<float>(sample_uniform(rng));
  return image;
}

double inner(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    sum += static_cast<double>(a.values[i]) * b.values[i];
  return sum;
}

TEST(Relight, FurnaceOfAHomogeneousTable) {
  BssrdfTable table = make_table(11, 11, 3, half_disc_offsets(4), 0.5);
  double sum = 0;
  for (std::size_t d = 0; d < table.header.offsets.size(); ++d) {
    const double value = std::exp(-length_px(table.header.offsets[d]));
    sum += value * 0.25 * pair_count(table.header, table.header.offsets[d]);
    for (int c = 0; c < 3; ++c)
      std::fill_n(slice_of(table, c, static_cast<int>(d)), 121, static_cast<float>(value));
  }
  const Image flat = relight(*make_slices(table), {make_image(11, 11, 1, 1)})[0];
  EXPECT_EQ(flat.channels, 3);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(at(flat, 5, 5, c), sum, 1e-6 * sum);
  EXPECT_LT(at(flat, 0, 0, 0), 0.5 * sum);
  const RowSums rows = measure_row_sums(*make_slices(table));
  EXPECT_NEAR(rows.max, sum, 1e-6 * sum);
  EXPECT_EQ(rows.albedo.values, flat.values);
}

TEST(Relight, EqualsTheSumOverPairs) {
  BssrdfTable table = make_table(7, 6, 3, half_disc_offsets(3), 2);
  fill_random(table, 1, 0.2);
  const Image light = make_noise(7, 6, 3, 2);
  std::vector<double> expected(light.values.size());
  for (int c = 0; c < 3; ++c)
    for (std::size_t d = 0; d < table.header.offsets.size(); ++d) {
      const Offset o = table.header.offsets[d];
      for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 7; ++x) {
          const float value = value_at(table, c, static_cast<int>(d), x, y);
          if (std::isnan(value)) continue;
          const int px = x + o.dx, py = y + o.dy;
          expected[static_cast<std::size_t>((y * 7 + x) * 3 + c)] +=
              4.0 * value * at(light, px, py, c);
          if (o != Offset{})
            expected[static_cast<std::size_t>((py * 7 + px) * 3 + c)] +=
                4.0 * value * at(light, x, y, c);
        }
    }
  const Image flat = relight(*make_slices(table), {light})[0];
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(flat.values[i], expected[i], 1e-6 * (1 + expected[i]));
}

TEST(Relight, IsLinearAndSymmetric) {
  BssrdfTable table = make_table(9, 7, 1, half_disc_offsets(3));
  fill_random(table, 3, 0.1);
  const Image f = make_noise(9, 7, 1, 4), g = make_noise(9, 7, 1, 5);
  Image both = f;
  for (std::size_t i = 0; i < both.values.size(); ++i)
    both.values[i] = 2 * f.values[i] + g.values[i];
  const std::vector<Image> lit = relight(*make_slices(table), {f, g, both});
  for (std::size_t i = 0; i < both.values.size(); ++i)
    EXPECT_NEAR(lit[2].values[i], 2 * lit[0].values[i] + lit[1].values[i], 1e-5);
  EXPECT_NEAR(inner(f, lit[1]), inner(lit[0], g), 1e-5 * inner(lit[0], g));
}

TEST(Relight, LightLeavesAtXWhereBothDirectionsAreListed) {
  BssrdfTable table = make_table(5, 4, 1, half_disc_offsets(1));
  table.header.symmetric = false;
  table.header.offsets = disc_offsets(1);
  table.reflectance.assign(table.header.offsets.size() * 20, 0);
  for (auto& value : table.reflectance) value = nan;
  slice_of(table, 0, find_offset(table.header, {1, 0}))[1 * 5 + 2] =
      3;  // enters (3,1), leaves (2,1)
  const Image flat = relight(*make_slices(table), {make_image(5, 4, 1, 1)})[0];
  EXPECT_EQ(at(flat, 2, 1, 0), 3);
  EXPECT_EQ(at(flat, 3, 1, 0), 0);
}

TEST(Relight, SameBitsForAnyNumberOfThreads) {
  BssrdfTable table = make_table(19, 17, 3, half_disc_offsets(6));
  fill_random(table, 6);
  const Image light = make_noise(19, 17, 1, 7);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return relight(*make_slices(table), {light})[0].values;
  };
  EXPECT_EQ(run(1), run(4));
}

TEST(Relight, FlatLightsHaveTheirShapes) {
  const auto total = [](const Image& image) {
    double sum = 0;
    for (const float value : image.values) sum += value;
    return sum;
  };
  EXPECT_EQ(total(make_flat_light(FlatLight::uniform, 60, 40, 1)), 2400);
  EXPECT_EQ(total(make_flat_light(FlatLight::line, 60, 40, 1)), 120);
  EXPECT_EQ(at(make_flat_light(FlatLight::line, 60, 40, 1), 31, 39, 0), 1);
  EXPECT_NEAR(total(make_flat_light(FlatLight::disc, 120, 150, 3)), 3 * 3.14159 * 400, 40);
}

TEST(Relight, NamesWhatIsWrongWithALight) {
  BssrdfTable table = make_table(3, 2, 3, {{0, 0}});
  const auto error_of = [&](const Image& light) {
    return parian::error_of([&] { relight(*make_slices(table), {light}); });
  };
  EXPECT_EQ(error_of(make_image(2, 2, 1)), "light 0: expected 3 x 2 pixels, found 2 x 2");
  EXPECT_EQ(error_of(make_image(3, 2, 2)), "light 0: expected 1 or 3 channels, found 2");
  EXPECT_EQ(error_of(make_image(3, 2, 1, nan)), "light 0: expected finite values, found nan");
}

TEST(RowSums, FindsTheLargestRow) {
  BssrdfTable table = make_table(3, 2, 1, {{0, 0}, {1, 0}});
  table.reflectance.assign(12, 0.25f);
  slice_of(table, 0, 1)[3] = 0.875f;
  const RowSums rows = measure_row_sums(*make_slices(table));
  EXPECT_EQ(rows.max, 1.375);
  EXPECT_EQ(rows.x, 1);
  EXPECT_EQ(rows.y, 1);
  EXPECT_EQ(rows.above_one, 2u);
}

}  // namespace
}  // namespace parian

// Tables with a noise model in the compression.
#include <gtest/gtest.h>

#include <cmath>

#include "compress/compress.h"
#include "compress/table_residual.h"
#include "compress/test_materials.h"
#include "fit/fit.h"
#include "fit/noise_kernels.h"
#include "judge/compare.h"

namespace parian {
namespace {

void set_noise(BssrdfTable& table, double gain, double floor) {
  table.header.noise_gain.assign(static_cast<std::size_t>(table.header.channels), gain);
  table.header.noise_floor.assign(static_cast<std::size_t>(table.header.channels), floor);
}

// Sums take all values; the linear part of a pair is worth s^2 / (s^2 + v).
TEST(TableResidual, NoiseCountsForWhatItIsWorth) {
  const ProfileMap map = make_test_map(9, 7, 1, 2);
  BssrdfTable table = make_test_table(map, 0.1);
  const std::vector<float> weight(map.pixels(), 1.0f);
  const TableResidual plain = measure_residual(*make_slices(table), map, weight);
  set_noise(table, 0, 0);
  EXPECT_EQ(measure_residual(*make_slices(table), map, weight).linear, plain.linear);
  // Only pairs of a pixel with itself: v is that of its P(0).
  BssrdfTable own = table;
  own.header.offsets = {Offset{}};
  own.reflectance.resize(map.pixels());
  const TableResidual before = measure_residual(*make_slices(own), map, weight);
  constexpr double gain = 0.02, floor = 0.03;
  set_noise(own, gain, floor);
  own.reflectance[4] = -0.01f;
  own.reflectance[5] = 0;
  const TableResidual after = measure_residual(*make_slices(own), map, weight);
  for (std::size_t i = 0; i < map.pixels(); ++i) {
    const double model = std::exp(static_cast<double>(map.log_profile[i]));
    if (i == 4 || i == 5) {
      EXPECT_NEAR(after.albedo[i], static_cast<double>(own.reflectance[i]) - model, 1e-6);
      continue;
    }
    EXPECT_EQ(after.albedo[i], before.albedo[i]);
    const double v = (floor * floor + gain * model) / (model * model);
    const double s2 = std::pow(static_cast<double>(model_error), 2);
    EXPECT_NEAR(after.linear[i], before.linear[i] * s2 / (s2 + v),
                1e-4 * std::abs(before.linear[i]));
  }
}

// A blend made from a noisy table is closer to the clean table than the noisy one is, whatever is
// minimised.
TEST(Compress, NoiseOfTheTableIsMostlyLeftBehind) {
  const ProfileMap truth = make_test_map(24, 20, 1);
  const BssrdfTable clean = make_test_table(truth);
  BssrdfTable noisy = clean;
  set_noise(noisy, 2e-3, 2e-3);
  Rng rng = make_rng(31);
  double zeros = 0, squares = 0, noise = 0;
  for (float& value : noisy.reflectance) {
    if (std::isnan(value)) continue;
    const auto exact = static_cast<double>(value);
    value =
        static_cast<float>(2e-3 * sample_poisson(rng, exact / 2e-3) + 2e-3 * sample_normal(rng));
    zeros += value <= 0;
    squares += exact * exact;
    noise += std::pow(static_cast<double>(value) - exact, 2);
  }
  EXPECT_GT(zeros, 50);
  const double relative_noise = std::sqrt(noise / squares);
  const auto error_of = [&](const BssrdfTable& table, Objective objective) {
    const auto source = make_slices(table);
    CompressParams params;
    params.bases = 32;
    params.objective = objective;
    const ProfileMap map = fit_profiles(*source, {}).map;
    const Material blend = compress_profiles(map, source.get(), params);
    return compare(*make_slices(clean), *make_slices(blend, clean.header));
  };
  for (const Objective objective : {Objective::balanced, Objective::paper, Objective::albedo}) {
    const CompareReport from_clean = error_of(clean, objective),
                        from_noisy = error_of(noisy, objective);
    EXPECT_LT(from_clean.relative_error.mean, 0.01);
    EXPECT_LT(from_noisy.relative_error.mean, 0.7 * relative_noise) << static_cast<int>(objective);
    EXPECT_LT(from_noisy.albedo_error_mean, 0.025) << static_cast<int>(objective);
  }
}

}  // namespace
}  // namespace parian

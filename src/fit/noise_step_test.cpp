#include "fit/noise_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fit/test_tables.h"
#include "material/test_noise.h"

namespace parian {
namespace {

constexpr double s2 = static_cast<double>(model_error) * static_cast<double>(model_error);

// Weight and residual as noise_step.h states them.
struct Residual {
  double w = 0, z = 0;
};
Residual stated_residual(double value, double model, double gain, double floor) {
  const double v = (floor * floor + gain * model) / (model * model);
  const double least = std::min(0.25, std::max(1e-6, 25 * v)), t = value / model;
  const double logarithm = t > least ? std::log(t) : std::log(least) + (t - least) / least;
  const double c = 1 / (1 + std::pow(v / 0.05, 2));
  return {s2 / (s2 + v), (1 - c) * (t - 1) + c * (logarithm + v / 2)};
}

TEST(NoiseResiduals, AreAsStated) {
  Rng rng = make_rng(3);
  for (const auto& [gain, floor] : {std::pair{0.0, 0.0}, {1e-3, 0.0}, {0.0, 1e-2}, {2e-4, 1e-3}}) {
    std::vector<float> value, log_model, weight(600), residual(600);
    for (int i = 0; i < 600; ++i) {
      const double model = std::exp(-12 * sample_uniform(rng));
      const double noise = std::sqrt(floor * floor + gain * model) + 0.3 * model;
      log_model.push_back(static_cast<float>(std::log(model)));
      value.push_back(static_cast<float>(model + noise * sample_normal(rng)));
    }
    value[5] = std::numeric_limits<float>::quiet_NaN();
    value[6] = 0;
    eval_noise_residuals(value.data(), log_model.data(),
                         {static_cast<float>(floor), static_cast<float>(gain)}, 600, weight.data(),
                         residual.data());
    EXPECT_EQ(weight[5], 0);
    EXPECT_EQ(residual[5], 0);
    for (std::size_t i = 0; i < 600; ++i) {
      if (i == 5) continue;
      const Residual stated = stated_residual(
          static_cast<double>(value[i]), std::exp(static_cast<double>(log_model[i])), gain, floor);
      EXPECT_NEAR(weight[i], stated.w, 1e-5 * stated.w);
      EXPECT_NEAR(residual[i], stated.z, 2e-5 * (1 + std::abs(stated.z)));
    }
  }
  // Nothing overflows.
  const float log_model[] = {-1e4f, -80, 80, 1e4f}, value[] = {1, -1, 0, 1e30f};
  float weight[4], residual[4];
  eval_noise_residuals(value, log_model, {1, 1}, 4, weight, residual);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(std::isfinite(weight[i] * residual[i]));
}

// The mean residual of counts about their own mean is 0, from a hundredth of a photon to a million.
TEST(NoiseResiduals, HaveMeanZeroAtTheTruth) {
  Rng rng = make_rng(8);
  constexpr int n = 40'000;
  for (const double photons : {0.01, 0.3, 1.0, 4.0, 20.0, 60.0, 400.0, 1e6}) {
    std::vector<float> value(n), log_model(n), weight(n), residual(n);
    for (int i = 0; i < n; ++i) {
      value[static_cast<std::size_t>(i)] = static_cast<float>(sample_poisson(rng, photons));
      log_model[static_cast<std::size_t>(i)] = static_cast<float>(std::log(photons));
    }
    eval_noise_residuals(value.data(), log_model.data(), {0, 1}, n, weight.data(), residual.data());
    double sum = 0;
    for (float z : residual) sum += static_cast<double>(z);
    // Five standard errors; where half of it is logarithmic, -0.4 v^2 / 2 remains of its bias.
    EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(photons * n) + (photons < 100 ? 6e-4 : 0.0)) << photons;
  }
}

NoiseStep make_test_step(const BssrdfTable& table, std::size_t knots, std::uint64_t seed) {
  NoiseStep step;
  step.noise = {static_cast<float>(table.header.noise_floor[0]),
                static_cast<float>(table.header.noise_gain[0])};
  Rng rng = make_rng(seed);
  for (std::size_t k = 0; k < knots; ++k)
    for (std::size_t i = 0; i < table.header.pixels(); ++i)
      step.field.push_back(
          static_cast<float>(-2 - 0.4 * static_cast<double>(k) + 0.5 * sample_normal(rng)));
  for (Offset d : table.header.offsets) step.phi.push_back(1 / (1 + length_px(d)));
  return step;
}

std::vector<double> right_hand_side_at(const BssrdfTable& table, const ReducedParams& params,
                                       const NoiseStep& step) {
  ReducedParams about = params;
  about.weight = PairWeight::uniform;
  about.about = &step;
  return make_reduced_system(*make_slices(table), 0, about).right_hand_side;
}

// Pair by pair in double precision, from the statement alone.
std::vector<double> summed_over_pairs(const BssrdfTable& table, const ReducedParams& params,
                                      const NoiseStep& step) {
  const TableHeader& header = table.header;
  std::vector<double> sums(step.field.size());
  for (std::size_t i = 0; i < header.offsets.size(); ++i) {
    const Offset d = header.offsets[i];
    const double r = length_px(d);  // knots lie a pixel apart
    const auto k = std::min(static_cast<std::size_t>(r), params.knots_mm.size() - 2);
    const double f = r - static_cast<double>(k);
    const PixelRange range = pairs_in_grid(header, d);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const auto from = static_cast<std::size_t>(y * header.width + x);
        const auto to = static_cast<std::size_t>((y + d.dy) * header.width + x + d.dx);
        const float value = slice_of(table, 0, static_cast<int>(i))[from];
        if (std::isnan(value) || is_held_out(params.hold_out, x, y, d)) continue;
        const auto at = [&](std::size_t pixel) {
          return (1 - f) * static_cast<double>(step.field[k * header.pixels() + pixel]) +
                 f * static_cast<double>(step.field[(k + 1) * header.pixels() + pixel]);
        };
        const Residual pair =
            stated_residual(static_cast<double>(value), std::exp((at(from) + at(to)) / 2),
                            header.noise_gain[0], header.noise_floor[0]);
        const double g = pair_count(header, d) * step.phi[i] * pair.w * 2 * pair.z;
        for (const std::size_t end : {from, to}) {
          sums[k * header.pixels() + end] += (1 - f) * g;
          sums[(k + 1) * header.pixels() + end] += f * g;
        }
      }
  }
  return sums;
}

TEST(NoiseStep, RightHandSideIsSummedOverPairs) {
  for (const bool symmetric : {true, false})
    for (const double missing : {0.0, 0.1, 0.8}) {
      BssrdfTable table = make_test_table(9, 8, 3, 1, symmetric);
      add_noise(table, 3e-3, 2e-3, 4);
      remove_pairs(table, missing, 5);
      ReducedParams params = make_test_params(3);
      params.hold_out = {missing, 2};
      const NoiseStep step = make_test_step(table, 4, 6);
      const std::vector<double> system = right_hand_side_at(table, params, step),
                                pairs = summed_over_pairs(table, params, step);
      for (std::size_t i = 0; i < pairs.size(); ++i)
        EXPECT_NEAR(system[i], pairs[i], 1e-4 * (1 + std::abs(pairs[i])));
    }
}

// A field is a gradient where its derivatives are symmetric.
TEST(NoiseStep, RightHandSideIsAGradient) {
  BssrdfTable table = make_test_table(8, 7, 3);
  add_noise(table, 3e-3, 2e-3, 4);
  const ReducedParams params = make_test_params(3);
  NoiseStep step = make_test_step(table, 4, 6);
  constexpr float h = 0.02f;
  const auto derivative = [&](std::size_t i) {
    NoiseStep moved = step;
    moved.field[i] += h;
    std::vector<double> up = right_hand_side_at(table, params, moved);
    moved.field[i] -= 2 * h;
    const std::vector<double> down = right_hand_side_at(table, params, moved);
    for (std::size_t j = 0; j < up.size(); ++j) up[j] = (up[j] - down[j]) / (2.0 * h);
    return up;
  };
  const std::size_t places[] = {9, 10, 66, 73, 130};
  std::vector<std::vector<double>> rows;
  for (std::size_t i : places) rows.push_back(derivative(i));
  double largest = 0;
  for (std::size_t a = 0; a < 5; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      EXPECT_NEAR(rows[a][places[b]], rows[b][places[a]], 2e-3);
      largest = std::max(largest, std::abs(rows[a][places[b]]));
    }
  EXPECT_GT(largest, 0.1);
}

}  // namespace
}  // namespace parian

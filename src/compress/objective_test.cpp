#include <gtest/gtest.h>

#include <cmath>

#include "compress/log_objective.h"
#include "compress/pair_objective.h"
#include "compress/test_materials.h"

namespace parian {
namespace {

// ln P of a field at distance r.
double eval_field(const ProfileMap& map, const std::vector<float>& field, int channel,
                  std::size_t pixel, double r) {
  const auto& knots = map.knots_mm;
  std::size_t k = 0;
  while (k + 2 < knots.size() && knots[k + 1] <= r) ++k;
  const double w = (r - knots[k]) / (knots[k + 1] - knots[k]);
  const auto at = [&](std::size_t knot) {
    return static_cast<double>(
        field[(static_cast<std::size_t>(channel) * knots.size() + knot) * map.pixels() + pixel]);
  };
  return (1 - w) * at(k) + w * at(k + 1);
}

// Calls body(channel, x, y, r) for all ordered pairs within the last knot.
template <typename Body>
void for_pairs(const ProfileMap& map, Body body) {
  for (int c = 0; c < map.channels; ++c)
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x)
        for (int v = 0; v < map.height; ++v)
          for (int u = 0; u < map.width; ++u) {
            const double r = std::hypot(u - x, v - y) * map.pixel_pitch_mm;
            if (r <= map.knots_mm.back() * (1 + 1e-9))
              body(c, static_cast<std::size_t>(y * map.width + x),
                   static_cast<std::size_t>(v * map.width + u), r, Offset{u - x, v - y});
          }
}

double eval_pair(const ProfileMap& map, const std::vector<float>& field, int c, std::size_t x,
                 std::size_t y, double r) {
  return std::exp(0.5 * (eval_field(map, field, c, x, r) + eval_field(map, field, c, y, r)));
}

struct Sums {
  std::vector<double> squared, energy, albedo, reference;
};

// Against a table's values, or the map's own where `table` is null.
Sums sum_pairs(const ProfileMap& map, const std::vector<float>& field, const BssrdfTable* table) {
  const std::size_t channels = static_cast<std::size_t>(map.channels);
  Sums sums{std::vector<double>(map.pixels(), 0.0), std::vector<double>(map.pixels(), 0.0),
            std::vector<double>(channels * map.pixels(), 0.0),
            std::vector<double>(channels * map.pixels(), 0.0)};
  const std::vector<float> own(map.log_profile.begin(), map.log_profile.end());
  for_pairs(map, [&](int c, std::size_t x, std::size_t y, double r, Offset d) {
    const double model = eval_pair(map, field, c, x, y, r);
    const double target = eval_pair(map, own, c, x, y, r);
    double value = target;
    if (table != nullptr) {
      const int index = find_offset(table->header, d);
      const int back = find_offset(table->header, {-d.dx, -d.dy});
      value = static_cast<double>(index >= 0 ? slice_of(*table, c, index)[x]
                                             : slice_of(*table, c, back)[y]);
    }
    sums.squared[x] += (model - value) * (model - value);
    sums.energy[x] += target * target;
    sums.albedo[static_cast<std::size_t>(c) * map.pixels() + x] += model;
    sums.reference[static_cast<std::size_t>(c) * map.pixels() + x] += value;
  });
  return sums;
}

double eval_plainly(const ProfileMap& map, const std::vector<float>& field,
                    const PixelWeights& weights, const BssrdfTable* table) {
  const Sums sums = sum_pairs(map, field, table);
  double value = 0;
  for (std::size_t x = 0; x < map.pixels(); ++x) {
    value += static_cast<double>(weights.relative[x]) * sums.squared[x] / sums.energy[x];
    double miss = 0, norm = 0;
    for (std::size_t i = x; i < sums.albedo.size(); i += map.pixels()) {
      miss += (sums.albedo[i] - sums.reference[i]) * (sums.albedo[i] - sums.reference[i]);
      norm += sums.reference[i] * sums.reference[i];
    }
    value += static_cast<double>(weights.albedo[x]) * miss / norm;
  }
  return value;
}

PixelWeights make_weights(const ProfileMap& map) {
  PixelWeights weights;
  Rng rng = make_rng(4);
  for (std::size_t x = 0; x < map.pixels(); ++x) {
    weights.relative.push_back(static_cast<float>(0.5 + sample_uniform(rng)));
    weights.albedo.push_back(static_cast<float>(0.5 + sample_uniform(rng)));
  }
  return weights;
}

std::vector<float> make_field(const ProfileMap& map, double noise) {
  std::vector<float> field(map.log_profile.begin(), map.log_profile.end());
  Rng rng = make_rng(6);
  for (float& value : field) value += static_cast<float>(noise * sample_normal(rng));
  return field;
}

TEST(PairObjective, EqualsThePlainSumOverPairs) {
  const ProfileMap map = make_test_map(9, 7);
  const PixelWeights weights = make_weights(map);
  const BlendObjective objective = make_pair_objective(map, test_offsets(map), weights);
  for (double noise : {0.01, 0.3}) {
    const std::vector<float> field = make_field(map, noise);
    const double plain = eval_plainly(map, field, weights, nullptr);
    EXPECT_NEAR(objective.eval(field.data(), nullptr, nullptr), plain, 1e-5 * plain);
  }
  EXPECT_NEAR(objective.eval(map.log_profile.data(), nullptr, nullptr), 0, 1e-9);
}

TEST(PairObjective, ReportsThePixelsErrors) {
  const ProfileMap map = make_test_map(9, 7);
  const std::vector<float> field = make_field(map, 0.1);
  PixelErrors errors;
  make_pair_objective(map, test_offsets(map), make_weights(map))
      .eval(field.data(), nullptr, &errors);
  const Sums sums = sum_pairs(map, field, nullptr);
  for (std::size_t x = 0; x < map.pixels(); ++x)
    EXPECT_NEAR(static_cast<double>(errors.relative[x]), sums.squared[x] / sums.energy[x],
                1e-4 * sums.squared[x] / sums.energy[x]);
}

// Directional derivatives by central differences.
void expect_gradient(const BlendObjective& objective, const std::vector<float>& field,
                     double tolerance) {
  std::vector<float> gradient(field.size());
  objective.eval(field.data(), gradient.data(), nullptr);
  Rng rng = make_rng(7);
  for (int trial = 0; trial < 6; ++trial) {
    std::vector<float> ahead = field, behind = field;
    double slope = 0, norm = 0;
    constexpr double step = 2e-3;
    for (std::size_t i = 0; i < field.size(); ++i) {
      const double direction = sample_normal(rng);
      ahead[i] += static_cast<float>(step * direction);
      behind[i] -= static_cast<float>(step * direction);
      slope += static_cast<double>(gradient[i]) * direction;
      norm += static_cast<double>(gradient[i]) * static_cast<double>(gradient[i]);
    }
    const double difference = (objective.eval(ahead.data(), nullptr, nullptr) -
                               objective.eval(behind.data(), nullptr, nullptr)) /
                              (2 * step);
    EXPECT_NEAR(slope, difference, tolerance * std::sqrt(norm)) << trial;
  }
}

TEST(PairObjective, GradientIsTheDerivative) {
  const ProfileMap map = make_test_map(9, 7);
  const BssrdfTable table = make_test_table(map, 0.1);
  const auto source = make_slices(table);
  for (const SliceSource* given :
       {static_cast<const SliceSource*>(nullptr), static_cast<const SliceSource*>(source.get())})
    expect_gradient(make_pair_objective(map, test_offsets(map), make_weights(map), given),
                    make_field(map, 0.1), 2e-3);
}

// Near the map, F with the table is the true error against the table.
TEST(PairObjective, TakesInWhatTheMapMissesOfItsTable) {
  const ProfileMap map = make_test_map(9, 7);
  const BssrdfTable table = make_test_table(map, 0.1);
  const auto source = make_slices(table);
  const PixelWeights weights = make_weights(map);
  const BlendObjective with = make_pair_objective(map, test_offsets(map), weights, source.get());
  const double at_map = eval_plainly(map, make_field(map, 0), weights, &table);
  EXPECT_NEAR(with.eval(map.log_profile.data(), nullptr, nullptr), at_map, 1e-4 * at_map);
  const std::vector<float> field = make_field(map, 0.05);
  const double plain = eval_plainly(map, field, weights, &table);
  EXPECT_NEAR(with.eval(field.data(), nullptr, nullptr), plain, 0.01 * plain);
}

// F(p + delta) <= F(p) + g delta + 1/2 delta D delta, close to the target, for the objective whose
// D is a bound there.
// `tolerance`: part that higher orders may add.
void expect_bound(const BlendObjective& objective, const std::vector<float>& field, double size,
                  double tolerance) {
  std::vector<float> gradient(field.size());
  const double value = objective.eval(field.data(), gradient.data(), nullptr);
  const RowShape& shape = objective.shape;
  Rng rng = make_rng(8);
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<float> step(field.size()), moved = field;
    for (std::size_t i = 0; i < field.size(); ++i) {
      // Smooth steps couple all pixels, rough ones hardly any.
      step[i] = static_cast<float>(size * (trial % 2 == 0 ? 1 : sample_normal(rng)));
      moved[i] += step[i];
    }
    const AlignedVector<float> rows = make_rows(shape, step.data());
    double bound = value;
    for (std::size_t i = 0; i < field.size(); ++i)
      bound += static_cast<double>(gradient[i]) * static_cast<double>(step[i]);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      bound += 0.5 * static_cast<double>(objective.metric.diagonal[i] * rows[i] * rows[i]);
      if (i + 1 < rows.size())
        bound += static_cast<double>(objective.metric.coupling[i] * rows[i] * rows[i + 1]);
    }
    EXPECT_LE(objective.eval(moved.data(), nullptr, nullptr), bound + tolerance * std::abs(bound))
        << trial;
  }
}

TEST(PairObjective, MetricBoundsTheCurvatureNearTheTarget) {
  const ProfileMap map = make_test_map(9, 7);
  expect_bound(make_pair_objective(map, test_offsets(map), make_weights(map)), make_field(map, 0),
               0.01, 0.02);
}

std::vector<ReducedSystem> make_systems(const ProfileMap& map, const SliceSource& table) {
  ReducedParams params;
  params.knots_mm = map.knots_mm;
  params.lambda = 0;
  std::vector<ReducedSystem> systems;
  systems.reserve(static_cast<std::size_t>(map.channels));
  for (int c = 0; c < map.channels; ++c) systems.push_back(make_reduced_system(table, c, params));
  return systems;
}

TEST(LogObjective, EqualsThePlainSumOverOrderedPairs) {
  const ProfileMap map = make_test_map(9, 7);
  const BssrdfTable table = make_test_table(map, 0.1);
  const BlendObjective objective = make_log_objective(make_systems(map, *make_slices(table)));
  const std::vector<float> field = make_field(map, 0.2);
  double plain = 0;
  for_pairs(map, [&](int c, std::size_t x, std::size_t y, double r, Offset d) {
    const int index = find_offset(table.header, d);
    const int back = find_offset(table.header, {-d.dx, -d.dy});
    const float value = index >= 0 ? slice_of(table, c, index)[x] : slice_of(table, c, back)[y];
    const double residual = eval_field(map, field, c, x, r) + eval_field(map, field, c, y, r) -
                            2 * std::log(static_cast<double>(value));
    const double px = r / map.pixel_pitch_mm;
    plain += 0.5 / (1 + px * px) * residual * residual;
  });
  EXPECT_NEAR(objective.eval(field.data(), nullptr, nullptr), plain, 1e-5 * plain);
  expect_gradient(objective, field, 2e-3);
  expect_bound(objective, field, 0.5, 1e-5);
}

}  // namespace
}  // namespace parian

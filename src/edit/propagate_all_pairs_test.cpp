#include "edit/propagate_all_pairs.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "base/parallel.h"
#include "base/random.h"
#include "base/test_errors.h"

namespace parian {
namespace {

Features random_features(int width, int height, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  std::vector<float> raw(static_cast<std::size_t>(width * height * 2));
  for (float& v : raw) v = static_cast<float>(sample_uniform(rng));
  return make_features(width, height, 2, raw);
}

const std::vector<StrokePixel> some_strokes = {
    {3, 1, 0}, {17, 0.5F, 0}, {40, 1, 1}, {41, 1, 1}, {77, 0.8F, 2}};

double similarity(const Features& f, std::size_t a, std::size_t b, const AllPairsParams& params) {
  double exponent = feature_distance_squared(f, a, b) / params.sigma;
  const auto width = static_cast<std::size_t>(f.width);
  const double x = static_cast<double>(a % width) - static_cast<double>(b % width);
  const double y = static_cast<double>(a / width) - static_cast<double>(b / width);
  const double range = params.sigma_space * std::hypot(f.width, f.height);
  if (range > 0) exponent += (x * x + y * y) / (range * range);
  return std::exp(-exponent);
}

// The system of AppProp from its definition.
Eigen::MatrixXd solve_dense(const Features& f, const std::vector<StrokePixel>& strokes, int count,
                            const AllPairsParams& params) {
  const auto n = static_cast<Eigen::Index>(f.pixels());
  Eigen::MatrixXd z(n, n), source = Eigen::MatrixXd::Zero(n, count);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      z(i, j) = similarity(f, static_cast<std::size_t>(i), static_cast<std::size_t>(j), params);
  double total = 0;
  for (const StrokePixel& p : strokes) {
    source(p.pixel, p.stroke) += static_cast<double>(p.weight);
    total += static_cast<double>(p.weight);
  }
  const double lambda = params.lambda > 0 ? params.lambda : total / static_cast<double>(n);
  const Eigen::MatrixXd b = z * source;
  Eigen::MatrixXd m = -2 * lambda * z;
  m.diagonal() += b.rowwise().sum() + 2 * lambda * z.rowwise().sum();
  return m.partialPivLu().solve(b);
}

double largest_difference(const Propagation& a, const Eigen::MatrixXd& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.indicators.size(); ++i)
    worst = std::max(worst, std::abs(static_cast<double>(a.indicators[i]) - b.data()[i]));
  return worst;
}

TEST(PropagateAllPairs, AllColumnsGiveTheDenseSolution) {
  const Features features = random_features(12, 10, 1);
  for (const double space : {0.0, 0.3}) {
    const AllPairsParams params{.sigma_space = space};
    const Propagation result = propagate_all_pairs(features, some_strokes, 3, params);
    EXPECT_LT(largest_difference(result, solve_dense(features, some_strokes, 3, params)), 1e-5);
    EXPECT_LT(result.residual, 1e-8);
    EXPECT_EQ(result.clamped, 0u);
  }
}

TEST(PropagateAllPairs, ErrorFallsWithTheNumberOfColumns) {
  const Features features = random_features(20, 20, 1);
  const Eigen::MatrixXd exact = solve_dense(features, some_strokes, 3, {});
  double error[3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const AllPairsParams params{.columns = i == 0 ? 8 : (i == 1 ? 24 : 72)};
    error[i] = largest_difference(propagate_all_pairs(features, some_strokes, 3, params), exact);
  }
  EXPECT_GT(error[0], 1e-4);
  EXPECT_LT(error[1], 0.5 * error[0]);
  EXPECT_LT(error[2], 0.5 * error[1]);
}

TEST(PropagateAllPairs, ConstantStrokesGiveAConstantAtAnyRank) {
  const Features features = random_features(20, 20, 2);
  for (const int columns : {10, 100}) {
    const Propagation result =
        propagate_all_pairs(features, {{3, 1, 0}, {99, 0.3F, 0}}, 1, {.columns = columns});
    for (const float v : result.indicators) EXPECT_NEAR(v, 1, 1e-5);
  }
}

TEST(PropagateAllPairs, SmallLambdaGivesTheWeightedMeanOfStrokes) {
  const Features features = random_features(12, 10, 3);
  const AllPairsParams params{.lambda = 1e-9};
  const Propagation result = propagate_all_pairs(features, some_strokes, 3, params);
  for (std::size_t i = 0; i < features.pixels(); ++i) {
    double sum = 0, first = 0;
    for (const StrokePixel& p : some_strokes) {
      const double zw = static_cast<double>(p.weight) * similarity(features, i, p.pixel, params);
      sum += zw;
      if (p.stroke == 0) first += zw;
    }
    EXPECT_NEAR(result.indicators[i], first / sum, 1e-4);
  }
}

TEST(PropagateAllPairs, TwoPointsClosedForm) {
  const Features features = make_features(2, 1, 1, {0, 1});  // d^2 = 2
  const double z = std::exp(-2.0 / 3), l = 0.4;
  const Propagation result =
      propagate_all_pairs(features, {{0, 1, 0}, {1, 1, 1}}, 2, {.sigma = 3, .lambda = l});
  // (1 + z) e_0 + 2 l z (e_0 - e_1) = 1 and, by symmetry, e_1 = 1 - e_0
  const double e0 = (1 + 2 * l * z) / (1 + z + 4 * l * z);
  EXPECT_NEAR(result.indicators[0], e0, 1e-6);
  EXPECT_NEAR(result.indicators[1], 1 - e0, 1e-6);
  EXPECT_NEAR(result.indicators[2], 1 - e0, 1e-6);
}

TEST(PropagateAllPairs, SeparateMaterialsTakeTheirOwnStrokeOrNone) {
  std::vector<float> raw;
  raw.reserve(300);
  for (int i = 0; i < 300; ++i) raw.push_back(static_cast<float>(i % 3));
  const Features features = make_features(20, 15, 1, raw);
  const Propagation result =
      propagate_all_pairs(features, {{0, 1, 0}, {1, 1, 1}}, 2, {.sigma = 0.01});
  for (std::size_t i = 0; i < 300; ++i) {
    EXPECT_NEAR(result.indicators[i], i % 3 == 0 ? 1 : 0, 1e-5);
    EXPECT_NEAR(result.indicators[300 + i], i % 3 == 1 ? 1 : 0, 1e-5);
  }
}

TEST(PropagateAllPairs, DoesNotDependOnTheOrderOfPixels) {
  Rng rng = make_rng(8);
  std::vector<float> raw, reversed;
  raw.reserve(90);
  for (int i = 0; i < 90; ++i) raw.push_back(static_cast<float>(sample_uniform(rng)));
  reversed.assign(raw.rbegin(), raw.rend());
  const Propagation a =
      propagate_all_pairs(make_features(10, 9, 1, raw), {{5, 1, 0}, {60, 1, 1}}, 2);
  const Propagation b =
      propagate_all_pairs(make_features(10, 9, 1, reversed), {{84, 1, 0}, {29, 1, 1}}, 2);
  for (std::size_t i = 0; i < 90; ++i) EXPECT_NEAR(a.indicators[i], b.indicators[89 - i], 1e-5);
}

TEST(PropagateAllPairs, StaysInRangeAtLowRank) {
  const Features features = random_features(30, 20, 5);
  const Propagation result =
      propagate_all_pairs(features, some_strokes, 3, {.columns = 6, .sigma = 0.02});
  for (const float v : result.indicators) EXPECT_TRUE(v >= 0 && v <= 1);
}

TEST(PropagateAllPairs, SameBitsForAnyThreads) {
  const Features features = random_features(50, 40, 5);
  std::vector<float> indicators[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    indicators[threads - 1] =
        propagate_all_pairs(features, some_strokes, 3, {.columns = 40}).indicators;
  }
  EXPECT_EQ(indicators[0], indicators[1]);
}

TEST(PropagateAllPairs, RejectsBadInput) {
  const Features features = random_features(5, 5, 5);
  EXPECT_EQ(error_of([&] { propagate_all_pairs(features, {}, 1); }),
            "strokes: expected at least one pixel with a positive weight, found none");
  EXPECT_THROW(propagate_all_pairs(features, {{.pixel = 25}}, 1), Error);
  EXPECT_THROW(propagate_all_pairs(features, {{.pixel = 2}}, 1, {.columns = 0}), Error);
}

}  // namespace
}  // namespace parian

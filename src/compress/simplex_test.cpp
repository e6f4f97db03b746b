#include "compress/simplex.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace parian {
namespace {

struct Problem {
  double gram[max_corners][max_corners] = {};
};

// Gram matrix of `count` random corners in `dimensions` dimensions around `centre`.
Problem make_problem(Rng& rng, std::size_t count, int dimensions, double centre) {
  double corner[max_corners][4];
  for (std::size_t i = 0; i < count; ++i)
    for (int d = 0; d < dimensions; ++d) corner[i][d] = centre + sample_normal(rng);
  Problem problem;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j)
      for (int d = 0; d < dimensions; ++d) problem.gram[i][j] += corner[i][d] * corner[j][d];
  return problem;
}

double eval(const Problem& problem, const double* t, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < count; ++j) sum += t[i] * problem.gram[i][j] * t[j];
  return sum;
}

// Optimality (Karush, Kuhn, Tucker): A t is lowest, and equal, where t > 0.
TEST(Simplex, MeetsTheOptimalityConditions) {
  Rng rng = make_rng(1);
  for (int trial = 0; trial < 400; ++trial) {
    const std::size_t count = 1 + static_cast<std::size_t>(trial) % max_corners;
    const Problem problem = make_problem(rng, count, 1 + trial % 4, trial % 3 == 0 ? 0 : 1.5);
    double t[max_corners], product[max_corners] = {}, sum = 0, trace = 0;
    nearest_in_simplex(problem.gram, count, t);
    for (std::size_t i = 0; i < count; ++i) {
      sum += t[i];
      trace += problem.gram[i][i];
      EXPECT_GE(t[i], 0);
      for (std::size_t j = 0; j < count; ++j) product[i] += problem.gram[i][j] * t[j];
    }
    EXPECT_NEAR(sum, 1, 1e-9);
    const double level = eval(problem, t, count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_GE(product[i], level - 1e-6 * trace) << "trial " << trial;
      if (t[i] > 1e-9) {
        EXPECT_NEAR(product[i], level, 1e-6 * trace) << "trial " << trial;
      }
    }
  }
}

TEST(Simplex, EqualCornersShareTheWeight) {
  Problem problem;
  for (auto& row : problem.gram)
    for (double& value : row) value = 2;
  for (std::size_t count : {2u, 5u}) {
    double t[max_corners];
    nearest_in_simplex(problem.gram, count, t);
    EXPECT_NEAR(eval(problem, t, count), 2, 1e-9);
  }
}

TEST(Simplex, RoundingStaysOnTheSimplexAndNear) {
  Rng rng = make_rng(2);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t count = 1 + static_cast<std::size_t>(trial) % max_corners;
    const int levels = 1 + trial;
    double t[max_corners], rounded[max_corners], sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += t[i] = sample_uniform(rng);
    for (std::size_t i = 0; i < count; ++i) rounded[i] = t[i] /= sum;
    round_weights(rounded, count, levels);
    double total = 0;
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_NEAR(rounded[i], t[i], 1.0 / levels);
      EXPECT_NEAR(rounded[i] * levels, std::round(rounded[i] * levels), 1e-9 * levels);
      total += rounded[i] * levels;
    }
    EXPECT_NEAR(total, levels, 1e-9 * levels);
    double again[max_corners];
    std::copy(rounded, rounded + count, again);
    round_weights(again, count, levels);
    for (std::size_t i = 0; i < count; ++i) EXPECT_DOUBLE_EQ(again[i], rounded[i]);
  }
}

}  // namespace
}  // namespace parian

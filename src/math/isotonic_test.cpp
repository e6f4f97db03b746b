#include "math/isotonic.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"

namespace parian {
namespace {

double misfit(const std::vector<double>& a, const std::vector<double>& b,
              const std::vector<double>& w) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += w[i] * (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

TEST(Isotonic, PoolsAreTheBestNonIncreasingFit) {
  Rng rng = make_rng(1);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> values(6), weights(6);
    for (std::size_t i = 0; i < 6; ++i) {
      values[i] = sample_normal(rng);
      weights[i] = 0.1 + sample_uniform(rng);
    }
    std::vector<double> fitted = values;
    const bool changed = make_non_increasing(fitted, weights);
    EXPECT_EQ(changed, fitted != values);
    EXPECT_TRUE(std::is_sorted(fitted.rbegin(), fitted.rend()));
    // No other non-increasing sequence is closer: compare with random ones near the fit.
    for (int i = 0; i < 50; ++i) {
      std::vector<double> other = fitted;
      for (double& v : other) v += 0.1 * sample_normal(rng);
      std::sort(other.rbegin(), other.rend());
      EXPECT_GE(misfit(other, values, weights), misfit(fitted, values, weights) - 1e-12);
    }
  }
}

}  // namespace
}  // namespace parian

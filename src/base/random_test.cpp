#include "base/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace parian {
namespace {

TEST(Random, SameSeedSameNumbersOtherStreamOthers) {
  Rng a = make_rng(7, 1), b = make_rng(7, 1), c = make_rng(7, 2);
  int equal = 0;
  for (int i = 0; i < 100; ++i) {
    const std::uint32_t x = sample_u32(a);
    EXPECT_EQ(x, sample_u32(b));
    equal += x == sample_u32(c);
  }
  EXPECT_LT(equal, 3);
}

// Chi-square of 64 equal bins against its mean 63 and variance 126 (normal approximation, 5 sigma).
TEST(Random, UniformAndHashFillTheInterval) {
  Rng rng = make_rng(3);
  for (int kind = 0; kind < 2; ++kind) {
    std::vector<double> bins(64);
    const int n = 64'000;
    for (int i = 0; i < n; ++i) {
      const double u = kind == 0 ? sample_uniform(rng)
                                 : hash_to_uniform(hash_u64(11, static_cast<std::uint64_t>(i)));
      ASSERT_GE(u, 0.0);
      ASSERT_LT(u, 1.0);
      bins[static_cast<std::size_t>(u * 64)] += 1;
    }
    double chi2 = 0;
    for (double count : bins) chi2 += (count - 1000) * (count - 1000) / 1000;
    EXPECT_NEAR(chi2, 63, 5 * std::sqrt(126.0));
  }
}

TEST(Random, NormalHasMeanZeroAndVarianceOne) {
  Rng rng = make_rng(5);
  const int n = 100'000;
  double sum = 0, square = 0;
  for (int i = 0; i < n; ++i) {
    const double x = sample_normal(rng);
    sum += x;
    square += x * x;
  }
  EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(square / n, 1, 5 * std::sqrt(2.0 / n));
}

// Against the counts' probabilities, either side of where the normal takes over, and their moments.
TEST(Random, PoissonCountsHaveTheirDistribution) {
  Rng rng = make_rng(12);
  constexpr int n = 100'000;
  for (const double mean : {0.02, 0.7, 4.0, 45.0, 80.0}) {
    double sum = 0, squares = 0, zeros = 0;
    for (int i = 0; i < n; ++i) {
      const double count = sample_poisson(rng, mean);
      sum += count;
      squares += (count - mean) * (count - mean);
      zeros += count == 0;
    }
    EXPECT_NEAR(sum / n, mean, 5 * std::sqrt(mean / n)) << mean;
    // The variance of squared deviations is mean + 2 mean^2.
    EXPECT_NEAR(squares / n, mean + (mean > 50 ? 1.0 / 12 : 0.0),
                5 * std::sqrt((mean + 2 * mean * mean) / n))
        << mean;
    const double none = std::exp(-mean);
    EXPECT_NEAR(zeros / n, none, 5 * std::sqrt(none * (1 - none) / n) + 1e-12) << mean;
  }
  EXPECT_EQ(sample_poisson(rng, 0), 0);
}

}  // namespace
}  // namespace parian

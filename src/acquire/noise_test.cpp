#include "acquire/noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace parian {
namespace {

TEST(Noise, HasMeanZeroAndVarianceOne) {
  for (const int octaves : {1, 4}) {
    double sum = 0, squares = 0;
    constexpr int count = 20000;
    for (int i = 0; i < count; ++i) {
      // Different seeds: independent samples, at points anywhere in the cell.
      const double value =
          eval_fractal_noise(static_cast<std::uint64_t>(i), 0.37 * i, -0.73 * i, octaves);
      sum += value;
      squares += value * value;
    }
    // Standard errors are 0.007 and 0.01 (kurtosis below the normal's 3): five of them.
    EXPECT_NEAR(sum / count, 0, 0.035);
    EXPECT_NEAR(squares / count, 1, 0.05);
  }
}

TEST(Noise, IsSmoothAcrossTheLattice) {
  constexpr double h = 1e-6;
  for (const double u : {-2.0, 0.0, 3.0}) {
    EXPECT_NEAR(eval_noise(5, u - h, 0.3), eval_noise(5, u + h, 0.3), 1e-4);
    const double left = (eval_noise(5, u, 0.3) - eval_noise(5, u - h, 0.3)) / h;
    const double right = (eval_noise(5, u + h, 0.3) - eval_noise(5, u, 0.3)) / h;
    EXPECT_NEAR(left, right, 1e-3);
  }
}

TEST(Noise, DependsOnTheSeedAlone) {
  EXPECT_EQ(eval_fractal_noise(1, 0.2, 0.9, 3), eval_fractal_noise(1, 0.2, 0.9, 3));
  EXPECT_NE(eval_fractal_noise(1, 0.2, 0.9, 3), eval_fractal_noise(2, 0.2, 0.9, 3));
}

}  // namespace
}  // namespace parian

#include "math/fast_math.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace parian {
namespace {

TEST(FastMath, LogIsAccurateOverAllMagnitudes) {
  std::vector<float> x, y;
  for (double e = -37.9; e < 38; e += 1e-3) x.push_back(static_cast<float>(std::pow(10.0, e)));
  for (double v = 0.5; v < 2; v += 1e-4) x.push_back(static_cast<float>(v));
  y.resize(x.size());
  log_array(x.data(), y.data(), x.size());
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double exact = std::log(static_cast<double>(x[i]));
    worst = std::max(worst, std::abs(y[i] - exact) / std::max(1.0, std::abs(exact)));
  }
  EXPECT_LT(worst, 2e-7);
}

TEST(FastMath, ExpIsAccurate) {
  std::vector<float> x, y;
  for (double v = -87; v < 88; v += 1e-3) x.push_back(static_cast<float>(v));
  y.resize(x.size());
  exp_array(x.data(), y.data(), x.size());
  double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i)
    worst = std::max(worst, std::abs(y[i] / std::exp(static_cast<double>(x[i])) - 1));
  EXPECT_LT(worst, 2e-7);
}

TEST(FastMath, SpecialValues) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float in[] = {0, -1, nan, 1e-42f};
  float out[4];
  log_array(in, out, 4);
  EXPECT_EQ(out[0], -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(out[1]) && std::isnan(out[2]));
  EXPECT_EQ(out[3], -std::numeric_limits<float>::infinity());
  const float powers[] = {-200, nan, 0, -std::numeric_limits<float>::infinity()};
  exp_array(powers, out, 4);
  EXPECT_EQ(out[0], 0);
  EXPECT_TRUE(std::isnan(out[1]));
  EXPECT_EQ(out[2], 1);
  EXPECT_EQ(out[3], 0);
}

}  // namespace
}  // namespace parian

#include "gl/splat_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "transport/near_term.h"

namespace parian {
namespace {

// A^2 = exp(-r / length) in all channels.
ReferenceProfile make_exponential(double length_mm, float support_mm) {
  ReferenceProfile reference;
  for (int i = 0; i <= 200; ++i) {
    reference.knots_mm.push_back(0.05f * static_cast<float>(i));
    const auto h = static_cast<float>(-0.025 * i / length_mm);
    reference.half_log.push_back({h, h, h});
  }
  reference.support_mm = {support_mm, support_mm, support_mm};
  return reference;
}

double eval_kernel(const Vec4& root, double r) {
  double value = 0;
  for (int j = 3; j >= 0; --j)
    value = value * r + static_cast<double>(root[static_cast<std::size_t>(j)]);
  return std::pow(value, 8);
}

TEST(NearKernel, IsTheReferenceWithTheIntegralOne) {
  for (const double near_mm : {0.5, 2.0})
    for (const double length_mm : {0.3, 1.0, 10.0}) {
      const ReferenceProfile reference = make_exponential(length_mm, 10);
      const Vec4 root = make_near_kernel(reference, near_mm);
      const double start = eval_kernel(root, 0.25 * near_mm) * std::exp(0.25 * near_mm / length_mm);
      double integral = 0;
      constexpr int steps = 4000;
      for (int i = 0; i < steps; ++i) {
        const double r = near_mm * (i + 0.5) / steps, value = eval_kernel(root, r);
        integral += 2 * std::numbers::pi * r * near_weight(r, near_mm) * value * near_mm / steps;
        EXPECT_NEAR(value * std::exp(r / length_mm) / start, 1, 0.02) << r << ' ' << length_mm;
      }
      EXPECT_NEAR(integral, 1, 1e-4);
    }
}

TEST(NearKernel, IsZeroWhereTheReferenceEndsAtOnce) {
  for (const float value : make_near_kernel(make_exponential(1, 0), 1)) EXPECT_EQ(value, 0);
}

}  // namespace
}  // namespace parian

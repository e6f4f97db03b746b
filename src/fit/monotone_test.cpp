#include "fit/monotone.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "fit/test_tables.h"

namespace parian {
namespace {

TEST(Monotone, ProjectionKeepsTheAlbedoAndSparesFallingProfiles) {
  const BssrdfTable table = make_test_table(5, 4, 3);
  const auto source = make_slices(table);
  ReducedParams params;
  params.knots_mm = {0, 0.5, 1, 1.5};
  const ReducedSystem system = make_reduced_system(*source, 0, params);
  std::vector<double> p(system.unknowns());
  Rng rng = make_rng(2);
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t x = 0; x < 20; ++x)
      p[k * 20 + x] = -static_cast<double>(k) + (x % 2 == 0 ? 0.9 * sample_normal(rng) : 0);
  const std::vector<double> before = p;
  const auto albedo = [&](const std::vector<double>& q, std::size_t x) {
    double sum = 0;
    for (Offset d : system.offsets) {
      const double r = length_px(d);  // knots are one pixel apart
      const auto k = static_cast<std::size_t>(std::min(r, 2.5));
      const double f = r - static_cast<double>(k);
      sum += (d == Offset{} ? 1 : 2) * std::exp((1 - f) * q[k * 20 + x] + f * q[(k + 1) * 20 + x]);
    }
    return sum;
  };
  const std::size_t touched = project_monotone(system, p);
  std::size_t changed = 0;
  for (std::size_t x = 0; x < 20; ++x) {
    bool same = true;
    for (std::size_t k = 0; k < 4; ++k) {
      same = same && p[k * 20 + x] == before[k * 20 + x];
      if (k > 0) {
        EXPECT_LE(p[k * 20 + x], p[(k - 1) * 20 + x]);
      }
    }
    EXPECT_NEAR(albedo(p, x) / albedo(before, x), 1, 1e-12);
    if (x % 2 == 1) {
      EXPECT_TRUE(same);
    }
    changed += same ? 0 : 1;
  }
  EXPECT_EQ(touched, changed);
  EXPECT_GT(touched, 0u);
}

}  // namespace
}  // namespace parian

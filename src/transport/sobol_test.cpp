#include "transport/sobol_internal.h"

#include <gtest/gtest.h>

namespace parian {
namespace {

TEST(Sobol, PointsAreStratified) {
  const auto sequence = make_sobol_points(64);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const SobolScramble scrambles = make_scramble(hash_u64(seed));
    // Each elementary interval of area 1/64 holds one point.
    for (int log_x = 0; log_x <= 6; ++log_x) {
      std::vector<int> found(64);
      for (const SobolPoint& point : sequence) {
        const Vec2 p = scramble(point, scrambles);
        ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
        const int columns = 1 << log_x, rows = 64 / columns;
        ++found[static_cast<std::size_t>(static_cast<int>(p.x * static_cast<float>(columns)) *
                                             rows +
                                         static_cast<int>(p.y * static_cast<float>(rows)))];
      }
      for (const int count : found) ASSERT_EQ(count, 1) << log_x;
    }
  }
}

}  // namespace
}  // namespace parian

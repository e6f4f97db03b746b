#include "acquire/path_stencil.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace parian {
namespace {

double mean_over(const std::vector<PathPair>& stencil, double (*field)(double, double)) {
  double sum = 0;
  for (const PathPair& pair : stencil)
    sum += pair.weight * (field(pair.near.dx, pair.near.dy) + field(pair.far.dx, pair.far.dy));
  return sum;
}

TEST(PathStencil, IsAMeanThatIsExactForLinearFields) {
  for (const Offset d : {Offset{0, 0}, Offset{1, 0}, Offset{0, 3}, Offset{-4, 7}, Offset{24, 5}}) {
    const auto stencil = make_path_stencil(d);
    EXPECT_NEAR(mean_over(stencil, [](double, double) { return 1.0; }), 1, 1e-14);
    EXPECT_NEAR(mean_over(stencil, [](double x, double y) { return 2 * x - y; }), d.dx - 0.5 * d.dy,
                1e-12);
  }
}

TEST(PathStencil, PairsSumToTheOffsetAndStayBetweenTheEnds) {
  const Offset d{-7, 4};
  for (const PathPair& pair : make_path_stencil(d)) {
    EXPECT_EQ(pair.near.dx + pair.far.dx, d.dx);
    EXPECT_EQ(pair.near.dy + pair.far.dy, d.dy);
    EXPECT_GT(pair.weight, 0);
    for (const Offset node : {pair.near, pair.far}) {
      EXPECT_LE(std::abs(2 * node.dx - d.dx), std::abs(d.dx));
      EXPECT_LE(std::abs(2 * node.dy - d.dy), std::abs(d.dy));
    }
  }
}

// A wall one pixel wide across a path of n pixels fills 1/n of it.
TEST(PathStencil, WeighsWhatThePathCrosses) {
  for (const int n : {4, 10, 23}) {
    const auto wall = [](double x, double) { return x == 2 ? 1.0 : 0.0; };
    EXPECT_NEAR(mean_over(make_path_stencil({n, 0}), wall), 1.0 / n, 1e-12);
    EXPECT_NEAR(mean_over(make_path_stencil({n, n - 1}), wall), 1.0 / n, 0.06 / n);
  }
}

// The reversed path: the same nodes seen from the other end, pair by pair.
TEST(PathStencil, ReversedPathHasTheSamePairs) {
  const Offset d{5, 3};
  const auto forward = make_path_stencil(d);
  const auto backward = make_path_stencil({-d.dx, -d.dy});
  ASSERT_EQ(forward.size(), backward.size());
  for (std::size_t i = 0; i < forward.size(); ++i) {
    EXPECT_EQ(forward[i].weight, backward[i].weight);
    EXPECT_EQ(forward[i].near, (Offset{-backward[i].near.dx, -backward[i].near.dy}));
  }
}

}  // namespace
}  // namespace parian

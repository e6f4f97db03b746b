#include "gl/sample_levels.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/shapes.h"

namespace parian {
namespace {

TEST(RadialLevels, WeightsSumToOneUpToTheSupport) {
  for (const double overlap : {0.2, 0.5, 1.0})
    for (const double support : {0.5, 7.0, 300.0}) {
      const RadialLevels levels = make_radial_levels(1.5, overlap, support);
      for (int i = 0; i <= 2000; ++i) {
        const double r = support * i / 2001;
        double sum = 0;
        for (int l = 0; l < levels.count; ++l) sum += level_weight(levels, l, r);
        EXPECT_NEAR(sum, 1, 1e-12) << r;
      }
    }
}

TEST(RadialLevels, WeightsAreZeroOutsideTheirRangeAndNodesSpanIt) {
  const RadialLevels levels = make_radial_levels(2, 0.5, 100);
  EXPECT_GT(levels.count, 4);
  for (int l = 0; l < levels.count; ++l) {
    const double first = levels.first_mm(l), last = levels.last_mm(l);
    EXPECT_EQ(level_weight(levels, l, 1.001 * last), 0);
    EXPECT_GT(level_weight(levels, l, 0.999 * last), 0);
    if (l > 0) {
      EXPECT_EQ(level_weight(levels, l, 0.999 * first), 0);
      EXPECT_GT(level_weight(levels, l, 1.001 * first), 0);
    }
    const auto nodes = level_nodes(l);
    EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
    EXPECT_LE(static_cast<double>(levels.nodes[static_cast<std::size_t>(nodes[0])]), first);
    EXPECT_GE(static_cast<double>(levels.nodes[static_cast<std::size_t>(nodes[4])]), last);
  }
}

TEST(RadialLevels, ALargeFirstRadiusLeavesOneLevel) {
  EXPECT_EQ(make_radial_levels(50, 0.5, 100).count, 1);
  EXPECT_EQ(make_radial_levels(49, 0.5, 100).count, 2);
}

// Mean distance of the members of groups of 4^k, in spacings of the groups.
double spread_of(const std::vector<SurfacePoint>& points, const std::vector<std::uint32_t>& order,
                 std::size_t group, double area_mm2) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t first = 0; first + group <= order.size(); first += group)
    for (std::size_t i = first + 1; i < first + group; ++i, ++count)
      sum +=
          static_cast<double>(distance(points[order[first]].position, points[order[i]].position));
  return sum / static_cast<double>(count) / std::sqrt(area_mm2 * static_cast<double>(group));
}

TEST(SampleGroups, AreNeighboursOnEveryScale) {
  TriangleMesh mesh = make_knot(1);
  clean_mesh(mesh, "test mesh");
  fit_to_size(mesh, 50);
  const SurfaceSamples samples = make_surface_samples(mesh, 3000);
  std::vector<std::uint32_t> order = order_by_groups(samples.points);
  for (const std::size_t group : {4u, 16u, 64u}) {
    const double spread = spread_of(samples.points, order, group, samples.area_mm2);
    EXPECT_GT(spread, 0.4) << group;
    EXPECT_LT(spread, 1.2) << group;
  }
  std::sort(order.begin(), order.end());
  for (std::uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

TEST(SampleGroups, LevelsHoldAQuarterEach) {
  EXPECT_EQ(level_size(1000, 0), 1000u);
  EXPECT_EQ(level_size(1000, 1), 250u);
  EXPECT_EQ(level_size(1000, 2), 63u);
  EXPECT_EQ(level_size(1000, 9), 1u);
}

}  // namespace
}  // namespace parian

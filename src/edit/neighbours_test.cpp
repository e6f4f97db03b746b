#include "edit/neighbours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"

namespace parian {
namespace {

Features random_features(int width, int height, int dims, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  std::vector<float> raw(static_cast<std::size_t>(width * height * dims));
  for (float& v : raw) v = static_cast<float>(sample_normal(rng));
  return make_features(width, height, dims, raw, dims);
}

// Row as (to, distance2, spatial); checks order, symmetry and loops.
void expect_well_formed(const NeighbourGraph& graph, const Features& features) {
  ASSERT_EQ(graph.pixels(), features.pixels());
  ASSERT_EQ(graph.first.back(), graph.to.size());
  for (std::size_t i = 0; i < graph.pixels(); ++i) {
    for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
      const std::size_t j = graph.to[e];
      ASSERT_EQ(graph.node[graph.pixel[j]], j);
      ASSERT_NE(i, j);
      ASSERT_TRUE(e == graph.first[i] || graph.to[e - 1] < graph.to[e]);
      const auto begin = graph.to.begin() + static_cast<std::ptrdiff_t>(graph.first[j]);
      const auto end = graph.to.begin() + static_cast<std::ptrdiff_t>(graph.first[j + 1]);
      const auto found = std::lower_bound(begin, end, static_cast<std::uint32_t>(i));
      ASSERT_TRUE(found != end && *found == i);
      const auto mirrored = static_cast<std::size_t>(found - graph.to.begin());
      ASSERT_EQ(graph.distance2[e], graph.distance2[mirrored]);
      ASSERT_EQ(graph.spatial[e], graph.spatial[mirrored]);
      ASSERT_EQ(graph.distance2[e], static_cast<float>(feature_distance_squared(
                                        features, graph.pixel[i], graph.pixel[j])));
    }
  }
}

TEST(NeighbourGraph, HoldsTheNearestAndThePixelsBeside) {
  for (const int dims : {1, 3, 6, 11}) {
    const Features features = random_features(23, 17, dims, 1);
    const NeighbourGraph graph = make_neighbour_graph(features, {.neighbours = 7});
    expect_well_formed(graph, features);
    std::size_t beside = 0;
    for (std::size_t i = 0; i < graph.pixels(); ++i) {
      std::vector<double> all;
      for (std::size_t j = 0; j < graph.pixels(); ++j)
        if (j != i)
          all.push_back(feature_distance_squared(features, graph.pixel[i], graph.pixel[j]));
      std::sort(all.begin(), all.end());
      std::vector<double> mine;
      for (std::size_t e = graph.first[i]; e < graph.first[i + 1]; ++e) {
        if (graph.spatial[e] == 0) mine.push_back(static_cast<double>(graph.distance2[e]));
        const std::size_t a = graph.pixel[i], b = graph.pixel[graph.to[e]];
        const std::size_t apart = std::max(a, b) - std::min(a, b);
        EXPECT_TRUE(graph.spatial[e] == 0 || apart == 1 || apart == 23);
        if (apart == 23 || (apart == 1 && std::max(a, b) % 23 != 0)) ++beside;
      }
      std::sort(mine.begin(), mine.end());
      ASSERT_GE(mine.size(), 7u);
      for (std::size_t j = 0; j < 7; ++j)  // squared distances move by 2 d jitter
        EXPECT_NEAR(mine[j], all[j], 2e-4 * std::sqrt(all[j]) + 1e-8);
    }
    EXPECT_EQ(beside, 2u * (22 * 17 + 23 * 16));
  }
}

TEST(NeighbourGraph, EqualPixelsAreJoinedEvenly) {
  const Features features = make_features(100, 80, 3, std::vector<float>(24000, 1.0F));
  const NeighbourGraph graph = make_neighbour_graph(features);
  expect_well_formed(graph, features);
  std::size_t most = 0;
  for (std::size_t i = 0; i < graph.pixels(); ++i)
    most = std::max(most, graph.first[i + 1] - graph.first[i]);
  EXPECT_LT(most, 80u);
}

TEST(NeighbourGraph, TwoMaterialsAreJoinedBySpatialEdgesOnly) {
  std::vector<float> raw(30 * 20);
  for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = i % 30 < 15 ? 0.0F : 1.0F;
  const Features features = make_features(30, 20, 1, raw);
  const NeighbourGraph graph = make_neighbour_graph(features);
  std::size_t across = 0;
  for (std::size_t e = 0; e < graph.to.size(); ++e) {
    if (graph.distance2[e] < 0.5F) continue;
    EXPECT_EQ(graph.spatial[e], 1);
    ++across;
  }
  EXPECT_EQ(across, 40u);
}

TEST(NeighbourGraph, GroupsPartitionThePixels) {
  for (const int width : {1, 2, 5, 7, 11, 40, 150}) {
    const Features features = random_features(width, 60, 2, 3);
    const NeighbourGraph graph = make_neighbour_graph(features);
    EXPECT_LE(graph.groups(), 256u);
    EXPECT_EQ(graph.group_first.back(), features.pixels());
    std::vector<std::uint32_t> members = graph.pixel;
    std::sort(members.begin(), members.end());
    std::vector<std::uint32_t> all(features.pixels());
    std::iota(all.begin(), all.end(), 0u);
    EXPECT_EQ(members, all);
    for (std::size_t g = 0; g < graph.groups(); ++g)
      EXPECT_GE(graph.group_first[g + 1] - graph.group_first[g], 1u);
    EXPECT_TRUE(width < 150 || graph.groups() >= 128);
  }
}

TEST(NeighbourGraph, TinyImages) {
  const NeighbourGraph one = make_neighbour_graph(make_features(1, 1, 1, {3}));
  EXPECT_EQ(one.to.size(), 0u);
  EXPECT_EQ(one.groups(), 1u);
  const NeighbourGraph two = make_neighbour_graph(make_features(2, 1, 1, {3, 4}));
  EXPECT_EQ(two.to, (std::vector<std::uint32_t>{1, 0}));
  EXPECT_EQ(two.spatial, (std::vector<std::uint8_t>{0, 0}));
}

TEST(NeighbourGraph, SameForAnyThreads) {
  const Features features = random_features(50, 40, 4, 3);
  std::vector<std::uint32_t> to[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    to[threads - 1] = make_neighbour_graph(features).to;
  }
  EXPECT_EQ(to[0], to[1]);
}

TEST(NeighbourGraph, RejectsBadParameters) {
  EXPECT_THROW(make_neighbour_graph(random_features(3, 3, 1, 1), {.neighbours = 0}), Error);
}

}  // namespace
}  // namespace parian

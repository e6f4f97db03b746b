#include "edit/propagate.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/parallel.h"
#include "base/random.h"
#include "base/test_errors.h"

namespace parian {
namespace {

struct Scene {
  Features features;
  NeighbourGraph graph;
};

Scene make_scene(Features features, int neighbours = 16) {
  Scene scene{std::move(features), {}};
  scene.graph = make_neighbour_graph(scene.features, {.neighbours = neighbours});
  return scene;
}

Scene random_scene(int width, int height, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  std::vector<float> raw(static_cast<std::size_t>(width * height * 2));
  for (float& v : raw) v = static_cast<float>(sample_uniform(rng));
  return make_scene(make_features(width, height, 2, raw), 8);
}

// Left half and right half, each with a little noise; columns x = 0 .. 2 * half - 1.
Scene two_materials(int half, int height) {
  Rng rng = make_rng(3);
  std::vector<float> raw;
  raw.reserve(static_cast<std::size_t>(2 * half * height));
  for (int i = 0; i < 2 * half * height; ++i)
    raw.push_back((i % (2 * half) < half ? 0.0F : 1.0F) +
                  0.01F * static_cast<float>(sample_normal(rng)));
  return make_scene(make_features(2 * half, height, 1, raw));
}

std::vector<StrokePixel> random_strokes(std::size_t pixels, int strokes, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  std::vector<StrokePixel> list;
  for (int s = 0; s < strokes; ++s)
    for (int i = 0; i < 5; ++i)
      list.push_back({sample_u32(rng) % static_cast<std::uint32_t>(pixels),
                      0.2F + static_cast<float>(sample_uniform(rng)), s});
  return list;
}

std::vector<float> mask_of(const Scene& scene, const std::vector<StrokePixel>& pixels,
                           const std::vector<bool>& positive, PropagateParams params = {}) {
  params.rest = std::find(positive.begin(), positive.end(), false) == positive.end();
  return normalise_indicators(
      propagate(scene.graph, scene.features, pixels, static_cast<int>(positive.size()), params),
      positive);
}

// The energy's normal equations from its definition, in pixels and double precision.
Eigen::MatrixXd solve_dense(const Scene& scene, const std::vector<StrokePixel>& strokes, int count,
                            const PropagateParams& params) {
  const NeighbourGraph& graph = scene.graph;
  const auto n = static_cast<Eigen::Index>(graph.pixels());
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n, n), b = Eigen::MatrixXd::Zero(n, count);
  const double lambda = params.strength * default_smoothness / graph.neighbours;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto node = static_cast<std::size_t>(i);
    for (std::size_t e = graph.first[node]; e < graph.first[node + 1]; ++e) {
      const std::size_t p = graph.pixel[node], q = graph.pixel[graph.to[e]];
      const double a = lambda * (graph.spatial[e] != 0 ? spatial_factor : 1) *
                       std::exp(-feature_distance_squared(scene.features, p, q) / params.sigma);
      m(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(p)) += a;
      m(static_cast<Eigen::Index>(p), static_cast<Eigen::Index>(q)) -= a;
    }
    m(i, i) += params.prior;
    double largest = 0;
    for (int s = 0; s < count; ++s) {
      double z = 0;
      for (const StrokePixel& p : strokes)
        if (p.stroke == s)
          z = std::max(z, std::min(1.0, static_cast<double>(p.weight)) *
                              std::exp(-feature_distance_squared(scene.features, node, p.pixel) /
                                       params.sigma));
      m(i, i) += params.direct * z;
      b(i, s) += params.direct * z;
      largest = std::max(largest, z);
    }
    if (params.rest) m(i, i) += params.direct * (1 - largest);
  }
  for (const StrokePixel& p : strokes) {
    m(p.pixel, p.pixel) += static_cast<double>(p.weight);
    b(p.pixel, p.stroke) += static_cast<double>(p.weight);
  }
  return m.llt().solve(b);
}

TEST(Propagate, MatchesTheDenseSolutionToSinglePrecision) {
  const Scene scene = random_scene(25, 16, 1);
  for (const double direct : {0.0, 0.01}) {
    for (const int strokes : {1, 2, 6}) {
      const auto list = random_strokes(scene.features.pixels(), strokes, 5);
      const PropagateParams params{
          .direct = direct, .prior = 1e-3, .tolerance = 1e-7, .rest = strokes == 1};
      const Propagation result = propagate(scene.graph, scene.features, list, strokes, params);
      EXPECT_LT(result.residual, 1e-6);
      EXPECT_EQ(result.clamped, 0u);
      const Eigen::MatrixXd exact = solve_dense(scene, list, strokes, params);
      ASSERT_EQ(result.indicators.size(), static_cast<std::size_t>(exact.size()));
      for (std::size_t i = 0; i < result.indicators.size(); ++i)
        ASSERT_NEAR(result.indicators[i], exact.data()[i], 1e-5)
            << direct << ' ' << strokes << ' ' << i;
    }
  }
}

TEST(Propagate, TwoPointsClosedForm) {
  const Scene scene = make_scene(make_features(2, 1, 1, {0, 1}));
  const PropagateParams params{.sigma = 3, .strength = 20, .direct = 0, .prior = 0.01};
  const Propagation result =
      propagate(scene.graph, scene.features, {{.pixel = 0, .weight = 0.7F}}, 1, params);
  const double a = 20 * default_smoothness / 16 * std::exp(-2.0 / 3);  // their distance^2 is 2
  const double ratio = a / (a + 0.01);                                 // of e_1 to e_0
  const double e0 = 0.7 / (0.7 + a + 0.01 - a * ratio);
  EXPECT_NEAR(result.indicators[0], e0, 1e-5);
  EXPECT_NEAR(result.indicators[1], ratio * e0, 1e-5);
}

TEST(Propagate, IndicatorsSumToOneButForThePrior) {
  const Scene scene = random_scene(30, 20, 2);
  const auto list = random_strokes(scene.features.pixels(), 3, 1);
  const Propagation result =
      propagate(scene.graph, scene.features, list, 3, {.prior = 1e-8, .tolerance = 1e-7});
  const std::vector<float> mask = normalise_indicators(result, {true, true, true});
  for (const float v : mask) EXPECT_NEAR(v, 1, 1e-4);
}

TEST(Propagate, IsLinearInTheStrokes) {
  const Scene scene = random_scene(30, 20, 2);
  auto list = random_strokes(scene.features.pixels(), 3, 1);
  const PropagateParams params{.direct = 0, .prior = 1e-3, .tolerance = 1e-7};
  const Propagation apart = propagate(scene.graph, scene.features, list, 3, params);
  for (StrokePixel& p : list)
    if (p.stroke == 2) p.stroke = 0;
  const Propagation merged = propagate(scene.graph, scene.features, list, 2, params);
  const std::size_t n = scene.features.pixels();
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_NEAR(merged.indicators[i], apart.indicators[i] + apart.indicators[2 * n + i], 1e-5);
    EXPECT_NEAR(merged.indicators[n + i], apart.indicators[n + i], 1e-5);
  }
}

TEST(Propagate, MaterialsTakeTheirOwnStroke) {
  const Scene scene = two_materials(20, 15);
  for (const double direct : {0.0, 0.002}) {
    const std::vector<float> mask = mask_of(scene, {{7 * 40 + 3, 1, 0}, {9 * 40 + 33, 1, 1}},
                                            {true, false}, {.sigma = 0.01, .direct = direct});
    for (std::size_t i = 0; i < mask.size(); ++i)
      EXPECT_NEAR(mask[i], i % 40 < 20 ? 1.0 : 0.0, 1e-3);
  }
}

TEST(Propagate, WithoutADirectTermUnreachedComponentsAreZero) {
  const Scene scene = two_materials(20, 15);
  const Propagation result =
      propagate(scene.graph, scene.features, {{7 * 40 + 3, 1, 0}}, 1, {.sigma = 0.01, .direct = 0});
  for (std::size_t i = 0; i < result.indicators.size(); ++i) {
    if (i % 40 >= 20) {
      EXPECT_LT(result.indicators[i], 1e-3F);
    } else {
      EXPECT_GT(result.indicators[i], 0.5);
    }
  }
}

// A positive stroke alone: 1 at its appearance, 1/e at a squared distance of sigma, whatever the
// number of pixels.
TEST(Propagate, APositiveStrokeFallsOffWithAppearance) {
  for (const int size : {20, 60}) {
    std::vector<float> raw;  // appearance u in [0, 1], in random places
    raw.reserve(static_cast<std::size_t>(size * size));
    for (int i = 0; i < size * size; ++i)
      raw.push_back(
          static_cast<float>(hash_to_uniform(hash_u64(5, static_cast<std::uint64_t>(i)))));
    raw[0] = 0;
    const Scene scene = make_scene(make_features(size, size, 1, raw));
    const double sigma = 0.3;
    const std::vector<float> mask = mask_of(scene, {{0, 1, 0}}, {true}, {.sigma = sigma});
    for (std::size_t i = 0; i < mask.size(); ++i) {
      const double z = std::exp(-feature_distance_squared(scene.features, 0, i) / sigma);
      EXPECT_NEAR(mask[i], z, 0.25);
      EXPECT_TRUE(z < 0.95 || mask[i] > 0.8F) << z << ' ' << mask[i];
      EXPECT_TRUE(z > 0.02 || mask[i] < 0.2F) << z << ' ' << mask[i];
    }
    EXPECT_GT(mask[0], 0.95F);
  }
}

TEST(Propagate, StrokesKeepTheirOwnPixelsAndNarrowingSigmaNarrowsTheMask) {
  const Scene scene = random_scene(40, 30, 4);
  const std::vector<StrokePixel> list = {{41, 1, 0}, {42, 1, 0}, {43, 1, 1}, {700, 1, 1}};
  const auto sum_at = [&](double sigma) {
    const std::vector<float> mask = mask_of(scene, {{41, 1, 0}}, {true}, {.sigma = sigma});
    double sum = 0;
    for (const float v : mask) sum += static_cast<double>(v);
    return sum;
  };
  EXPECT_LT(sum_at(0.05), 0.7 * sum_at(0.2));
  EXPECT_LT(sum_at(0.2), 0.8 * sum_at(1));
  const std::vector<float> mask = mask_of(scene, list, {true, false});
  EXPECT_GT(mask[41], 0.97F);
  EXPECT_GT(mask[42], 0.97F);
  EXPECT_LT(mask[43], 0.03F);
  EXPECT_LT(mask[700], 0.03F);
  for (const float v : mask) EXPECT_TRUE(v >= 0 && v <= 1);
}

TEST(Propagate, WeightZeroIsNoStroke) {
  const Scene scene = random_scene(20, 10, 4);
  const std::vector<StrokePixel> one = {{41, 1, 0}}, two = {{41, 1, 0}, {77, 0, 1}};
  EXPECT_EQ(mask_of(scene, one, {true, false}), mask_of(scene, two, {true, false}));
}

TEST(Propagate, NothingOverNothingIsZero) {
  Propagation empty{
      .width = 3, .height = 1, .strokes = 2, .indicators = {0, 0.5F, 1e-4F, 0, 0.25F, 0}};
  const std::vector<float> mask = normalise_indicators(empty, {true, false});
  EXPECT_EQ(mask[0], 0);
  EXPECT_FLOAT_EQ(mask[1], 2.0F / 3);
  EXPECT_FLOAT_EQ(mask[2], 0.1F);  // hardly reached
  EXPECT_EQ(normalise_indicators(empty, {true, true})[1], 0.75F);
}

TEST(Propagate, EqualPixelsAndTinyImages) {
  const Scene flat = make_scene(make_features(30, 20, 1, std::vector<float>(600, 1.0F)));
  for (const float v : mask_of(flat, {{3, 1, 0}}, {true})) EXPECT_NEAR(v, 1, 0.02);
  const Scene one = make_scene(make_features(1, 1, 1, {1}));
  EXPECT_NEAR(mask_of(one, {{0, 1, 0}}, {true})[0], 1, 1e-4);
}

TEST(Propagate, SameBitsForAnyThreads) {
  const Scene scene = random_scene(60, 40, 4);
  std::vector<float> indicators[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    indicators[threads - 1] =
        propagate(scene.graph, scene.features, random_strokes(2400, 5, 1), 5).indicators;
  }
  EXPECT_EQ(indicators[0], indicators[1]);
}

std::string error_of(const Scene& scene, const std::vector<StrokePixel>& strokes,
                     const PropagateParams& params = {}) {
  return parian::error_of([&] { propagate(scene.graph, scene.features, strokes, 1, params); });
}

TEST(Propagate, RejectsBadStrokesAndParameters) {
  const Scene scene = random_scene(6, 5, 1);
  const std::string none =
      "strokes: expected at least one pixel with a positive weight, found none";
  EXPECT_EQ(error_of(scene, {}), none);
  EXPECT_EQ(error_of(scene, {{.pixel = 3, .weight = 0}}), none);
  EXPECT_EQ(error_of(scene, {{.pixel = 3, .weight = -1}}),
            "stroke 0, pixel 3: expected a weight in [0, 1e6], found -1");
  EXPECT_EQ(error_of(scene, {{.pixel = 3, .weight = std::nanf("")}}),
            "stroke 0, pixel 3: expected a weight in [0, 1e6], found nan");
  EXPECT_NE(error_of(scene, {{.pixel = 3}}, {.sigma = 0}), "no error");
  EXPECT_NE(error_of(scene, {{.pixel = 3}}, {.prior = std::nan("")}), "no error");
  EXPECT_NE(error_of(scene, {{.pixel = 30}}), "no error");  // a contract: outside
  EXPECT_NE(error_of(scene, {{.pixel = 3, .stroke = 1}}), "no error");
  const Scene other = random_scene(5, 6, 1);
  EXPECT_EQ(error_of({other.features, scene.graph}, {{.pixel = 3}}),
            "neighbour graph: expected 5 x 6 pixels as the features have, found 6 x 5");
}

}  // namespace
}  // namespace parian

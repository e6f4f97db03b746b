#include "compress/bases.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "compress/assign.h"
#include "math/isotonic.h"

namespace parian {
namespace {

double eval(const std::vector<double>& d, const std::vector<double>& o, double curvature,
            const std::vector<double>& b, const std::vector<double>& v) {
  double value = 0;
  for (std::size_t k = 0; k < v.size(); ++k) {
    value += v[k] * (0.5 * d[k] * v[k] - b[k]);
    if (k + 1 < v.size()) value += o[k] * v[k] * v[k + 1];
    if (k + 2 < v.size()) {
      const double bend = v[k] - 2 * v[k + 1] + v[k + 2];
      value += 0.5 * curvature * bend * bend;
    }
  }
  return value;
}

// With a diagonal matrix the answer is that of pooling adjacent violators.
TEST(Bases, DiagonalCaseIsPoolAdjacentViolators) {
  Rng rng = make_rng(1);
  for (int trial = 0; trial < 100; ++trial) {
    const std::size_t knots = 2 + static_cast<std::size_t>(trial) % 9;
    std::vector<double> d(knots), o(knots, 0.0), b(knots), target(knots), v(knots);
    for (std::size_t k = 0; k < knots; ++k) {
      d[k] = 0.5 + sample_uniform(rng);
      target[k] = -0.3 * static_cast<double>(k) + sample_normal(rng);
      b[k] = d[k] * target[k];
      v[k] = -static_cast<double>(k);
    }
    solve_non_increasing(d.data(), o.data(), 0, b.data(), knots, v.data());
    make_non_increasing(target, d);
    for (std::size_t k = 0; k < knots; ++k) EXPECT_NEAR(v[k], target[k], 1e-5) << trial;
  }
}

TEST(Bases, NeverRisesAndNeverGetsWorse) {
  Rng rng = make_rng(2);
  for (int trial = 0; trial < 200; ++trial) {
    const std::size_t knots = 2 + static_cast<std::size_t>(trial) % 9;
    const double curvature = trial % 3 == 0 ? 0.5 : 0;
    std::vector<double> d(knots), o(knots), b(knots), v(knots);
    for (std::size_t k = 0; k < knots; ++k) {
      d[k] = 1 + sample_uniform(rng);
      o[k] = 0.5 * sample_uniform(rng);
      b[k] = 2 * sample_normal(rng);
      v[k] = (k == 0 ? 0 : v[k - 1]) - sample_uniform(rng);
    }
    const double before = eval(d, o, curvature, b, v);
    solve_non_increasing(d.data(), o.data(), curvature, b.data(), knots, v.data());
    EXPECT_LE(eval(d, o, curvature, b, v), before + 1e-12);
    for (std::size_t k = 1; k < knots; ++k) EXPECT_LE(v[k], v[k - 1]);
  }
}

// Random rows, metric and mixtures.
struct Case {
  LocalMetric metric;
  AlignedVector<float> target;
  Mixture mixture;
};
Case make_case() {
  Case made;
  const RowShape shape{60, 3, 5};
  made.metric = {shape, AlignedVector<float>(shape.pixels * shape.stride()),
                 AlignedVector<float>(shape.pixels * shape.stride())};
  made.target.assign(shape.pixels * shape.stride(), 0.0f);
  Rng rng = make_rng(3);
  for (std::size_t x = 0; x < shape.pixels; ++x)
    for (std::size_t i = 0; i < shape.stride(); ++i) {
      const bool inside = i < 15;
      const std::size_t at = shape.row(x) + i;
      made.metric.diagonal[at] = inside ? static_cast<float>(1 + sample_uniform(rng)) : 0.0f;
      made.metric.coupling[at] =
          inside && i % 5 != 4 ? static_cast<float>(0.4 * sample_uniform(rng)) : 0.0f;
      made.target[at] =
          inside ? static_cast<float>(-2.0 * static_cast<double>(i % 5) + sample_normal(rng))
                 : 0.0f;
    }
  made.mixture = start_mixture(made.metric, made.target, 6, 1);
  made.mixture = with_one_more(made.mixture);
  return made;
}

double eval_bound(const Case& made) {
  const RowShape& shape = made.metric.shape;
  const AlignedVector<float> rows = mix_rows(made.mixture);
  double sum = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double v = static_cast<double>(rows[i]) - static_cast<double>(made.target[i]);
    sum += static_cast<double>(made.metric.diagonal[i]) * v * v;
    if (i % shape.stride() + 1 == shape.stride()) continue;
    const double next = static_cast<double>(rows[i + 1]) - static_cast<double>(made.target[i + 1]);
    sum += 2 * static_cast<double>(made.metric.coupling[i]) * v * next;
  }
  return sum;
}

TEST(Bases, EverySweepLowersTheBound) {
  Case made = make_case();
  assign_mixtures(made.metric, made.target, {}, made.mixture);
  double before = eval_bound(made);
  for (int round = 0; round < 4; ++round) {
    update_bases(made.metric, made.target, 0, 1, made.mixture);
    const double after = eval_bound(made);
    EXPECT_LE(after, before * (1 + 1e-6));
    before = after;
    const double assigned = assign_mixtures(made.metric, made.target, {}, made.mixture);
    EXPECT_NEAR(assigned, eval_bound(made), 1e-4 * assigned);
    EXPECT_LE(assigned, before * (1 + 1e-6));
    before = assigned;
  }
}

// All pairs of few bases, decided in the pixel's own metric: what the screening must find.
TEST(Assign, FindsTheBestPairNearlyAlways) {
  Case made = make_case();
  Mixture all = made.mixture;
  std::vector<double> best(made.metric.shape.pixels, 1e30);
  for (std::uint16_t i = 0; i < 6; ++i)
    for (std::uint16_t j = 0; j < i; ++j)
      for (int step = 0; step <= 50; ++step) {
        for (std::size_t x = 0; x < best.size(); ++x) {
          all.index[2 * x] = i;
          all.index[2 * x + 1] = j;
          all.weight[2 * x] = static_cast<float>(step) / 50.0f;
          all.weight[2 * x + 1] = 1 - all.weight[2 * x];
        }
        const Case probe{made.metric, made.target, all};
        const AlignedVector<float> rows = mix_rows(all);
        for (std::size_t x = 0; x < best.size(); ++x) {
          double sum = 0;
          const std::size_t row = made.metric.shape.row(x);
          for (std::size_t k = row; k < row + made.metric.shape.stride(); ++k) {
            const double v = static_cast<double>(rows[k] - made.target[k]);
            sum += static_cast<double>(made.metric.diagonal[k]) * v * v;
            if (k + 1 < row + made.metric.shape.stride())
              sum += 2 * static_cast<double>(made.metric.coupling[k]) * v *
                     static_cast<double>(rows[k + 1] - made.target[k + 1]);
          }
          best[x] = std::min(best[x], sum);
        }
      }
  double exhaustive = 0;
  for (double value : best) exhaustive += value;
  const double found = assign_mixtures(made.metric, made.target, {}, made.mixture);
  EXPECT_LE(found, 1.002 * exhaustive);  // the exhaustive search has 51 weights only
}

TEST(Assign, LatticeWeightsAreMultiples) {
  Case made = make_case();
  const double free = assign_mixtures(made.metric, made.target, {}, made.mixture);
  for (float& weight : made.mixture.weight) weight = std::round(weight);
  const double coarse = assign_mixtures(made.metric, made.target, {7, 0}, made.mixture);
  EXPECT_GE(coarse, free * (1 - 1e-6));
  for (std::size_t x = 0; x < made.metric.shape.pixels; ++x) {
    EXPECT_NEAR(made.mixture.weight[2 * x] + made.mixture.weight[2 * x + 1], 1, 1e-6);
    EXPECT_NEAR(std::remainder(made.mixture.weight[2 * x] * 7, 1), 0, 1e-5);
  }
}

TEST(Assign, OneMoreBasePerPixelNeverLoses) {
  Case made = make_case();
  double before = assign_mixtures(made.metric, made.target, {}, made.mixture);
  for (int k = 3; k <= 6; ++k) {
    made.mixture = with_one_more(made.mixture);
    const double after = assign_mixtures(made.metric, made.target, {}, made.mixture);
    EXPECT_LE(after, before * (1 + 1e-6)) << k;
    before = after;
  }
}

}  // namespace
}  // namespace parian

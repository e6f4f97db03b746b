#include "edit/poisson.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "base/test_errors.h"

namespace parian {
namespace {

using Values = std::vector<double>;
using Region = std::vector<std::uint8_t>;

struct Case {
  int width, height, planes;
  Region region;
  Values target, gx, gy;

  std::size_t size() const { return static_cast<std::size_t>(width * height); }
};

Values random_values(std::size_t count, Rng& rng) {
  Values values(count);
  for (double& value : values) value = sample_normal(rng);
  return values;
}

Region random_region(std::size_t count, double fill, Rng& rng) {
  Region region(count);
  for (auto& pixel : region) pixel = sample_uniform(rng) < fill ? 1 : 0;
  return region;
}

Case random_case(int width, int height, int planes, double fill, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  Case c{width, height, planes, {}, {}, {}, {}};
  const std::size_t count = c.size() * static_cast<std::size_t>(planes);
  c.region = random_region(c.size(), fill, rng);
  c.target = random_values(count, rng);
  c.gx = random_values(count, rng);
  c.gy = random_values(count, rng);
  return c;
}

Values solve(const Case& c, double tolerance = 1e-12, PoissonReport* report = nullptr) {
  return solve_poisson(c.width, c.height, c.planes, c.region, c.target, c.gx, c.gy,
                       {.tolerance = tolerance, .max_iterations = 200}, report);
}

double distance(const Values& a, const Values& b) {
  double worst = 0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

// Least squares of all differences with an end in the region, by a dense matrix.
Values solve_dense(const Case& c) {
  const int n = c.width * c.height;
  Values f = c.target;
  for (int p = 0; p < c.planes; ++p) {
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
    const double* t = c.target.data() + p * n;
    const auto inside = [&](int i) { return c.region[static_cast<std::size_t>(i)] != 0; };
    const auto add = [&](int i, int j, double v) {  // f_j - f_i = v
      if (inside(i)) a(i, i) += 1, b(i) += inside(j) ? -v : t[j] - v;
      if (inside(j)) a(j, j) += 1, b(j) += inside(i) ? v : t[i] + v;
      if (inside(i) && inside(j)) a(i, j) -= 1, a(j, i) -= 1;
    };
    for (int y = 0; y < c.height; ++y)
      for (int x = 0; x < c.width; ++x) {
        const int i = y * c.width + x;
        if (x + 1 < c.width) add(i, i + 1, c.gx[static_cast<std::size_t>(p * n + i)]);
        if (y + 1 < c.height) add(i, i + c.width, c.gy[static_cast<std::size_t>(p * n + i)]);
        if (!inside(i)) a(i, i) = 1, b(i) = t[i];
      }
    const Eigen::VectorXd solution = a.ldlt().solve(b);
    for (int i = 0; i < n; ++i)
      if (inside(i)) f[static_cast<std::size_t>(p * n + i)] = solution(i);
  }
  return f;
}

Region frame_region(int width, int height) {
  Region region(static_cast<std::size_t>(width * height), 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (x == 0 || y == 0 || x == width - 1 || y == height - 1)
        region[static_cast<std::size_t>(y * width + x)] = 0;
  return region;
}

TEST(Poisson, MatchesADenseSolveOnRandomRegions) {
  const int sizes[][2] = {{1, 7}, {9, 1}, {5, 4}, {17, 11}, {12, 20}, {19, 19}};
  std::uint64_t seed = 1;
  for (const auto& size : sizes)
    for (const double fill : {0.3, 0.6, 0.9, 0.98}) {
      Case c = random_case(size[0], size[1], 2, fill, seed++);
      c.region[0] = 0;
      EXPECT_LT(distance(solve(c), solve_dense(c)), 1e-9) << c.width << 'x' << c.height;
    }
}

TEST(Poisson, ReachesSmallResidualsOnIrregularRegions) {
  for (const double fill : {0.5, 0.8, 0.95, 0.999, 1.0}) {
    const Case c = random_case(61, 50, 3, fill, 7);
    PoissonReport report;
    const Values f = solve(c, 1e-10, &report);
    EXPECT_LE(report.relative_residual, 1.01e-10) << fill;
    EXPECT_GT(report.relative_residual, 0) << fill;
    EXPECT_LT(report.iterations, 20) << fill;
    EXPECT_EQ(report.free_components, fill == 1.0 ? 1 : 0);
    const std::size_t n = c.size();
    for (std::size_t i = 0; i < f.size(); ++i) {
      if (c.region[i % n] == 0) {
        ASSERT_EQ(f[i], c.target[i]);
      }
    }
  }
}

TEST(Poisson, ThinCorridorsConverge) {
  Case c = random_case(60, 60, 1, 0, 3);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 60; ++x)
      if (y % 2 == 0 || x == (y % 4 == 1 ? 0 : 59))
        c.region[static_cast<std::size_t>(y * 60 + x)] = 1;
  PoissonReport report;
  solve(c, 1e-10, &report);
  EXPECT_LE(report.relative_residual, 1.01e-10);
  EXPECT_LT(report.iterations, 20);
}

TEST(Poisson, GradientsOfAShiftedTargetGiveTheTarget) {
  Case c = random_case(40, 33, 2, 0.9, 5);
  Values start = c.target;
  make_gradients(c.width, c.height, c.planes, c.target, c.gx, c.gy);
  EXPECT_EQ(solve(c), start);  // nothing to do
  // From a start that is wrong inside the region only.
  Rng rng = make_rng(6);
  for (std::size_t i = 0; i < start.size(); ++i)
    if (c.region[i % c.size()] != 0) c.target[i] += sample_normal(rng);
  EXPECT_GT(distance(c.target, start), 1);
  EXPECT_LT(distance(solve(c), start), 1e-8);
}

TEST(Poisson, WithoutGradientsTheFillIsHarmonicAndBounded) {
  Case c = random_case(45, 38, 1, 0.97, 11);
  c.gx.assign(c.target.size(), 0.0);
  c.gy.assign(c.target.size(), 0.0);
  double low = 1e9, high = -1e9;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.region[i] == 0) low = std::min(low, c.target[i]), high = std::max(high, c.target[i]);
  const Values f = solve(c);
  for (int y = 1; y + 1 < c.height; ++y)
    for (int x = 1; x + 1 < c.width; ++x) {
      const auto i = static_cast<std::size_t>(y * c.width + x);
      if (c.region[i] == 0) continue;
      EXPECT_NEAR(4 * f[i], f[i - 1] + f[i + 1] + f[i - 45] + f[i + 45], 1e-9);
      EXPECT_TRUE(f[i] >= low - 1e-9 && f[i] <= high + 1e-9);
    }
}

TEST(Poisson, RampsAreExact) {
  Case c = random_case(50, 31, 2, 1, 13);
  c.region = frame_region(50, 31);
  Values ramp(c.target.size());
  for (int p = 0; p < 2; ++p)
    for (int y = 0; y < 31; ++y)
      for (int x = 0; x < 50; ++x)
        ramp[static_cast<std::size_t>((p * 31 + y) * 50 + x)] = 0.3 * x - (p + 1) * 0.7 * y + 2;
  for (std::size_t i = 0; i < ramp.size(); ++i)
    if (c.region[i % c.size()] == 0) c.target[i] = ramp[i];
  c.gx.assign(ramp.size(), 0.0);  // div of a constant field is 0: any slope may be asked for
  c.gy.assign(ramp.size(), 0.0);
  EXPECT_LT(distance(solve(c), ramp), 1e-9);
  c.gx.assign(ramp.size(), 5.0);
  EXPECT_LT(distance(solve(c), ramp), 1e-8);
}

// Discrete Neumann modes cos(πk(x+½)/W) cos(πl(y+½)/H) are eigenvectors: Δf = λ f, λ = 2cos(πk/W)
// + 2cos(πl/H) - 4; gradients of the mode divided by λ give the mode of λ⁻¹.
TEST(Poisson, WholeImageSolvesForACosineModeAndKeepsTheMean) {
  const int w = 48, h = 37, k = 3, l = 2;
  Case c = random_case(w, h, 1, 1, 17);
  c.region.assign(c.size(), 1);
  const double pi = std::acos(-1.0);
  const double lambda = 2 * std::cos(pi * k / w) + 2 * std::cos(pi * l / h) - 4;
  Values mode(c.size());
  double mean = 0;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      mode[static_cast<std::size_t>(y * w + x)] =
          std::cos(pi * k * (x + 0.5) / w) * std::cos(pi * l * (y + 0.5) / h);
  for (const double value : c.target) mean += value / static_cast<double>(c.size());
  // A field whose divergence is the mode, all of it along x: running sums of the mode.
  c.gy.assign(c.size(), 0.0);
  for (int y = 0; y < h; ++y) {
    double sum = 0;
    for (int x = 0; x < w; ++x) {
      sum += mode[static_cast<std::size_t>(y * w + x)];
      c.gx[static_cast<std::size_t>(y * w + x)] = sum;
    }
  }
  PoissonReport report;
  Values expected = mode;
  for (double& value : expected) value = value / lambda + mean;
  EXPECT_LT(distance(solve(c, 1e-12, &report), expected), 1e-8 / std::abs(lambda));
  EXPECT_EQ(report.free_components, 1);
}

TEST(Poisson, WholeImagesOfAnyShapeAreSolvedAndKeepTheirMeans) {
  const int sizes[][2] = {{2, 1}, {6, 5}, {8, 8}, {1, 90}, {90, 1}, {2, 70}, {65, 3}, {33, 34}};
  std::uint64_t seed = 61;
  for (const auto& size : sizes) {
    Case c = random_case(size[0], size[1], 2, 1, seed++);
    c.region.assign(c.size(), 1);
    PoissonReport report;
    const Values f = solve(c, 1e-10, &report);
    EXPECT_LE(report.relative_residual, 2e-10) << size[0] << 'x' << size[1];
    EXPECT_LT(report.iterations, 25) << size[0] << 'x' << size[1];
    for (std::size_t p = 0; p < 2; ++p) {
      double change = 0;
      for (std::size_t i = p * c.size(); i < (p + 1) * c.size(); ++i) change += f[i] - c.target[i];
      EXPECT_NEAR(change / static_cast<double>(c.size()), 0, 1e-12);
    }
  }
}

TEST(Poisson, BordersOfTheImageAreNeumann) {
  // Zero gradients, only the left column given: each row of pixels copies nothing but constants.
  Case c = random_case(23, 16, 1, 1, 19);
  c.region.assign(c.size(), 1);
  c.gx.assign(c.size(), 0.0);
  c.gy.assign(c.size(), 0.0);
  for (std::size_t i = 0; i < c.size(); i += 23) c.region[i] = 0, c.target[i] = 4;
  const Values f = solve(c);
  for (const double value : f) EXPECT_NEAR(value, 4, 1e-9);
  // A wanted slope along x is then followed to the right border.
  c.gx.assign(c.size(), 0.5);
  const Values g = solve(c);
  for (std::size_t i = 0; i < c.size(); ++i)
    EXPECT_NEAR(g[i], 4 + 0.5 * static_cast<double>(i % 23), 1e-8);
}

TEST(Poisson, OnePixelIsTheMeanOfItsNeighboursAndTheirDifferences) {
  Case c = random_case(5, 5, 1, 0, 23);
  c.region[12] = 1;
  const Values& t = c.target;
  const double expected =
      0.25 * ((t[11] + c.gx[11]) + (t[13] - c.gx[12]) + (t[7] + c.gy[7]) + (t[17] - c.gy[12]));
  EXPECT_NEAR(solve(c)[12], expected, 1e-12);
  c.region[12] = 0;
  c.region[24] = 1;  // a corner: two neighbours
  EXPECT_NEAR(solve(c)[24], 0.5 * ((t[23] + c.gx[23]) + (t[19] + c.gy[19])), 1e-12);
}

TEST(Poisson, SeparateComponentsDoNotInteract) {
  Case c = random_case(30, 20, 1, 0, 29);
  Case left = c, both = c;
  for (int y = 2; y < 18; ++y)
    for (int x = 0; x < 30; ++x) {
      const auto i = static_cast<std::size_t>(y * 30 + x);
      if (x < 14) left.region[i] = both.region[i] = 1;
      if (x > 14) both.region[i] = 1;
    }
  const Values a = solve(left), b = solve(both);
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (i % 30 < 14) {
      EXPECT_NEAR(a[i], b[i], 1e-9);
    }
  }
}

TEST(Poisson, EmptyRegionsAndSinglePixelsAreLeftAlone) {
  Case c = random_case(6, 5, 2, 0, 31);
  c.target[3] = std::numeric_limits<double>::quiet_NaN();  // out of reach
  PoissonReport report;
  const Values f = solve(c, 1e-6, &report);
  EXPECT_TRUE(std::isnan(f[3]));
  EXPECT_EQ(report.iterations, 0);
  const Case one{1, 1, 1, {1}, {2.5}, {0}, {0}};
  EXPECT_EQ(solve(one), Values{2.5});
}

TEST(Poisson, IsEquivariantUnderScales) {
  const Case c = random_case(24, 26, 1, 0.9, 37);
  const Values f = solve(c);
  for (const double scale : {0x1p-900, 0x1p+900}) {
    Case d = c;
    for (Values* values : {&d.target, &d.gx, &d.gy})
      for (double& value : *values) value *= scale;
    Values g = solve(d);
    for (double& value : g) value /= scale;
    EXPECT_LT(distance(f, g), 1e-10);
  }
}

TEST(Poisson, SameBitsForAnyNumberOfThreads) {
  const Case c = random_case(150, 90, 6, 0.98, 41);
  Values one, two;
  {
    const ThreadLimit limit(1);
    one = solve(c, 1e-8);
  }
  {
    const ThreadLimit limit(2);
    two = solve(c, 1e-8);
  }
  EXPECT_EQ(one, two);
}

TEST(Poisson, ReportsTheResidualWhereIterationsEnd) {
  const Case c = random_case(40, 40, 1, 0.999, 43);
  PoissonReport report;
  solve_poisson(40, 40, 1, c.region, c.target, c.gx, c.gy,
                {.tolerance = 1e-12, .max_iterations = 2}, &report);
  EXPECT_EQ(report.iterations, 2);
  EXPECT_GT(report.relative_residual, 1e-8);
  EXPECT_LT(report.relative_residual, 0.5);
}

std::string error_of(const Case& c, const PoissonParams& params = {}) {
  return parian::error_of(
      [&] { solve_poisson(c.width, c.height, c.planes, c.region, c.target, c.gx, c.gy, params); });
}

TEST(Poisson, NamesValuesThatAreNotNumbers) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Case c = random_case(8, 8, 2, 0, 47);
  c.region[static_cast<std::size_t>(3 * 8 + 4)] = 1;
  Case bad = c;
  bad.target[static_cast<std::size_t>(64 + 3 * 8 + 5)] = nan;
  EXPECT_EQ(error_of(bad),
            "target, plane 1, pixel (5, 3): expected a number of magnitude at most 1e300, "
            "found nan");
  bad = c;
  bad.gx[static_cast<std::size_t>(3 * 8 + 3)] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(error_of(bad),
            "gradient x, plane 0, pixel (3, 3): expected a number of magnitude at most 1e300, "
            "found inf");
  bad = c;
  bad.gy[static_cast<std::size_t>(2 * 8 + 4)] = -1e301;
  EXPECT_EQ(error_of(bad),
            "gradient y, plane 0, pixel (4, 2): expected a number of magnitude at most 1e300, "
            "found -1e+301");
  bad = c;  // out of reach
  bad.gy[static_cast<std::size_t>(3 * 8 + 5)] = bad.target[0] = nan;
  EXPECT_EQ(error_of(bad), "no error");
  EXPECT_NE(error_of(c, {.tolerance = nan}), "no error");
  EXPECT_NE(error_of(c, {.max_iterations = 0}), "no error");
}

TEST(Poisson, MixedGradientsKeepTheLarger) {
  Values gx = {1, -2, 3}, gy = {0, 0, -5};
  mix_gradients({-2, 1, -3}, {0.5, 0, 4}, gx, gy);
  EXPECT_EQ(gx, (Values{-2, -2, 3}));
  EXPECT_EQ(gy, (Values{0.5, 0, -5}));
}

TEST(Poisson, GradientsAreForwardDifferences) {
  Values gx, gy;
  make_gradients(2, 2, 2, {1, 4, 9, 16, 0, 1, 0, 3}, gx, gy);
  EXPECT_EQ(gx, (Values{3, 0, 7, 0, 1, 0, 3, 0}));
  EXPECT_EQ(gy, (Values{8, 12, 0, 0, 0, 2, 0, 0}));
}

}  // namespace
}  // namespace parian

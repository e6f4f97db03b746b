#include "edit/filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "base/test_errors.h"

namespace parian {
namespace {

using Planes = std::vector<float>;

Planes random_planes(int width, int height, int planes, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  Planes values(static_cast<std::size_t>(width * height * planes));
  for (float& value : values) value = static_cast<float>(sample_normal(rng));
  return values;
}

Planes gaussian(const Planes& in, int width, int height, double sigma) {
  Planes out(in.size());
  const auto pixels = static_cast<std::size_t>(width * height);
  for (std::size_t p = 0; p * pixels < in.size(); ++p)
    gaussian_filter(in.data() + p * pixels, width, height, sigma, out.data() + p * pixels);
  return out;
}

double mean(const Planes& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value);
  return sum / static_cast<double>(values.size());
}

double distance(const Planes& a, const Planes& b) {
  double worst = a.size() == b.size() ? 0 : 1e9;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    worst = std::max(worst, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
  return worst;
}

Planes flip(const Planes& in, int width) {
  Planes out = in;
  for (std::size_t row = 0; row < in.size(); row += static_cast<std::size_t>(width))
    std::reverse(out.begin() + static_cast<std::ptrdiff_t>(row),
                 out.begin() + static_cast<std::ptrdiff_t>(row) + width);
  return out;
}

Planes transpose(const Planes& in, int width, int height) {
  Planes out(in.size());
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  for (std::size_t i = 0; i < in.size(); ++i)
    out[i / (w * h) * (w * h) + i % w * h + i / w % h] = in[i];
  return out;
}

int mirror(int i, int n) {
  while (i < 0 || i >= n) i = i < 0 ? -1 - i : 2 * n - 1 - i;
  return i;
}

// The definition, in double, tap by tap.
Planes naive_bilateral(const Planes& planes, int count, const Planes& guide, int guides, int width,
                       int height, double sigma, double range, int step = 1) {
  const int radius = static_cast<int>(std::ceil(3 * sigma)) / step * step;
  Planes out(planes.size());
  const auto at = [&](int p, int x, int y) {
    return static_cast<std::size_t>((p * height + mirror(y, height)) * width + mirror(x, width));
  };
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      std::vector<double> sums(static_cast<std::size_t>(count) + 1);
      for (int dy = -radius; dy <= radius; dy += step)
        for (int dx = -radius; dx <= radius; dx += step) {
          double exponent = sigma > 0 ? (dx * dx + dy * dy) / (2 * sigma * sigma) : 0.0;
          for (int g = 0; g < guides; ++g) {
            const double d = static_cast<double>(guide[at(g, x, y)]) -
                             static_cast<double>(guide[at(g, x + dx, y + dy)]);
            exponent += d * d / (2 * range * range);
          }
          const double weight = std::exp(-exponent);
          sums.back() += weight;
          for (int p = 0; p < count; ++p)
            sums[static_cast<std::size_t>(p)] +=
                weight * static_cast<double>(planes[at(p, x + dx, y + dy)]);
        }
      for (int p = 0; p < count; ++p)
        out[at(p, x, y)] = static_cast<float>(sums[static_cast<std::size_t>(p)] / sums.back());
    }
  return out;
}

TEST(Filter, MatchesTheDefinition) {
  const struct {
    int width, height;
    double sigma, range;
  } cases[] = {{13, 9, 1.3, 0.7}, {40, 7, 2, 1.5}, {33, 5, 0.2, 1}, {3, 11, 3, 0.4},
               {1, 6, 2.5, 1},    {64, 1, 4, 2},   {5, 4, 5, 3},    {1, 1, 1, 1}};
  std::uint64_t seed = 1;
  for (const auto& c : cases) {
    const Planes planes = random_planes(c.width, c.height, 2, seed++);
    const Planes guide = random_planes(c.width, c.height, 3, seed++);
    EXPECT_LT(distance(bilateral_filter(planes, 2, guide, 3, c.width, c.height, c.sigma, c.range),
                       naive_bilateral(planes, 2, guide, 3, c.width, c.height, c.sigma, c.range)),
              3e-6)
        << c.width << 'x' << c.height;
    EXPECT_LT(distance(gaussian(planes, c.width, c.height, c.sigma),
                       naive_bilateral(planes, 2, guide, 3, c.width, c.height, c.sigma, 1e30)),
              2e-6)
        << c.width << 'x' << c.height;
  }
}

TEST(Filter, WideWindowsTakeEveryNthPixel) {
  const Planes planes = random_planes(36, 2, 1, 21);
  // 3 sigma = 51 > 48: every second pixel; 108: every third. Both reach beyond the reflections.
  const Planes out = bilateral_filter(planes, 1, planes, 1, 36, 2, 17, 0.8);
  EXPECT_LT(distance(out, naive_bilateral(planes, 1, planes, 1, 36, 2, 17, 0.8, 2)), 3e-6);
  const Planes largest = bilateral_filter(planes, 1, planes, 1, 36, 2, 36, 0.8);
  EXPECT_LT(distance(largest, naive_bilateral(planes, 1, planes, 1, 36, 2, 36, 0.8, 3)), 3e-6);
}

TEST(Filter, GaussianOfAnImpulse) {
  const int n = 41;
  const double sigma = 4;
  Planes impulse(n * n);
  impulse[20 * n + 20] = 1;
  double total = 0;
  for (int k = -12; k <= 12; ++k) total += std::exp(-k * k / (2 * sigma * sigma));
  const Planes out = gaussian(impulse, n, n, sigma);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int dx = x - 20, dy = y - 20;
      const double exact =
          std::abs(dx) <= 12 && std::abs(dy) <= 12
              ? std::exp(-(dx * dx + dy * dy) / (2 * sigma * sigma)) / (total * total)
              : 0.0;
      ASSERT_NEAR(static_cast<double>(out[static_cast<std::size_t>(y * n + x)]), exact, 1e-8);
    }
}

TEST(Filter, GaussianDampsReflectedCosines) {
  // cos(πk(x+½)/W) is continued by reflection: an eigenvector of any symmetric filter.
  const int width = 30, k = 3;
  const double sigma = 2.5, omega = std::acos(-1.0) * k / width;
  double factor = 0, total = 0;
  for (int x = -8; x <= 8; ++x) {
    factor += std::exp(-x * x / (2 * sigma * sigma)) * std::cos(omega * x);
    total += std::exp(-x * x / (2 * sigma * sigma));
  }
  Planes mode;
  mode.reserve(width);
  for (int x = 0; x < width; ++x) mode.push_back(static_cast<float>(std::cos(omega * (x + 0.5))));
  const Planes out = gaussian(mode, width, 1, sigma);
  for (std::size_t x = 0; x < mode.size(); ++x)
    EXPECT_NEAR(static_cast<double>(out[x]), factor / total * static_cast<double>(mode[x]), 1e-6);
}

TEST(Filter, ConstantsAndMeansStay) {
  for (const double sigma : {0.0, 0.7, 3.0, 19.0, 37.0}) {
    const Planes constant(37 * 22, 0.37f), noise = random_planes(37, 22, 1, 31);
    EXPECT_LT(distance(gaussian(constant, 37, 22, sigma), constant), 1e-6);
    EXPECT_EQ(bilateral_filter(constant, 1, noise, 1, 37, 22, sigma, 0.5), constant);
    EXPECT_LT(distance(unsharp(constant, 1, 37, 22, sigma, 2), constant), 2e-6);
    EXPECT_NEAR(mean(gaussian(noise, 37, 22, sigma)), mean(noise), 2e-7);
    EXPECT_NEAR(mean(unsharp(noise, 1, 37, 22, sigma, 1.5)), mean(noise), 5e-7);
  }
}

TEST(Filter, SigmaZeroCopies) {
  const Planes planes = random_planes(9, 8, 2, 41);
  EXPECT_EQ(gaussian(planes, 9, 8, 0), planes);
  EXPECT_EQ(bilateral_filter(planes, 2, planes, 2, 9, 8, 0, 1), planes);
  EXPECT_EQ(unsharp(planes, 2, 9, 8, 0, 3), planes);
  EXPECT_EQ(bilateral_filter(planes, 2, planes, 2, 9, 8, 1e-300, 1), planes);
  EXPECT_EQ(gaussian(planes, 9, 8, 1e-300), planes);
}

TEST(Filter, BilateralGrowsIntoTheGaussianAndShrinksToTheIdentity) {
  const Planes planes = random_planes(45, 31, 3, 51);
  const Planes smooth = gaussian(planes, 45, 31, 3);
  const auto filtered = [&](double range) {
    return bilateral_filter(planes, 3, planes, 3, 45, 31, 3, range);
  };
  EXPECT_LT(distance(filtered(1e6), smooth), 2e-6);
  EXPECT_LT(distance(filtered(1e300), smooth), 2e-6);
  EXPECT_GT(distance(filtered(3), smooth), 1e-2);
  EXPECT_LT(distance(filtered(1e-4), planes), 1e-6);
  EXPECT_EQ(filtered(1e-300), planes);
}

TEST(Filter, BilateralKeepsAStepThatTheGaussianBlurs) {
  const int width = 40, height = 12;
  Planes step = random_planes(width, height, 1, 61);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      float& value = step[static_cast<std::size_t>(y * width + x)];
      value = 0.02f * value + (x < width / 2 ? 0.0f : 1.0f);
    }
  const Planes kept = bilateral_filter(step, 1, step, 1, width, height, 4, 0.1);
  const Planes blurred = gaussian(step, width, height, 4);
  double worst = 0;
  for (std::size_t i = 0; i < step.size(); ++i)
    worst = std::max(worst, std::abs(static_cast<double>(kept[i]) -
                                     (static_cast<int>(i % width) < width / 2 ? 0.0 : 1.0)));
  EXPECT_LT(worst, 0.012);  // smoothed within both sides
  EXPECT_GT(blurred[width / 2 - 1], 0.3f);
}

TEST(Filter, OneWeightForAllPlanesFollowsTheGuideAlone) {
  const Planes guide = random_planes(20, 17, 2, 71), a = random_planes(20, 17, 1, 72),
               b = random_planes(20, 17, 1, 73);
  const auto filtered = [&](const Planes& planes, int count) {
    return bilateral_filter(planes, count, guide, 2, 20, 17, 2, 0.6);
  };
  Planes sum = a, both = a;
  for (std::size_t i = 0; i < a.size(); ++i) sum[i] = 2 * a[i] - 3 * b[i];
  both.insert(both.end(), b.begin(), b.end());
  Planes expected = filtered(a, 1);
  const Planes second = filtered(b, 1);
  Planes joined = expected;
  joined.insert(joined.end(), second.begin(), second.end());
  EXPECT_EQ(filtered(both, 2), joined);
  for (std::size_t i = 0; i < a.size(); ++i) expected[i] = 2 * expected[i] - 3 * second[i];
  EXPECT_LT(distance(filtered(sum, 1), expected), 1e-5);
}

TEST(Filter, CommutesWithFlipsAndTranspositions) {
  const int width = 35, height = 21;
  const Planes planes = random_planes(width, height, 2, 81),
               guide = random_planes(width, height, 1, 82);
  const Planes straight = bilateral_filter(planes, 2, guide, 1, width, height, 2.2, 0.9);
  EXPECT_LT(distance(flip(bilateral_filter(flip(planes, width), 2, flip(guide, width), 1, width,
                                           height, 2.2, 0.9),
                          width),
                     straight),
            1e-6);
  EXPECT_LT(distance(transpose(bilateral_filter(transpose(planes, width, height), 2,
                                                transpose(guide, width, height), 1, height, width,
                                                2.2, 0.9),
                               height, width),
                     straight),
            1e-6);
  const Planes smooth = gaussian(planes, width, height, 5);
  EXPECT_EQ(flip(gaussian(flip(planes, width), width, height, 5), width), smooth);
  EXPECT_LT(distance(transpose(gaussian(transpose(planes, width, height), height, width, 5), height,
                               width),
                     smooth),
            1e-6);
}

TEST(Filter, UnsharpOfMinusOneIsTheGaussian) {
  const Planes planes = random_planes(50, 30, 2, 91), smooth = gaussian(planes, 50, 30, 2);
  EXPECT_LT(distance(unsharp(planes, 2, 50, 30, 2, -1), smooth), 1e-6);
  EXPECT_EQ(unsharp(planes, 2, 50, 30, 2, 0), planes);
  Planes expected = planes;
  for (std::size_t i = 0; i < planes.size(); ++i)
    expected[i] = planes[i] + 0.75f * (planes[i] - smooth[i]);
  EXPECT_EQ(unsharp(planes, 2, 50, 30, 2, 0.75), expected);
}

TEST(Filter, SameBitsForAnyNumberOfThreads) {
  const Planes planes = random_planes(70, 45, 2, 101);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    Planes out = bilateral_filter(planes, 2, planes, 2, 70, 45, 2, 1);
    const Planes sharp = unsharp(planes, 2, 70, 45, 6, 2);
    out.insert(out.end(), sharp.begin(), sharp.end());
    return out;
  };
  EXPECT_EQ(run(1), run(2));
}

TEST(Filter, GaussianWorksInPlace) {
  Planes planes = random_planes(31, 18, 1, 111);
  const Planes expected = gaussian(planes, 31, 18, 3);
  gaussian_filter(planes.data(), 31, 18, 3, planes.data());
  EXPECT_EQ(planes, expected);
}

TEST(Filter, RejectsBadParametersAndValues) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const Planes planes = random_planes(6, 4, 2, 121);
  const auto bilateral = [&](const Planes& values, const Planes& guide, double sigma,
                             double range) {
    return error_of([&] { bilateral_filter(values, 2, guide, 2, 6, 4, sigma, range); });
  };
  EXPECT_EQ(bilateral(planes, planes, 6, 1), "no error");
  EXPECT_EQ(bilateral(planes, planes, 6.5, 1),
            "sigma-px: expected a number in [0, 6], the larger side of the image, found 6.5");
  EXPECT_EQ(bilateral(planes, planes, nan, 1),
            "sigma-px: expected a number in [0, 6], the larger side of the image, found nan");
  EXPECT_EQ(bilateral(planes, planes, 1, 0), "sigma-range: expected a number > 0, found 0");
  EXPECT_EQ(bilateral(planes, planes, 1, inf), "sigma-range: expected a number > 0, found inf");
  Planes bad = planes;
  bad[24 + 8] = static_cast<float>(nan);
  EXPECT_EQ(
      bilateral(bad, planes, 1, 1),
      "values, plane 1, pixel (2, 1): expected a number of magnitude at most 1e30, found nan");
  EXPECT_EQ(bilateral(planes, bad, 1, 1),
            "guide, plane 1, pixel (2, 1): expected a number of magnitude at most 1e30, found nan");
  EXPECT_EQ(error_of([&] { unsharp(planes, 2, 6, 4, 1, nan); }),
            "amount: expected a number in [-1e6, 1e6], found nan");
  EXPECT_EQ(error_of([&] { unsharp(planes, 2, 6, 4, -1, 1); }),
            "sigma-px: expected a number in [0, 6], the larger side of the image, found -1");
  EXPECT_NE(error_of([&] { unsharp(bad, 2, 6, 4, 1, 1); }), "no error");
  EXPECT_NE(error_of([&] {
              Planes out(24);
              gaussian_filter(bad.data() + 24, 6, 4, 1, out.data());
            }),
            "");
}

// Values at the limits stay finite.
TEST(Filter, LargeValuesStayFinite) {
  Planes planes = random_planes(12, 9, 1, 131);
  for (float& value : planes) value = value > 0 ? 1e30f : -1e30f;
  for (const double range : {1e-300, 1.0, 1e300})
    for (const float value : bilateral_filter(planes, 1, planes, 1, 12, 9, 2, range))
      ASSERT_LE(std::abs(value), 1.01e30f);
  for (const float value : unsharp(planes, 1, 12, 9, 2, 1e6)) ASSERT_TRUE(std::isfinite(value));
}

}  // namespace
}  // namespace parian

#include "edit/features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "base/test_errors.h"
#include "material/bssrdf_table.h"
#include "material/profile_map.h"

namespace parian {
namespace {

constexpr double knot_pitch = 0.1;

std::vector<double> some_knots(int count) {
  std::vector<double> knots;
  knots.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) knots.push_back(knot_pitch * k);
  return knots;
}

// Sums of two exponentials, as media have: smooth, at most a factor of e per segment.
ProfileMap random_map(int width, int height, int channels, std::uint64_t seed) {
  ProfileMap map = make_profile_map(width, height, channels, 0.1, some_knots(25));
  Rng rng = make_rng(seed);
  for (int c = 0; c < channels; ++c) {
    for (std::size_t i = 0; i < map.pixels(); ++i) {
      const double a = 2 + 6 * sample_uniform(rng), b = 0.5 + sample_uniform(rng);
      const double wa = sample_uniform(rng), wb = 0.3 * sample_uniform(rng);
      for (int k = 0; k < 25; ++k)
        knot_plane(map, c, k)[i] = static_cast<float>(
            std::log(wa * std::exp(-a * map.knots_mm[static_cast<std::size_t>(k)]) +
                     wb * std::exp(-b * map.knots_mm[static_cast<std::size_t>(k)])));
    }
  }
  return map;
}

double integral_of_product(const Profile& a, const Profile& b, double r0, double r1) {
  if (r1 > a.support_mm || r1 > b.support_mm) return 0;
  return segment_integral(r0, r1 - r0, eval_log_profile(a, r0) + eval_log_profile(b, r0),
                          eval_log_profile(a, r1) + eval_log_profile(b, r1));
}

// Eq. 11 for one channel: d^2 = integral of (P_a - P_b)^2 r dr over both supports, in 1/mm^2.
double profile_distance_squared(const Profile& a, const Profile& b) {
  std::vector<double> cuts = a.knots_mm;
  cuts.insert(cuts.end(), b.knots_mm.begin(), b.knots_mm.end());
  cuts.push_back(a.support_mm);
  cuts.push_back(b.support_mm);
  std::sort(cuts.begin(), cuts.end());
  double sum = 0;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double r0 = cuts[k], r1 = cuts[k + 1];
    if (!(r1 > r0)) continue;
    sum += integral_of_product(a, a, r0, r1) - 2 * integral_of_product(a, b, r0, r1) +
           integral_of_product(b, b, r0, r1);
  }
  return std::max(0.0, sum);
}

double map_distance_squared(const ProfileMap& map, std::size_t a, std::size_t b) {
  const auto width = static_cast<std::size_t>(map.width);
  const auto profile = [&](int c, std::size_t i) {
    return get_profile(map, c, static_cast<int>(i % width), static_cast<int>(i / width));
  };
  double sum = 0;
  for (int c = 0; c < map.channels; ++c)
    sum += profile_distance_squared(profile(c, a), profile(c, b));
  return sum;
}

double mean_pair_distance(const Features& features) {
  double sum = 0;
  for (std::size_t a = 0; a < features.pixels(); ++a)
    for (std::size_t b = 0; b < features.pixels(); ++b)
      sum += feature_distance_squared(features, a, b);
  return sum / static_cast<double>(features.pixels() * features.pixels());
}

// Largest relative error of the features' distances against the closed form, common scale removed.
double embedding_error(const ProfileMap& map, const Features& features) {
  double exact = 0, embedded = 0, worst = 0;
  for (std::size_t a = 0; a < map.pixels(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      exact += map_distance_squared(map, a, b);
      embedded += feature_distance_squared(features, a, b);
    }
  const double scale = exact / embedded;
  for (std::size_t a = 0; a < map.pixels(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const double d = map_distance_squared(map, a, b);
      worst = std::max(worst, std::abs(scale * feature_distance_squared(features, a, b) / d - 1));
    }
  }
  return worst;
}

TEST(ProfileDistance, TwoExponentials) {
  // P = A e^{-a r}: both supports end at e^-9.2 of the top, so the tails cost 1e-7.
  const std::vector<double> knots = some_knots(61);
  const auto exponential = [&](double top, double slope) {
    std::vector<double> values;
    values.reserve(knots.size());
    for (const double r : knots) values.push_back(std::log(top) - slope * r);
    return make_profile(knots, values);
  };
  const double d2 = profile_distance_squared(exponential(2, 3), exponential(0.7, 2));
  const double exact = 4.0 / 36 - 2 * 2 * 0.7 / 25 + 0.49 / 16;
  EXPECT_NEAR(d2, exact, 1e-6 * exact);
}

TEST(ProfileDistance, IsAMetricSquaredAndMatchesSummation) {
  ProfileMap map = random_map(3, 1, 1, 4);
  map.gain = {1, 2, 0.5F};
  map.dilation = {1, 1.3F, 0.8F};
  const Profile a = get_profile(map, 0, 0, 0), b = get_profile(map, 0, 1, 0),
                c = get_profile(map, 0, 2, 0);
  EXPECT_EQ(profile_distance_squared(a, a), 0);
  const double ab = profile_distance_squared(a, b);
  EXPECT_NEAR(profile_distance_squared(b, a), ab, 1e-14 * ab);
  EXPECT_LE(std::sqrt(ab),
            std::sqrt(profile_distance_squared(a, c)) + std::sqrt(profile_distance_squared(c, b)));
  double sum = 0;
  const double step = 1e-4;
  for (double r = step / 2; r < std::max(a.support_mm, b.support_mm); r += step) {
    const double d = std::exp(eval_log_profile(a, r)) - std::exp(eval_log_profile(b, r));
    sum += d * d * r * step;
  }
  EXPECT_NEAR(ab, sum, 1e-4 * sum);
}

TEST(Features, EmbedTheProfileDistance) {
  const ProfileMap map = random_map(6, 4, 3, 1);
  const Features features = make_profile_features(map, 64);
  EXPECT_LT(embedding_error(map, features), 0.02);
  EXPECT_NEAR(mean_pair_distance(features), 1, 1e-5);
}

TEST(Features, EmbedGainAndDilation) {
  ProfileMap map = random_map(6, 4, 1, 2);
  Rng rng = make_rng(7);
  for (std::size_t i = 0; i < map.pixels(); ++i) {
    map.gain.push_back(static_cast<float>(0.2 + 2 * sample_uniform(rng)));
    map.dilation.push_back(static_cast<float>(0.7 + 0.8 * sample_uniform(rng)));
  }
  EXPECT_LT(embedding_error(map, make_profile_features(map, 64)), 0.03);
  ProfileMap plain = map;
  plain.dilation.clear();
  ProfileMap unit = map;
  unit.dilation.assign(map.pixels(), 1.0F);
  const Features a = make_profile_features(plain), b = make_profile_features(unit);
  ASSERT_EQ(a.values.size(), b.values.size());
  for (std::size_t i = 0; i < a.values.size(); ++i) EXPECT_NEAR(a.values[i], b.values[i], 2e-5);
}

TEST(Features, DoNotDependOnTheUnitsOfLengthAndLight) {
  ProfileMap map = random_map(7, 5, 1, 3);
  const Features before = make_profile_features(map);
  for (double& r : map.knots_mm) r *= 1000;
  for (float& y : map.log_profile) y += 200;
  const Features after = make_profile_features(map);
  ASSERT_EQ(before.values.size(), after.values.size());
  for (std::size_t i = 0; i < before.values.size(); ++i)
    EXPECT_NEAR(before.values[i], after.values[i], 1e-3);
}

TEST(Features, LogProfilesIgnoreGainAlikeInAllPixels) {
  ProfileMap map = random_map(7, 5, 3, 3);
  const Features before = make_log_profile_features(map);
  for (std::size_t i = 0; i < map.log_profile.size() / 3; ++i) map.log_profile[i] -= 2;
  const Features after = make_log_profile_features(map);  // a dark channel counts as much
  ASSERT_EQ(before.values.size(), after.values.size());
  for (std::size_t i = 0; i < before.values.size(); ++i)
    EXPECT_NEAR(before.values[i], after.values[i], 1e-3);
  EXPECT_NEAR(mean_pair_distance(after), 1, 1e-5);
}

TEST(Features, PrincipalComponentsKeepDistancesAndOrder) {
  Rng rng = make_rng(5);
  std::vector<float> raw(40 * 5);
  for (std::size_t i = 0; i < raw.size(); ++i)
    raw[i] = static_cast<float>(sample_normal(rng) * static_cast<double>(1 + i % 5));
  const Features all = make_features(8, 5, 5, raw, 9);
  ASSERT_EQ(all.dims, 5);
  double ratio = 0;
  for (std::size_t a = 1; a < 40; ++a) {
    double d2 = 0;
    for (std::size_t d = 0; d < 5; ++d)
      d2 += std::pow(static_cast<double>(raw[a * 5 + d]) - static_cast<double>(raw[d]), 2);
    const double now = feature_distance_squared(all, a, 0) / d2;
    if (a > 1) {
      EXPECT_NEAR(now, ratio, 1e-5 * ratio);
    }
    ratio = now;
  }
  const Features two = make_features(8, 5, 5, raw, 2);
  ASSERT_EQ(two.dims, 2);
  double variance[2] = {0, 0};
  for (std::size_t i = 0; i < 80; ++i) variance[i % 2] += std::pow(two.values[i], 2);
  EXPECT_GT(variance[0], variance[1]);
  EXPECT_NEAR(mean_pair_distance(two), 1, 1e-5);
}

TEST(Features, EqualPixelsAreAllZero) {
  const Features raw = make_features(4, 3, 2, std::vector<float>(24, 0.3F));
  for (const float v : raw.values) EXPECT_EQ(v, 0);
  const ProfileMap map = make_profile_map(4, 3, 3, 1, {0, 1, 2.5}, -0.7F);
  for (const float v : make_profile_features(map).values) EXPECT_EQ(v, 0);
  const Features one = make_features(1, 1, 1, {5});
  EXPECT_EQ(one.values, std::vector<float>{0});
}

TEST(Features, PropertiesCountAlikeWhateverTheirUnit) {
  const std::vector<float> planes = {1, 1, -1, -1, 1000, -1000, 1000, -1000};
  const Features features = make_property_features(2, 2, 2, planes);
  EXPECT_NEAR(feature_distance_squared(features, 0, 1), feature_distance_squared(features, 0, 2),
              1e-5);
}

TEST(Features, RejectsValuesThatAreNotFinite) {
  std::vector<float> raw(24, 0.0F);
  raw[2 * 7 + 1] = std::nanf("");
  EXPECT_EQ(error_of([&] { make_features(4, 3, 2, raw); }),
            "feature at pixel (3, 1): expected a finite value, found nan");
  EXPECT_THROW(make_property_features(4, 3, 2, raw), Error);
}

TEST(Features, BssrdfDistancesFollowTheTable) {
  TableHeader header{.width = 20, .height = 18, .channels = 1};
  header.offsets = half_disc_offsets(6);
  BssrdfTable table = make_bssrdf_table(header);
  // Left half bright, right half dark, R a product of the ends' values: symmetric.
  const auto value = [](int x) { return x < 10 ? 1.0F : 0.3F; };
  for (std::size_t i = 0; i < header.offsets.size(); ++i) {
    const Offset d = header.offsets[i];
    const PixelRange range = pairs_in_grid(header, d);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x)
        slice_of(table, 0, static_cast<int>(i))[y * 20 + x] = value(x) * value(x + d.dx);
  }
  const Features features = make_bssrdf_features(*make_slices(table, "t"), 24);
  const auto distance = [&](int xa, int xb) {
    return feature_distance_squared(features, static_cast<std::size_t>(9 * 20 + xa),
                                    static_cast<std::size_t>(9 * 20 + xb));
  };
  const auto exact = [&](int xa, int xb) {  // rows 3 to 14 are complete within radius 6
    double sum = 0;
    for (int dy = -6; dy <= 6; ++dy)
      for (int dx = -6; dx <= 6; ++dx) {
        if (dx * dx + dy * dy > 36) continue;
        const auto r = [&](int x) {
          return x + dx < 0 || x + dx >= 20 ? 0.0 : static_cast<double>(value(x) * value(x + dx));
        };
        sum += std::pow(r(xa) - r(xb), 2);
      }
    return sum;
  };
  const double scale = distance(7, 12) / exact(7, 12);
  EXPECT_GT(scale, 0);
  EXPECT_NEAR(distance(7, 9) / (scale * exact(7, 9)), 1, 0.6);
  EXPECT_NEAR(distance(10, 13) / (scale * exact(10, 13)), 1, 0.6);
  EXPECT_GT(distance(7, 9), 0);  // same profiles, other surroundings: why this distance is worse
}

TEST(Features, SameBitsForAnyThreads) {
  ProfileMap map = random_map(64, 40, 1, 9);
  std::vector<float> values[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    values[threads - 1] = make_profile_features(map).values;
  }
  EXPECT_EQ(values[0], values[1]);
}

}  // namespace
}  // namespace parian

#include "material/properties.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"

namespace parian {
namespace {

double uniform(Rng& rng, double from, double to) {
  return from + (to - from) * sample_uniform(rng);
}

// Non-increasing, with knots that widen; some end far below the threshold, others far above.
Profile random_profile(std::uint64_t seed, int knots = 12) {
  Rng random = make_rng(seed);
  std::vector<double> radii{0}, values{uniform(random, -6.0, 2.0)};
  const double drop = uniform(random, 0.05, 3.0);
  for (int k = 1; k < knots; ++k) {
    radii.push_back(radii.back() + uniform(random, 0.05, 0.5));
    values.push_back(values.back() - uniform(random, 0.0, drop));
  }
  return make_profile(radii, values, uniform(random, 0.5, 2.0), uniform(random, 0.5, 2.0));
}

void expect_same_profile(const Profile& a, const Profile& b, double tolerance) {
  ASSERT_EQ(a.knots_mm.size(), b.knots_mm.size());
  for (std::size_t k = 0; k < a.knots_mm.size(); ++k) {
    EXPECT_NEAR(a.knots_mm[k], b.knots_mm[k], tolerance * a.knots_mm.back());
    EXPECT_NEAR(a.log_value[k], b.log_value[k], tolerance);
  }
  EXPECT_NEAR(a.support_mm, b.support_mm, tolerance * a.support_mm);
}

TEST(Properties, ExponentialHasItsClosedForms) {
  const double rate = 3;
  Profile profile;
  for (int k = 0; k <= 40; ++k) {
    profile.knots_mm.push_back(0.1 * k);
    profile.log_value.push_back(-rate * profile.knots_mm.back());
  }
  profile.support_mm = profile_support(profile.knots_mm, profile.log_value);
  const ProfileProperties properties = measure_properties(profile);
  EXPECT_NEAR(properties.range_mm, -std::log(support_threshold) / rate, 1e-12);
  EXPECT_EQ(properties.range_kind, RangeKind::measured);
  // alpha = 4.605 mean radii (algorithms), for an integral cut at 12 / rate
  EXPECT_NEAR(properties.range_mm / properties.mean_radius_mm, 4.60517, 4e-3);
  EXPECT_NEAR(properties.albedo, 2 * std::numbers::pi / (rate * rate), 1e-4);
}

TEST(Properties, RangeIsFlaggedWhereTheWindowIsTooSmall) {
  const auto kind_of = [](double end) {
    RangeKind kind{};
    profile_range(make_profile({0, 1, 2}, {0, end / 2, end}), &kind);
    return kind;
  };
  EXPECT_EQ(kind_of(-12), RangeKind::measured);
  EXPECT_EQ(kind_of(-6), RangeKind::extrapolated);
  EXPECT_EQ(kind_of(-0.1), RangeKind::limited);
}

TEST(Properties, MeanRadiusAgreesWithQuadrature) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Profile profile = random_profile(seed);
    double mass = 0, moment = 0;
    const int steps = 200'000;
    const double h = profile.support_mm / steps;
    for (int i = 0; i < steps; ++i) {
      const double r = (i + 0.5) * h, p = std::exp(eval_log_profile(profile, r));
      mass += p * r * h;
      moment += p * r * r * h;
    }
    const ProfileProperties properties = measure_properties(profile);
    EXPECT_NEAR(properties.mean_radius_mm / (moment / mass), 1, 1e-7) << seed;
    EXPECT_NEAR(properties.albedo / (2 * std::numbers::pi * mass), 1, 1e-7) << seed;
  }
}

TEST(Properties, RoundTripsAreExact) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Profile profile = random_profile(seed);
    const ProfileProperties properties = measure_properties(profile);
    const Profile shape = profile_shape(profile);
    EXPECT_NEAR(profile_range(shape), 1, 1e-12);
    EXPECT_NEAR(profile_integral(shape), 1, 1e-12);
    expect_same_profile(compose_profile(shape, properties.albedo, properties.range_mm), profile,
                        1e-12);
  }
}

TEST(Properties, ComposedProfilesHaveWhatWasAskedFor) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Rng random = make_rng(seed + 1000);
    const double albedo = uniform(random, 0.01, 1.0), range = uniform(random, 0.1, 20.0);
    const ProfileProperties found =
        measure_properties(compose_profile(random_profile(seed), albedo, range));
    EXPECT_NEAR(found.albedo / albedo, 1, 1e-12);
    EXPECT_NEAR(found.range_mm / range, 1, 1e-12);
  }
}

TEST(Properties, BlendsMixEachPropertyOnItsOwn) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Rng random = make_rng(seed + 2000);
    const Profile a = random_profile(2 * seed),
                  b = random_profile(2 * seed + 1, seed % 2 == 0 ? 12 : 9);
    const PropertyWeights w{uniform(random, 0.0, 1.0), uniform(random, 0.0, 1.0),
                            uniform(random, 0.0, 1.0)};
    const Profile mixed = blend_profiles(a, b, w);
    const ProfileProperties of_a = measure_properties(a), of_b = measure_properties(b),
                            of_mixed = measure_properties(mixed);
    EXPECT_NEAR(of_mixed.albedo, (1 - w.albedo) * of_a.albedo + w.albedo * of_b.albedo,
                1e-12 * (of_a.albedo + of_b.albedo));
    EXPECT_NEAR(of_mixed.range_mm, (1 - w.range) * of_a.range_mm + w.range * of_b.range_mm,
                1e-12 * (of_a.range_mm + of_b.range_mm));
    for (std::size_t k = 1; k < mixed.knots_mm.size(); ++k) {
      EXPECT_LT(mixed.knots_mm[k - 1], mixed.knots_mm[k]);
      EXPECT_LE(mixed.log_value[k], mixed.log_value[k - 1] + 1e-13);
    }
  }
}

TEST(Properties, BlendsOfNothingAndOfAllAreTheEnds) {
  const Profile a = random_profile(1), b = random_profile(2);
  expect_same_profile(blend_profiles(a, b, {0, 0, 0}), a, 0);
  expect_same_profile(blend_profiles(a, b, {1, 1, 1}), b, 0);
  expect_same_profile(blend_profiles(a, a, {0.3, 0.6, 0.9}), a, 1e-12);
  // one property after the other is the same as all at once
  const Profile step = blend_profiles(blend_profiles(a, b, {1, 0, 0}), b, {0, 1, 0});
  expect_same_profile(blend_profiles(step, b, {0, 0, 1}), b, 1e-12);
}

}  // namespace
}  // namespace parian

#include "material/profile_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace parian {
namespace {

// Random falling profiles.
ProfileMap make_map(int width, int height, int channels) {
  ProfileMap map = make_profile_map(width, height, channels, 0.25, {0, 0.3, 0.5, 1.1, 2});
  Rng rng = make_rng(5);
  for (int c = 0; c < channels; ++c)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        double value = -sample_uniform(rng);
        for (int k = 0; k < 5; ++k, value -= 0.2 + sample_uniform(rng))
          knot_plane(map, c, k)[y * width + x] = static_cast<float>(value);
      }
  return map;
}

// h(r) of a row by its knots.
double eval_row(const ProfileField& field, const std::vector<float>& row, int channel, double r) {
  std::size_t k = 0;
  while (k + 2 < field.knots() && static_cast<double>(field.knots_mm[k + 1]) <= r) ++k;
  const double r0 = field.knots_mm[k], r1 = field.knots_mm[k + 1];
  const auto c = static_cast<std::size_t>(channel);
  const double h0 = row[3 * k + c], h1 = row[3 * k + 3 + c];
  return h0 + (r - r0) / (r1 - r0) * (h1 - h0);
}

void expect_profiles(const ProfileMap& map, double tolerance) {
  const ProfileField field = make_profile_field(map);
  std::vector<float> row(field.row());
  float support[3];
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      field.eval(x, y, row.data(), support);
      for (int c = 0; c < 3; ++c) {
        const Profile profile = get_profile(map, std::min(c, map.channels - 1), x, y);
        EXPECT_FLOAT_EQ(support[c], static_cast<float>(profile.support_mm));
        EXPECT_LE(support[c], field.max_support_mm);
        for (double u = 0; u < 0.999; u += 0.013) {
          const double r = u * profile.support_mm;
          EXPECT_NEAR(2 * eval_row(field, row, c, r), eval_log_profile(profile, r), tolerance);
        }
      }
    }
  EXPECT_GE(field.knots_mm.back(), field.max_support_mm);
}

TEST(ProfileField, IsTheMapsProfilesAtPixelCentres) {
  expect_profiles(make_map(3, 2, 3), 2e-6);
}

TEST(ProfileField, GreyMapsCountForThreeChannels) {
  expect_profiles(make_map(2, 2, 1), 2e-6);
}

TEST(ProfileField, CarriesGainAndDilation) {
  ProfileMap map = make_map(2, 2, 3);
  map.gain = {0.5f, 2, 1, 1, 1, 1, 0.1f, 1, 1, 3, 1, 1};
  expect_profiles(map, 4e-6);
  map.dilation = {0.5f, 2, 1, 1, 1, 1, 1.3f, 1, 1, 0.8f, 1, 1};
  expect_profiles(map, 0.05);  // resampled: 1 % of the steepest slope times the support is 0.07
}

TEST(ProfileField, InterpolatesLogarithmsBetweenPixels) {
  const ProfileMap map = make_map(2, 1, 3);
  const ProfileField field = make_profile_field(map);
  std::vector<float> left(field.row()), right(field.row()), between(field.row());
  float support[3];
  field.eval(0, 0, left.data(), support);
  field.eval(1, 0, right.data(), support);
  field.eval(0.25, 0, between.data(), support);
  for (std::size_t i = 0; i < field.row(); ++i)
    EXPECT_NEAR(between[i], 0.75f * left[i] + 0.25f * right[i], 2e-6);
  field.eval(-3, 7, between.data(), support);  // clamped
  EXPECT_EQ(between, left);
}

TEST(ProfileField, DipolesWithinTheStatedError) {
  const Dipole dipole = {{{0.002, 2.2}, {0.004, 2.6}, {0.07, 3}}, 1.3};
  const ProfileField field = make_profile_field(dipole);
  EXPECT_EQ(field.width * field.height, 1);
  EXPECT_EQ(field.boundary, Boundary::excluded);
  EXPECT_TRUE(field.monotone);
  std::vector<float> row(field.row());
  float support[3];
  field.eval(4, -2, row.data(), support);
  for (int c = 0; c < 3; ++c)
    for (double u = 0; u < 1; u += 0.003) {
      const double r = u * u * static_cast<double>(support[c]);
      const double exact =
          std::log(eval_dipole(dipole.channels[static_cast<std::size_t>(c)], 1.3, r));
      EXPECT_NEAR(2 * eval_row(field, row, c, r), exact, 1e-3) << r;
    }
}

TEST(ProfileField, KnowsProfilesThatRise) {
  ProfileMap map = make_map(2, 2, 3);
  EXPECT_TRUE(make_profile_field(map).monotone);
  knot_plane(map, 1, 2)[3] += 5;
  EXPECT_FALSE(make_profile_field(map).monotone);
}

TEST(ProfileField, MergesKnotsThatFloatsHardlyTellApart) {
  const ProfileMap map = make_profile_map(1, 1, 3, 1, {0, 1, 1 + 1e-9, 2}, -1);
  const ProfileField field = make_profile_field(map);
  for (std::size_t k = 1; k < field.knots(); ++k)
    EXPECT_GT(field.knots_mm[k], field.knots_mm[k - 1]);
}

}  // namespace
}  // namespace parian

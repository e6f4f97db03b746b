#include "material/profile_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

#include "base/random.h"
#include "base/test_errors.h"
#include "material/bssrdf_table.h"
#include "material/material.h"

namespace parian {
namespace {

double quadrature(const std::function<double(double)>& f, double a, double b, int steps = 20'000) {
  double sum = 0;  // midpoint rule
  const double h = (b - a) / steps;
  for (int i = 0; i < steps; ++i) sum += f(a + (i + 0.5) * h) * h;
  return sum;
}

TEST(Profile, SegmentIntegralIsExactAcrossTheSeriesSwitch) {
  for (double beta :
       {0.0, 1e-12, 1e-5, 0.0099999, 0.0100001, 0.5, -0.0099999, -0.0100001, -3.0, -20.0}) {
    const double exact =
        quadrature([&](double r) { return std::exp(-1 + beta * (r - 0.7) / 0.3) * r; }, 0.7, 1.0);
    EXPECT_NEAR(segment_integral(0.7, 0.3, -1, -1 + beta) / exact, 1, 1e-7) << beta;
  }
  // The two formulas meet at the switch to 3e-14 (algorithms).
  const double below = segment_integral(0, 1, 0, 0.01 * (1 - 1e-15)),
               above = segment_integral(0, 1, 0, 0.01);
  EXPECT_NEAR(below / above, 1, 1e-13);
}

Profile exponential(double rate, double last, int segments) {
  Profile profile;
  for (int k = 0; k <= segments; ++k) {
    profile.knots_mm.push_back(last * k / segments);
    profile.log_value.push_back(-rate * profile.knots_mm.back());
  }
  profile.support_mm = profile_support(profile.knots_mm, profile.log_value);
  return profile;
}

TEST(Profile, ExponentialHasItsSupportAndIntegral) {
  const Profile profile = exponential(2, 3, 4);  // e^-6 at the last knot: the tail goes on
  const double support = -std::log(support_threshold) / 2;
  EXPECT_NEAR(profile.support_mm, support, 1e-12);
  const double exact = (1 - std::exp(-2 * support) * (1 + 2 * support)) / 4;
  EXPECT_NEAR(profile_integral(profile), exact, 1e-13);
  EXPECT_NEAR(eval_log_profile(profile, 4), -8, 1e-12);
  EXPECT_EQ(eval_log_profile(profile, support + 1e-9), -std::numeric_limits<double>::infinity());
}

TEST(Profile, FlatProfilesEndAtFourTimesTheLastKnotOrBefore) {
  const Profile flat = exponential(0, 2, 3);
  EXPECT_EQ(flat.support_mm, 8);                      // the minimum decay needs 9.2 last knots
  EXPECT_NEAR(eval_log_profile(flat, 6), -2, 1e-12);  // -(6 - 2) / 2
  const Profile steep = exponential(20, 3, 4);
  EXPECT_EQ(steep.support_mm, 3);  // never less than the knots
}

ProfileMap make_random_map(int width, int height, bool edited) {
  ProfileMap map = make_profile_map(width, height, 1, 0.5, {0, 0.5, 1.2, 2});
  Rng rng = make_rng(4);
  for (std::size_t x = 0; x < map.pixels(); ++x) {
    float value = static_cast<float>(-1 + 0.3 * sample_normal(rng));
    for (int k = 0; k < 4; ++k) {
      knot_plane(map, 0, k)[x] = value;
      value -= static_cast<float>(0.1 + sample_uniform(rng));
    }
    if (!edited) continue;
    map.gain.push_back(static_cast<float>(0.5 + sample_uniform(rng)));
    map.dilation.push_back(static_cast<float>(0.5 + sample_uniform(rng)));
  }
  return map;
}

TEST(ProfileMap, SlicesAreSymmetricBitForBitAndTheGeometricMean) {
  for (bool edited : {false, true}) {
    const ProfileMap map = make_random_map(9, 8, edited);
    std::vector<float> forward(map.pixels()), backward(map.pixels());
    for (const Offset d : {Offset{1, 0}, {2, 1}, {-3, 2}, {0, 4}, {5, 5}, {8, 7}}) {
      eval_slice(map, 0, d, forward.data());
      eval_slice(map, 0, {-d.dx, -d.dy}, backward.data());
      for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 9; ++x) {
          const int xd = x + d.dx, yd = y + d.dy;
          const float value = forward[static_cast<std::size_t>(y * 9 + x)];
          if (xd < 0 || xd >= 9 || yd >= 8) {
            EXPECT_TRUE(std::isnan(value));
            continue;
          }
          EXPECT_EQ(value, backward[static_cast<std::size_t>(yd * 9 + xd)]);
          const double r = 0.5 * length_px(d);
          const double a = eval_log_profile(get_profile(map, 0, x, y), r),
                       b = eval_log_profile(get_profile(map, 0, xd, yd), r);
          EXPECT_NEAR(value, std::exp(0.5 * (a + b)), 1e-6 * std::exp(0.5 * (a + b)));
        }
      }
    }
  }
}

TEST(ProfileMap, GainScalesTheAlbedoAndDilationKeepsIt) {
  ProfileMap map = make_random_map(1, 1, false);
  const double before = profile_integral(get_profile(map, 0, 0, 0));
  const double support = get_profile(map, 0, 0, 0).support_mm;
  map.gain = {2.0f};
  map.dilation = {1.5f};
  const Profile edited = get_profile(map, 0, 0, 0);
  EXPECT_NEAR(profile_integral(edited) / before, 2, 1e-12);
  EXPECT_NEAR(edited.support_mm / support, 1.5, 1e-12);
}

// Furnace: a uniform, finely sampled map under uniform light reflects 2 pi C.
TEST(ProfileMap, FlatFurnaceIsTwoPiC) {
  ProfileMap map = make_profile_map(121, 121, 1, 0.1, {0, 1, 2});
  for (int k = 0; k < 3; ++k)
    std::fill_n(knot_plane(map, 0, k), map.pixels(), static_cast<float>(-2.3 * k));
  const Material material = map;
  const TableHeader header = natural_header(material);
  const auto source = make_slices(material, header);
  std::vector<float> slice(map.pixels());
  double sum = 0;
  for (std::size_t i = 0; i < header.offsets.size(); ++i) {
    source->read_slice(0, static_cast<int>(i), slice.data());
    const Offset d = header.offsets[i];
    const auto at_pixel = [&](int x, int y) {
      return static_cast<double>(slice[static_cast<std::size_t>(y * 121 + x)]);
    };
    sum += at_pixel(60, 60) * 0.01;
    if (d != Offset{}) sum += at_pixel(60 - d.dx, 60 - d.dy) * 0.01;
  }
  EXPECT_NEAR(sum / diffuse_albedo(get_profile(map, 0, 60, 60)), 1, 2e-3);  // pixels of 0.1 mm
}

TEST(HoldOut, IsSymmetricSeededAndOfTheStatedShare) {
  const HoldOut hold_out{0.2, 3};
  int count = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      count += is_held_out(hold_out, x, y, {3, 2});
      EXPECT_EQ(is_held_out(hold_out, x, y, {3, 2}), is_held_out(hold_out, x + 3, y + 2, {-3, -2}));
      EXPECT_FALSE(is_held_out(hold_out, x, y, {}));
    }
  }
  EXPECT_NEAR(count, 2000, 5 * 40);  // binomial, 5 sigma
}

TEST(ProfileMap, BadMapsAreNamed) {
  ProfileMap map = make_random_map(2, 2, false);
  check(map, "m.h5");
  map.knots_mm[2] = 0.1;
  EXPECT_EQ(error_of([&] { check(map, "m.h5"); }),
            "m.h5: knots_mm[2]: expected a finite value > 0.5, found 0.1");
  map = make_random_map(2, 2, false);
  map.log_profile[5] = std::nanf("");
  EXPECT_EQ(error_of([&] { check(map, "m.h5"); }),
            "m.h5: dataset 'log_profile', value 5: expected a finite value, found nan");
  map = make_random_map(2, 2, false);
  map.gain = {1, 1, 1};
  EXPECT_EQ(error_of([&] { check(map, "m.h5"); }),
            "m.h5: dataset 'gain': expected 4 values, found 3");
}

TEST(Material, SlicesNeedTheSameGrid) {
  const Material material = make_random_map(4, 3, false);
  TableHeader header = natural_header(material);
  header.width = 5;
  EXPECT_EQ(error_of([&] { make_slices(material, header, "m.h5"); }),
            "m.h5: grid: expected 5 x 3 pixels, 1 channels, as the table, found 4 x 3 pixels, 1 "
            "channels");
  header = natural_header(material);
  header.pixel_pitch_mm = 1;
  EXPECT_EQ(error_of([&] { make_slices(material, header, "m.h5"); }),
            "m.h5: pixel_pitch_mm: expected 1, as the table, found 0.5");
}

TEST(ProfileMap, SlicesOfDilatedMapsAgreeWithEachProfile) {
  Rng rng = make_rng(9);
  ProfileMap map = make_profile_map(9, 7, 3, 0.4, {0, 0.3, 0.7, 1.5, 1.9});
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < map.pixels(); ++i) {
      double value = -1;
      for (int k = 0; k < 5; ++k, value -= 3 * sample_uniform(rng))
        knot_plane(map, c, k)[i] = static_cast<float>(value);
    }
  for (std::size_t i = 0; i < 3 * map.pixels(); ++i) {
    map.gain.push_back(static_cast<float>(0.5 + sample_uniform(rng)));
    map.dilation.push_back(static_cast<float>(0.4 + 2 * sample_uniform(rng)));
  }
  const Material material = map;
  const TableHeader header = natural_header(material);
  const auto slices = make_slices(material, header);
  std::vector<float> fast(map.pixels()), plain(map.pixels());
  for (int c = 0; c < 3; ++c)
    for (std::size_t d = 0; d < header.offsets.size(); ++d) {
      slices->read_slice(c, static_cast<int>(d), fast.data());
      eval_slice(map, c, header.offsets[d], plain.data());
      for (std::size_t i = 0; i < fast.size(); ++i) {
        if (std::isnan(plain[i])) {
          EXPECT_TRUE(std::isnan(fast[i]));
        } else if (fast[i] > 0 && plain[i] > 0) {  // at the support itself either may be 0
          EXPECT_NEAR(fast[i] / plain[i], 1, 2e-5);
        } else {
          EXPECT_LT(std::max(fast[i], plain[i]), 1e-3);
        }
      }
    }
}

}  // namespace
}  // namespace parian

#include "fit/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

#include "base/parallel.h"
#include "base/test_errors.h"
#include "fit/test_tables.h"
#include "material/material.h"

namespace parian {
namespace {

FitResult fit(const BssrdfTable& table, const FitParams& params) {
  return fit_profiles(*make_slices(table, "t.h5"), params);
}

// Known profiles: non-increasing, different at every pixel.
ProfileMap make_known_map(int width, int height, int segments) {
  std::vector<double> knots;
  for (int k = 0; k <= segments; ++k) knots.push_back(0.5 * k);
  ProfileMap map = make_profile_map(width, height, 1, 0.5, knots);
  for (int k = 0; k <= segments; ++k)
    for (int i = 0; i < width * height; ++i)
      knot_plane(map, 0, k)[i] =
          static_cast<float>(-1 - (0.3 + 0.1 * std::sin(1.3 * i)) * k - 0.02 * k * k);
  return map;
}

double mean_relative_error(const BssrdfTable& a, const BssrdfTable& b) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.reflectance.size(); ++i) {
    if (std::isnan(a.reflectance[i])) continue;
    sum +=
        std::abs(static_cast<double>(b.reflectance[i]) / static_cast<double>(a.reflectance[i]) - 1);
    ++count;
  }
  return sum / static_cast<double>(count);
}

TEST(Fit, RecoversATableMadeFromKnownProfiles) {
  const Material truth = make_known_map(16, 14, 5);
  TableHeader header = natural_header(truth);
  header.offsets = half_disc_offsets(5);
  const BssrdfTable table = read_table(*make_slices(truth, header));
  FitParams params;
  params.lambda = 0;
  params.tolerance = 1e-9;
  const Material fitted = fit(table, params).map;
  const BssrdfTable again = read_table(*make_slices(fitted, header));
  EXPECT_LE(mean_relative_error(table, again), 1e-4);  // the target is 1e-3
  EXPECT_EQ(std::get<ProfileMap>(fitted).knots_mm.size(), 6u);
}

TEST(Fit, TheSameBitsForAnyNumberOfThreads) {
  const BssrdfTable table = make_test_table(24, 20, 5, 3);
  FitParams params;
  params.hold_out = 0.05;
  std::vector<float> one;
  {
    const ThreadLimit limit(1);
    one = fit(table, params).map.log_profile;
  }
  const ThreadLimit limit(5);
  EXPECT_EQ(fit(table, params).map.log_profile, one);
}

// Fits of a transformed table: the same energies and the transformed profiles.
void expect_equivalent(const BssrdfTable& table, const std::function<Offset(int x, int y)>& place,
                       const std::function<Offset(Offset)>& turn, int new_width, int new_height) {
  BssrdfTable moved = table;
  moved.header.width = new_width;
  moved.header.height = new_height;
  for (std::size_t i = 0; i < table.header.offsets.size(); ++i) {
    Offset d = turn(table.header.offsets[i]);
    const bool flip = d.dy < 0 || (d.dy == 0 && d.dx < 0);
    if (flip) d = {-d.dx, -d.dy};
    moved.header.offsets[i] = d;
    const float* from = slice_of(table, 0, static_cast<int>(i));
    float* to = slice_of(moved, 0, static_cast<int>(i));
    const PixelRange range = pairs_in_grid(table.header, table.header.offsets[i]);
    std::fill_n(to, moved.header.pixels(), std::numeric_limits<float>::quiet_NaN());
    for (int y = range.y0; y < range.y1; ++y) {
      for (int x = range.x0; x < range.x1; ++x) {
        const Offset d0 = table.header.offsets[i];
        const Offset target = flip ? place(x + d0.dx, y + d0.dy) : place(x, y);
        to[target.dy * new_width + target.dx] = from[y * table.header.width + x];
      }
    }
  }
  FitParams params;
  params.tolerance = 1e-10;
  const FitResult a = fit(table, params), b = fit(moved, params);
  EXPECT_NEAR(b.report.channels[0].energy / a.report.channels[0].energy, 1, 1e-6);
  for (int k = 0; k < static_cast<int>(a.map.knots_mm.size()); ++k)
    for (int y = 0; y < table.header.height; ++y)
      for (int x = 0; x < table.header.width; ++x) {
        const Offset to = place(x, y);
        EXPECT_NEAR(knot_plane(b.map, 0, k)[to.dy * new_width + to.dx],
                    knot_plane(a.map, 0, k)[y * table.header.width + x], 2e-3);
      }
}

TEST(Fit, IsInvariantToTranspositionAndRotation) {
  const BssrdfTable table = make_test_table(9, 7, 3);
  expect_equivalent(
      table,
      [](int x, int y) {
        return Offset{y, x};
      },
      [](Offset d) {
        return Offset{d.dy, d.dx};
      },
      7, 9);
  expect_equivalent(
      table,
      [](int x, int y) {
        return Offset{8 - x, 6 - y};
      },
      [](Offset d) {
        return Offset{-d.dx, -d.dy};
      },
      9, 7);
  expect_equivalent(
      table,
      [](int x, int y) {
        return Offset{6 - y, x};
      },
      [](Offset d) {
        return Offset{-d.dy, d.dx};
      },
      7, 9);
}

TEST(Fit, IsInvariantToUnits) {
  BssrdfTable table = make_test_table(8, 8, 3);
  const FitResult mm = fit(table, {});
  table.header.pixel_pitch_mm *= 1000;  // as if in micrometres
  const FitResult um = fit(table, {});
  for (std::size_t i = 0; i < mm.map.log_profile.size(); ++i)
    EXPECT_NEAR(um.map.log_profile[i], mm.map.log_profile[i], 1e-4);
  EXPECT_NEAR(um.map.knots_mm.back() / mm.map.knots_mm.back(), 1000, 1e-9);
}

TEST(Fit, ProfilesNeverRiseUnlessAskedNotTo) {
  BssrdfTable table = make_test_table(12, 12, 4);
  Rng rng = make_rng(3);
  for (float& value : table.reflectance)
    value *= static_cast<float>(std::exp(0.3 * sample_normal(rng)));
  const auto rising = [](const ProfileMap& map) {
    int count = 0;
    for (int k = 1; k < static_cast<int>(map.knots_mm.size()); ++k)
      for (std::size_t i = 0; i < map.pixels(); ++i)
        count += knot_plane(map, 0, k)[i] > knot_plane(map, 0, k - 1)[i];
    return count;
  };
  FitParams params;
  const FitResult monotone = fit(table, params);
  EXPECT_EQ(rising(monotone.map), 0);
  EXPECT_GT(monotone.report.channels[0].profiles_touched, 0u);
  EXPECT_GE(monotone.report.channels[0].energy_monotone, monotone.report.channels[0].energy);
  params.monotone = false;
  const FitResult free = fit(table, params);
  EXPECT_GT(rising(free.map), 0);
  EXPECT_EQ(free.report.channels[0].profiles_touched, 0u);
}

TEST(Fit, MissingPairsBarelyMoveTheResult) {
  BssrdfTable table = make_test_table(14, 12, 4);
  const FitResult full = fit(table, {});
  remove_pairs(table, 0.05, 9);
  const FitResult thin = fit(table, {});
  EXPECT_GT(thin.report.channels[0].missing, 100u);
  for (std::size_t i = 0; i < full.map.log_profile.size(); ++i)
    EXPECT_NEAR(thin.map.log_profile[i], full.map.log_profile[i], 0.6);
}

TEST(Fit, HeldOutPairsDoNotEnter) {
  BssrdfTable table = make_test_table(12, 10, 3);
  FitParams params;
  params.hold_out = 0.1;
  params.seed = 7;
  const FitResult clean = fit(table, params);
  EXPECT_GT(clean.report.channels[0].held_out, 50u);
  // Spoiling them changes nothing.
  for (std::size_t i = 0; i < table.header.offsets.size(); ++i)
    for (int y = 0; y < 10; ++y)
      for (int x = 0; x < 12; ++x)
        if (is_held_out(clean.map.hold_out, x, y, table.header.offsets[i]))
          slice_of(table, 0, static_cast<int>(i))[y * 12 + x] *= 100;
  EXPECT_EQ(fit(table, params).map.log_profile, clean.map.log_profile);
}

TEST(Fit, FillsUnmeasuredPixelsOnRequest) {
  BssrdfTable table = make_test_table(6, 6, 2);
  for (std::size_t i = 0; i < table.header.offsets.size(); ++i) {
    float* slice = slice_of(table, 0, static_cast<int>(i));
    const Offset d = table.header.offsets[i];
    for (int x = 0; x < 36; ++x) {
      const bool corner = x == 0 || (x % 6 + d.dx == 0 && x / 6 + d.dy == 0);
      if (corner) slice[x] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  FitParams params;
  params.fill_unmeasured = true;
  const FitResult result = fit(table, params);
  EXPECT_EQ(result.report.pixels_filled, 1u);
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(knot_plane(result.map, 0, k)[0], knot_plane(result.map, 0, k)[1]);
}

TEST(Fit, BadParametersAreNamed) {
  const BssrdfTable table = make_test_table(8, 8, 3);
  FitParams params;
  params.segments = 100'000;
  EXPECT_EQ(error_of([&] { fit(table, params); }),
            "segments: expected a value in [0, 256], found 100000");
  params = {};
  params.radius_mm = 90;
  EXPECT_EQ(error_of([&] { fit(table, params); }),
            "radius-mm: expected at most 1.5 mm, the table's largest offset, found 90 mm");
  params.radius_mm = 0.2;
  EXPECT_EQ(error_of([&] { fit(table, params); }),
            "radius-mm: expected at least 0.5 mm, the pixel pitch, found 0.2 mm");
  params = {};
  params.knots_mm = {0, 1, 1};
  EXPECT_EQ(error_of([&] { fit(table, params); }), "knots-mm[2]: expected a length > 1, found 1");
  params = {};
  params.weight = PairWeight::noise;
  EXPECT_EQ(error_of([&] { fit(table, params); }),
            "t.h5: weight 'noise': expected a table with a noise model (noise_floor, noise_gain), "
            "found none");
}

TEST(Fit, CanBeCancelled) {
  const BssrdfTable table = make_test_table(8, 8, 3);
  Progress progress;
  progress.is_cancelled = [] { return true; };
  EXPECT_EQ(catch_error([&] { fit_profiles(*make_slices(table), {}, progress); }).kind,
            ErrorKind::cancelled);
}

}  // namespace
}  // namespace parian

#include "material/profile_blend.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "base/random.h"
#include "base/test_errors.h"
#include "material/bssrdf_table.h"
#include "material/material.h"
#include "material/profile_field.h"
#include "material/test_blends.h"

namespace parian {
namespace {

void expect_same_slices(const ProfileBlend& blend, const ProfileMap& map, float tolerance) {
  std::vector<float> a(blend.pixels()), b(blend.pixels());
  for (int c = 0; c < blend.channels; ++c)
    for (Offset d : {Offset{0, 0}, Offset{1, 0}, Offset{-1, 2}, Offset{3, 2}, Offset{5, 4}}) {
      eval_slice(blend, c, d, a.data());
      eval_slice(map, c, d, b.data());
      for (std::size_t i = 0; i < a.size(); ++i) {
        ASSERT_EQ(std::isnan(a[i]), std::isnan(b[i]));
        if (!std::isnan(a[i])) {
          ASSERT_NEAR(a[i], b[i], tolerance * b[i]) << c << " " << d.dx << " " << d.dy;
        }
      }
    }
}

TEST(ProfileBlend, IsItsExpandedMapForAnyNumberOfBasesPerPixel) {
  for (int k = 1; k <= max_bases_per_pixel; ++k)
    for (int channels : {1, 3}) {
      ProfileBlend blend = make_blend(k, 9, channels);
      check(blend, "blend");
      expect_same_slices(blend, make_profile_map(blend), 2e-6f);
      const std::size_t planes = static_cast<std::size_t>(channels) * blend.pixels();
      blend.gain.assign(planes, 0.7f);
      expect_same_slices(blend, make_profile_map(blend), 2e-6f);
      blend.dilation.assign(planes, 1.3f);
      expect_same_slices(blend, make_profile_map(blend), 2e-6f);
    }
}

// Steep enough for some pixels' supports to end between the last knot and the offset.
TEST(ProfileBlend, EndsAtItsSupport) {
  ProfileBlend blend = make_blend(2);
  for (float& value : blend.base_log_profile) value *= 4;
  expect_same_slices(blend, make_profile_map(blend), 4e-6f);
  std::vector<float> slice(blend.pixels());
  int zeros = 0, others = 0;
  for (int c = 0; c < 3; ++c) {
    eval_slice(blend, c, {5, 4}, slice.data());
    for (float value : slice) {
      zeros += value == 0;
      others += value > 0;
    }
  }
  EXPECT_GT(zeros, 0);
  EXPECT_GT(others, 0);
}

TEST(ProfileBlend, OneBasePerPixelIsTheMap) {
  ProfileMap map = make_profile_map(6, 4, 3, 0.5, {0, 1, 2});
  Rng rng = make_rng(1);
  for (std::size_t i = 0; i < map.log_profile.size(); ++i)
    map.log_profile[i] =
        static_cast<float>(sample_uniform(rng)) - 1.5f * static_cast<float>(i / 24 % 3);
  ProfileBlend blend;
  blend.width = 6;
  blend.height = 4;
  blend.per_pixel = 1;
  blend.pixel_pitch_mm = 0.5;
  blend.knots_mm = map.knots_mm;
  for (std::size_t x = 0; x < 24; ++x) {
    blend.index.push_back(static_cast<std::uint16_t>(x));
    for (std::size_t i = 0; i < 9; ++i)
      blend.base_log_profile.push_back(map.log_profile[i * 24 + x]);
  }
  check(blend, "blend");
  EXPECT_EQ(make_profile_map(blend).log_profile, map.log_profile);
  expect_same_slices(blend, map, 0);
}

TEST(ProfileBlend, NumbersOfBasesDoNotMatter) {
  const ProfileBlend blend = make_blend(3, 300);
  ProfileBlend renumbered = blend;
  const std::size_t row = 3 * blend.knots_mm.size();
  for (std::size_t j = 0; j < 300; ++j)
    std::copy_n(&blend.base_log_profile[j * row], row,
                &renumbered.base_log_profile[(299 - j) * row]);
  for (std::uint16_t& index : renumbered.index) index = static_cast<std::uint16_t>(299 - index);
  EXPECT_EQ(make_profile_map(blend).log_profile, make_profile_map(renumbered).log_profile);
}

TEST(ProfileBlend, SymmetricBitForBit) {
  const Material material = make_blend(2);
  TableHeader like = natural_header(material);
  like.symmetric = false;
  like.offsets = {{0, 0}, {2, 1}, {-2, -1}};
  const BssrdfTable table = read_table(*make_slices(material, like));
  for (int c = 0; c < 3; ++c)
    for (std::size_t x = 0; x < 7 * 5; ++x) {
      const float there = slice_of(table, c, 1)[x];
      if (!std::isnan(there)) {
        EXPECT_EQ(there, slice_of(table, c, 2)[x + 2 + 7]);
      }
    }
}

TEST(ProfileBlend, SnappingIsIdempotentAndValid) {
  for (int k : {1, 2, 5})
    for (int levels : {1, 7, 255, 65535}) {
      ProfileBlend blend = make_blend(k);
      snap_to_grid(blend, {0.01, levels});
      EXPECT_NO_THROW(check(blend, "blend"));
      ProfileBlend again = blend;
      snap_to_grid(again, blend.grid);
      EXPECT_EQ(again.base_log_profile, blend.base_log_profile);
      EXPECT_EQ(again.weight, blend.weight);
    }
}

// By trying all lattice points.
TEST(ProfileBlend, SnappedWeightsAreTheNearestOfTheSimplex) {
  constexpr int levels = 9;
  const ProfileBlend blend = make_blend(3);
  ProfileBlend snapped = blend;
  snap_to_grid(snapped, {0, levels});
  EXPECT_EQ(snapped.base_log_profile, blend.base_log_profile);
  for (std::size_t x = 0; x < blend.pixels(); ++x) {
    std::array<float, 3> given{}, found{};
    get_weights(blend, x, given.data());
    get_weights(snapped, x, found.data());
    const auto distance = [&](double a, double b, double c) {
      return std::hypot(a - static_cast<double>(given[0]), b - static_cast<double>(given[1]),
                        c - static_cast<double>(given[2]));
    };
    double best = 1e9;
    for (int a = 0; a <= levels; ++a)
      for (int b = 0; a + b <= levels; ++b)
        best = std::min(best, distance(a / 9.0, b / 9.0, (levels - a - b) / 9.0));
    EXPECT_NEAR(distance(found[0], found[1], found[2]), best, 1e-6) << x;
  }
}

TEST(ProfileBlend, WeightsAtCorners) {
  ProfileBlend blend = make_blend(3);
  const std::size_t pixels = blend.pixels();
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (std::size_t k = 0; k < 2; ++k) blend.weight[k * pixels] = k == corner ? 1 : 0;
    std::array<float, 3> weights{}, expected{};
    expected[corner] = 1;
    get_weights(blend, 0, weights.data());
    EXPECT_EQ(weights, expected);
    const Profile profile = get_profile(blend, 1, 0, 0);
    const float* base = base_profile(blend, blend.index[corner * pixels], 1);
    for (std::size_t k = 0; k < blend.knots_mm.size(); ++k)
      EXPECT_EQ(profile.log_value[k], static_cast<double>(base[k]));
  }
  blend.weight[0] = 0.7f;  // by rounding more than 1: the last is never below 0
  blend.weight[pixels] = 0.300001f;
  check(blend, "blend");
  std::array<float, 3> weights{};
  get_weights(blend, 0, weights.data());
  EXPECT_EQ(weights[2], 0);
}

// 35 pixels: four blocks of eight, and three more.
TEST(ProfileBlend, PairsAreMixedAlikeWhereverTheyLie) {
  const ProfileBlend blend = make_blend(2, 300);
  const ProfileMap map = make_profile_map(blend);
  for (int y = 0; y < blend.height; ++y)
    for (int x = 0; x < blend.width; ++x)
      for (int c = 0; c < 3; ++c) {
        const Profile profile = get_profile(blend, c, x, y), written = get_profile(map, c, x, y);
        for (std::size_t k = 0; k < blend.knots_mm.size(); ++k)
          EXPECT_NEAR(profile.log_value[k], written.log_value[k], 2e-6);
      }
}

TEST(ProfileBlend, IsAMaterialLikeItsMap) {
  ProfileBlend blend = make_blend(2);
  blend.boundary = Boundary::included;
  blend.eta = 1.45;
  blend.hold_out = {0.25, 7};
  const Material a = blend, b = make_profile_map(blend);
  EXPECT_EQ(describe_kind(a), "profile blend");
  EXPECT_TRUE(has_profiles(a));
  EXPECT_EQ(boundary_of(a), Boundary::included);
  EXPECT_EQ(eta_of(a), 1.45);
  EXPECT_EQ(hold_out_of(a).fraction, 0.25);
  EXPECT_EQ(hold_out_of(a).seed, 7u);
  EXPECT_NEAR(support_mm(a), support_mm(b), 1e-5);
  EXPECT_EQ(natural_header(a).offsets, natural_header(b).offsets);
  EXPECT_NEAR(diffuse_albedo(get_profile(a, 2, 3, 4)), diffuse_albedo(get_profile(b, 2, 3, 4)),
              1e-5);
  TableHeader like = natural_header(a);
  like.width = 8;
  EXPECT_EQ(error_of([&] { make_slices(a, like, "b.kbm"); }),
            "b.kbm: grid: expected 8 x 5 pixels, 3 channels, as the table, found 7 x 5 "
            "pixels, 3 channels");
}

TEST(ProfileBlend, PaperBytes) {
  ProfileBlend blend = make_blend(2, 128);
  EXPECT_EQ(paper_bytes(blend), 12 * 128 * 4 + 6 * blend.pixels());
  blend = make_blend(3, 300, 1);
  EXPECT_EQ(paper_bytes(blend), 4 * 300 * 4 + (6 + 8) * blend.pixels());
}

// The field mixes bases; it must be the expanded map's, tails and gains included.
TEST(BlendField, IsTheFieldOfTheExpandedMap) {
  for (bool has_gain : {false, true})
    for (int k : {1, 2, 4, 8}) {
      const int channels = k == 4 ? 1 : 3;
      ProfileBlend blend = make_blend(k, k == 2 ? 300 : 9, channels);
      // Some bases fall slower than the minimum decay beyond the last knot.
      for (std::size_t j = 0; j < blend.bases() * static_cast<std::size_t>(channels); j += 2)
        blend.base_log_profile[4 * j + 3] = blend.base_log_profile[4 * j + 2];
      if (has_gain)
        for (std::size_t i = 0; i < static_cast<std::size_t>(channels) * blend.pixels(); ++i)
          blend.gain.push_back(0.5f + 0.02f * static_cast<float>(i));
      const ProfileField a = make_profile_field(Material(blend));
      const ProfileField b = make_profile_field(Material(make_profile_map(blend)));
      ASSERT_EQ(a.knots_mm.size(), b.knots_mm.size());
      std::vector<float> row_a(a.row()), row_b(b.row()), support_a(3), support_b(3);
      for (double y : {0.0, 0.4, 3.7, 9.0})
        for (double x : {-1.0, 0.0, 2.3, 5.5, 6.0}) {
          a.eval(x, y, row_a.data(), support_a.data());
          b.eval(x, y, row_b.data(), support_b.data());
          for (std::size_t i = 0; i < a.row(); ++i) ASSERT_NEAR(row_a[i], row_b[i], 2e-5f) << i;
          for (std::size_t c = 0; c < 3; ++c)
            ASSERT_NEAR(support_a[c], support_b[c], 1e-4f * support_b[c]);
        }
    }
}

TEST(BlendField, IsTheModelsOwnProfileUpToItsSupport) {
  const ProfileBlend blend = make_blend(3, 9, 1);
  const ProfileField field = make_profile_field(Material(blend));
  std::vector<float> row(field.row()), support(3);
  for (int y = 0; y < blend.height; ++y)
    for (int x = 0; x < blend.width; ++x) {
      field.eval(x, y, row.data(), support.data());
      const Profile profile = get_profile(blend, 0, x, y);
      EXPECT_FLOAT_EQ(support[2], static_cast<float>(profile.support_mm));
      for (std::size_t k = 0; k < field.knots(); ++k) {
        const auto r = static_cast<double>(field.knots_mm[k]);
        if (r <= profile.support_mm) {
          EXPECT_NEAR(2 * row[3 * k + 2], eval_log_profile(profile, r), 4e-6) << r;
        }
      }
    }
}

TEST(BlendField, DilatedBlendsAreResampledAsTheirMaps) {
  ProfileBlend blend = make_blend(2);
  for (std::size_t i = 0; i < 3 * blend.pixels(); ++i)
    blend.dilation.push_back(0.5f + 0.01f * static_cast<float>(i));
  const ProfileField a = make_profile_field(Material(blend));
  const ProfileField b = make_profile_field(Material(make_profile_map(blend)));
  ASSERT_EQ(a.knots(), b.knots());
  std::vector<float> row_a(a.row()), row_b(b.row()), support(3);
  a.eval(2.5, 1.25, row_a.data(), support.data());
  b.eval(2.5, 1.25, row_b.data(), support.data());
  for (std::size_t i = 0; i < a.row(); ++i) EXPECT_NEAR(row_a[i], row_b[i], 1e-4);
}

std::string error_of(const ProfileBlend& blend) {
  return parian::error_of([&] { check(blend, "b.kbm"); });
}

TEST(ProfileBlend, CheckNamesWhatIsWrong) {
  const ProfileBlend good = make_blend(2);
  EXPECT_EQ(error_of(good), "no error");
  ProfileBlend blend = good;
  blend.index[9] = 9;
  EXPECT_EQ(error_of(blend), "b.kbm: pixel (2, 1): expected an index below 9, found 9");
  blend = good;
  blend.weight[3] = 1.25f;
  EXPECT_EQ(error_of(blend),
            "b.kbm: pixel (3, 0): expected weights that sum to at most 1, found 1.25");
  blend.weight[3] = -0.5f;
  EXPECT_EQ(error_of(blend), "b.kbm: weights, value 3: expected a finite value >= 0, found -0.5");
  blend = good;
  blend.base_log_profile = {0, -1, -2, -3, 0, -1, -2, -1.5f, 0, -1, -2, -3};
  EXPECT_EQ(error_of(blend), "b.kbm: base 0, channel 1, knot 3: expected at most -2, found -1.5");
  blend = good;
  blend.per_pixel = 9;
  EXPECT_EQ(error_of(blend), "b.kbm: per_pixel: expected a value in [1, 8], found 9");
  blend = good;
  blend.index.pop_back();
  EXPECT_EQ(error_of(blend), "b.kbm: indices: expected 70 values, found 69");
  blend = good;
  snap_to_grid(blend, {0.25, 4});
  blend.weight[0] = 0.3f;
  EXPECT_EQ(
      error_of(blend),
      "b.kbm: pixel (0, 0): expected weights that are multiples of 1/4, found 0.30000001192092896");
  blend = good;
  snap_to_grid(blend, {0.25, 4});
  blend.base_log_profile[0] = 100.1f;
  EXPECT_EQ(error_of(blend),
            "b.kbm: base 0, channel 0, knot 0: expected a multiple of 0.25, found 100.1");
}

template <typename Change>
std::string error_after(const Change& change) {
  ProfileBlend blend = make_blend(2);
  change(blend);
  return error_of(blend);
}

TEST(ProfileBlend, CheckNamesWhatIsWrongWithSizes) {
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.width = 0; }),
            "b.kbm: size: expected width and height of at least 1, 1 or 3 channels, found 0 x 5 "
            "pixels, 3 channels");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.channels = 2; }),
            "b.kbm: size: expected width and height of at least 1, 1 or 3 channels, found 7 x 5 "
            "pixels, 2 channels");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.pixel_pitch_mm = 0; }),
            "b.kbm: pixel_pitch_mm: expected a finite length > 0, found 0");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.knots_mm[0] = 0.25; }),
            "b.kbm: knots_mm: expected two or more knots from 0, found 4 that begin at 0.25");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.knots_mm[2] = 0.5; }),
            "b.kbm: knots_mm[2]: expected a finite value > 0.5, found 0.5");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.base_log_profile.clear(); }),
            "b.kbm: bases: expected 1 to 65535 base profiles, found 0");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.base_log_profile.pop_back(); }),
            "b.kbm: base profiles: expected 96 values, found 107");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.grid.weight_levels = 65536; }),
            "b.kbm: grid: expected a step in [0, 1] and levels in [0, 65535], found 0 and 65536");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.weight.push_back(0); }),
            "b.kbm: weights: expected 35 values, found 36");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.gain = {1}; }),
            "b.kbm: gain: expected 105 values, found 1");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.dilation.assign(105, 0); }),
            "b.kbm: dilation, value 0: expected a finite value > 0, found 0");
  EXPECT_EQ(error_after([](ProfileBlend& b) { b.base_log_profile[5] = NAN; }),
            "b.kbm: base profiles, value 5: expected a finite value, found nan");
}

}  // namespace
}  // namespace parian

#include "material/profile_blend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/random.h"
#include "material/bssrdf_table.h"
#include "material/material.h"
#include "material/profile_field.h"

namespace parian {
namespace {

ProfileBlend make_blend(int per_pixel, int bases = 9, int channels = 3) {
  ProfileBlend blend;
  blend.width = 7;
  blend.height = 5;
  blend.channels = channels;
  blend.per_pixel = per_pixel;
  blend.pixel_pitch_mm = 0.5;
  blend.knots_mm = {0, 0.5, 1, 2};
  Rng rng = make_rng(3);
  for (int i = 0; i < bases * channels; ++i) {
    float value = static_cast<float>(sample_normal(rng));
    for (std::size_t k = 0; k < blend.knots_mm.size(); ++k)
      blend.base_log_profile.push_back(value -= static_cast<float>(sample_uniform(rng)));
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(per_pixel) * blend.pixels(); ++i)
    blend.index.push_back(
        static_cast<std::uint16_t>(sample_u32(rng) % static_cast<std::uint32_t>(bases)));
  for (std::size_t i = 0; i < static_cast<std::size_t>(per_pixel - 1) * blend.pixels(); ++i)
    blend.weight.push_back(static_cast<float>(sample_uniform(rng) / per_pixel));
  return blend;
}

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

TEST(ProfileBlend, PaperBytes) {
  ProfileBlend blend = make_blend(2, 128);
  EXPECT_EQ(paper_bytes(blend), 12 * 128 * 4 + 6 * blend.pixels());
  blend = make_blend(3, 300, 1);
  EXPECT_EQ(paper_bytes(blend), 4 * 300 * 4 + (6 + 8) * blend.pixels());
}

// The field mixes bases; it must be the expanded map's, tails and gains included.
TEST(BlendField, IsTheFieldOfTheExpandedMap) {
  for (bool has_gain : {false, true})
    for (int k : {1, 2, 4}) {
      ProfileBlend blend = make_blend(k);
      // Some bases fall slower than the minimum decay beyond the last knot.
      for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t c = 0; c < 3; ++c)
          blend.base_log_profile[(j * 3 + c) * 4 + 3] = blend.base_log_profile[(j * 3 + c) * 4 + 2];
      if (has_gain)
        for (std::size_t i = 0; i < 3 * blend.pixels(); ++i)
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

std::string error_of(const ProfileBlend& blend) {
  try {
    check(blend, "b.kbm");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
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

}  // namespace
}  // namespace parian

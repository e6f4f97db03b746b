#include "compress/compress.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "base/test_errors.h"
#include "compress/test_materials.h"

namespace parian {
namespace {

// Few base profiles, mixed by two at random.
ProfileBlend make_planted(int bases, int width = 20, int height = 16) {
  ProfileBlend blend;
  blend.width = width;
  blend.height = height;
  blend.per_pixel = 2;
  blend.pixel_pitch_mm = 0.5;
  for (int k = 0; k < 6; ++k) blend.knots_mm.push_back(0.5 * k);
  Rng rng = make_rng(11);
  for (int j = 0; j < bases; ++j)
    for (int c = 0; c < 3; ++c) {
      const double level = -1 + 2 * sample_uniform(rng), slope = 0.6 + 2 * sample_uniform(rng);
      for (double r : blend.knots_mm)
        blend.base_log_profile.push_back(static_cast<float>(level - slope * r));
    }
  for (std::size_t k = 0; k < 2; ++k)
    for (std::size_t x = 0; x < blend.pixels(); ++x)
      blend.index.push_back(
          static_cast<std::uint16_t>(sample_u32(rng) % static_cast<std::uint32_t>(bases)));
  for (std::size_t x = 0; x < blend.pixels(); ++x)  // every third pixel is pure
    blend.weight.push_back(x % 3 == 0 ? 1.0f : static_cast<float>(sample_uniform(rng)));
  return blend;
}

CompressParams make_params(int bases, int per_pixel, Objective objective = Objective::balanced) {
  CompressParams params;
  params.bases = bases;
  params.per_pixel = per_pixel;
  params.objective = objective;
  params.rounds = 30;
  params.tolerance = 1e-5;
  return params;
}

TEST(Compress, EveryRoundLowersEveryObjective) {
  const ProfileMap map = make_test_map();
  const BssrdfTable table = make_test_table(map, 0.05);
  const auto source = make_slices(table);
  for (Objective objective :
       {Objective::balanced, Objective::paper, Objective::relative, Objective::albedo})
    for (int per_pixel : {1, 2, 4}) {
      CompressReport report;
      compress_profiles(map, source.get(), make_params(12, per_pixel, objective), {}, &report);
      ASSERT_GT(report.rounds.size(), 3u);
      for (std::size_t i = 1; i < report.rounds.size(); ++i)
        EXPECT_LE(report.rounds[i].energy, report.rounds[i - 1].energy * (1 + 1e-6))
            << static_cast<int>(objective) << " K " << per_pixel << " round " << i;
      EXPECT_LT(report.rounds.back().energy, 0.999 * report.rounds.front().energy);
    }
}

TEST(Compress, RecoversPlantedBases) {
  const ProfileBlend planted = make_planted(5);
  const ProfileMap map = make_profile_map(planted);
  CompressState state =
      make_compress_state(map, make_blend_objective(map, nullptr, Objective::balanced), [] {
        CompressParams params = make_params(5, 2);
        params.rounds = 200;
        params.tolerance = 0;
        return params;
      }());
  while (!state.done) advance(state);
  EXPECT_LT(estimate_errors(state).relative, 0.01);
  EXPECT_LT(estimate_errors(state).albedo, 0.01);
}

TEST(Compress, OneBasePerDistinctProfileReproducesTheMap) {
  ProfileBlend planted = make_planted(7);
  for (float& weight : planted.weight) weight = 1;
  const ProfileMap map = make_profile_map(planted);
  const ProfileBlend blend = compress_profiles(map, nullptr, make_params(7, 1));
  const ProfileMap back = make_profile_map(blend);
  for (std::size_t i = 0; i < map.log_profile.size(); ++i)
    ASSERT_NEAR(back.log_profile[i], map.log_profile[i], 2e-3f) << i;
}

TEST(Compress, MoreBasesPerPixelNeverLose) {
  const ProfileMap map = make_test_map();
  double before = HUGE_VAL;
  for (int per_pixel = 2; per_pixel <= 5; ++per_pixel) {
    CompressReport report;
    compress_profiles(map, nullptr, make_params(10, per_pixel), {}, &report);
    EXPECT_LE(report.energy, before) << per_pixel;
    before = report.energy;
  }
}

// From a map that is 5 % too bright everywhere the blend gets back to the table.
TEST(Compress, TheTableLeadsBeyondTheMap) {
  const ProfileMap exact = make_test_map();
  const BssrdfTable table = make_test_table(exact);
  const auto source = make_slices(table);
  ProfileMap map = exact;
  for (float& value : map.log_profile) value += 0.05f;
  CompressState state = make_compress_state(
      map, make_blend_objective(map, source.get(), Objective::balanced), make_params(60, 2));
  while (!state.done) advance(state);
  EXPECT_LT(estimate_errors(state).albedo, 0.01);
  const ProfileBlend blend = make_blend(state);
  double miss = 0;
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x)
      miss += eval_log_profile(get_profile(blend, 0, x, y), 0.5) -
              eval_log_profile(get_profile(exact, 0, x, y), 0.5);
  EXPECT_NEAR(miss / static_cast<double>(map.pixels()), 0, 0.01);
}

TEST(Compress, LatticeValuesAreMultiplesAndLoseLittle) {
  const ProfileMap map = make_test_map();
  CompressParams params = make_params(12, 2);
  const auto objective = make_blend_objective(map, nullptr, Objective::balanced);
  CompressState free = make_compress_state(map, objective, params);
  while (!free.done) advance(free);
  params.weight_levels = 255;
  params.profile_step = 0.001;
  CompressState state = make_compress_state(map, objective, params);
  while (!state.done) advance(state);
  EXPECT_LT(state.run.energy, 1.3 * free.run.energy);
  const ProfileBlend blend = make_blend(state);
  EXPECT_EQ(blend.grid.weight_levels, 255);
  EXPECT_DOUBLE_EQ(blend.grid.profile_step, 0.001);
  EXPECT_NO_THROW(check(blend, "blend"));  // on the grid, on the simplex, non-increasing
}

TEST(Compress, SameBitsForAnyNumberOfThreadsAndAgain) {
  const ProfileMap map = make_test_map(30, 20);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return compress_profiles(map, nullptr, make_params(12, 3));
  };
  const ProfileBlend one = run(1), two = run(2);
  EXPECT_EQ(one.base_log_profile, two.base_log_profile);
  EXPECT_EQ(one.index, two.index);
  EXPECT_EQ(one.weight, two.weight);
}

TEST(Compress, SeedsLeadToOtherStartsWithSimilarEnds) {
  const ProfileMap map = make_test_map();
  CompressParams params = make_params(12, 2);
  CompressReport first, second;
  const ProfileBlend a = compress_profiles(map, nullptr, params, {}, &first);
  params.seed = 2;
  const ProfileBlend b = compress_profiles(map, nullptr, params, {}, &second);
  EXPECT_NE(a.base_log_profile, b.base_log_profile);
  EXPECT_LT(first.energy, 3 * second.energy);
  EXPECT_LT(second.energy, 3 * first.energy);
}

TEST(Compress, AStateGoesOnWhereItsCopyWas) {
  const ProfileMap map = make_test_map();
  CompressState state = make_compress_state(
      map, make_blend_objective(map, nullptr, Objective::balanced), make_params(12, 3));
  for (int i = 0; i < 5; ++i) advance(state);
  CompressState copy = state;
  while (!state.done) advance(state);
  while (!copy.done) advance(copy);
  EXPECT_EQ(make_blend(state).base_log_profile, make_blend(copy).base_log_profile);
  EXPECT_EQ(make_blend(state).index, make_blend(copy).index);
}

TEST(Compress, GoesOnFromABlend) {
  const ProfileMap map = make_test_map();
  const auto objective = make_blend_objective(map, nullptr, Objective::balanced);
  CompressParams params = make_params(12, 2);
  params.rounds = 3;
  CompressState first = make_compress_state(map, objective, params);
  while (!first.done) advance(first);
  const ProfileBlend blend = make_blend(first);
  CompressState second = make_compress_state(map, objective, params, &blend);
  EXPECT_NEAR(second.run.energy, first.run.energy, 1e-4 * first.run.energy);
  while (!second.done) advance(second);
  EXPECT_LE(second.run.energy, first.run.energy * (1 + 1e-4));
}

TEST(Compress, GainAndDilationAreWrittenIntoTheProfiles) {
  ProfileMap map = make_test_map(8, 6);
  map.gain.assign(3 * map.pixels(), 0.5f);
  map.dilation.assign(3 * map.pixels(), 0.8f);
  CompressParams params = make_params(static_cast<int>(map.pixels()), 1);
  params.rounds = 0;
  const ProfileBlend blend = compress_profiles(map, nullptr, params);
  for (double r : {0.0, 0.5, 1.5})
    EXPECT_NEAR(eval_log_profile(get_profile(blend, 1, 3, 2), r),
                eval_log_profile(get_profile(map, 1, 3, 2), r), 1e-4);
}

// A fit without projection may leave profiles that rise; no base of a blend may.
TEST(Compress, ProfilesThatRiseAreTakenAsTheNearestThatDoNot) {
  ProfileMap map = make_test_map(6, 5, 1), rising = map;
  float &third = knot_plane(rising, 0, 2)[7], &fourth = knot_plane(rising, 0, 3)[7];
  knot_plane(map, 0, 2)[7] = knot_plane(map, 0, 3)[7] = 0.5F * (third + fourth);
  std::swap(third, fourth);
  ASSERT_LT(third, fourth);
  for (const Objective objective : {Objective::balanced, Objective::paper}) {
    const CompressParams params{.bases = 30, .per_pixel = 1, .objective = objective};
    const ProfileBlend blend = compress_profiles(rising, nullptr, params);
    EXPECT_NO_THROW(check(blend, "blend"));
    EXPECT_EQ(blend.base_log_profile, compress_profiles(map, nullptr, params).base_log_profile);
  }
}

TEST(Compress, BadInputIsNamed) {
  const ProfileMap map = make_test_map(8, 6);
  const auto objective = make_blend_objective(map, nullptr, Objective::balanced);
  EXPECT_EQ(error_of([&] { make_compress_state(map, objective, make_params(0, 2)); }),
            "bases: expected a value in [1, 65535], found 0");
  EXPECT_EQ(error_of([&] { make_compress_state(map, objective, make_params(8, 9)); }),
            "per-pixel: expected a value in [1, 8], found 9");
  ProfileBlend start = make_planted(4, 9, 6);
  EXPECT_EQ(
      error_of([&] { make_compress_state(map, objective, make_params(8, 2), &start); }),
      "start: expected a blend of 8 x 6 pixels, 3 channels and the fit's 6 knots, found 9 x 6 "
      "pixels, 3 channels, 6 knots");
  start = make_planted(4, 8, 6);
  EXPECT_EQ(error_of([&] { make_compress_state(map, objective, make_params(8, 1), &start); }),
            "start: expected at most 1 bases per pixel, found 2");
  const ProfileMap other = make_test_map(7, 6);
  const BssrdfTable table = make_test_table(other);
  const auto source = make_slices(table, "other.h5");
  EXPECT_EQ(error_of([&] { make_blend_objective(map, source.get(), Objective::balanced); }),
            "other.h5: grid: expected 8 x 6 pixels, 3 channels, as the map, found 7 x 6 pixels, 3 "
            "channels");
}

}  // namespace
}  // namespace parian

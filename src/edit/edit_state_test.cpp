#include "edit/edit_state.h"

#include <gtest/gtest.h>

#include "edit/test_states_internal.h"

namespace parian {
namespace {

TEST(EditState, PlanesAgreeWithEachProfile) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const EditState state = make_random_state(seed, 11, 7, seed % 2 == 0 ? 3 : 1);
    const Plane albedo = albedo_plane(state), range = range_plane(state),
                radius = mean_radius_plane(state);
    for (std::size_t i = 0; i < state.values(); ++i) {
      const int pixel = static_cast<int>(i % state.pixels());
      const ProfileProperties properties = measure_properties(get_profile(
          state, static_cast<int>(i / state.pixels()), pixel % state.width, pixel / state.width));
      EXPECT_NEAR(albedo[i] / properties.albedo, 1, 1e-12);
      EXPECT_NEAR(range[i] / properties.range_mm, 1, 1e-12);
      EXPECT_EQ(radius[i], properties.mean_radius_mm);
    }
  }
}

TEST(EditState, MapsComeBackBitForBit) {
  ProfileMap map = make_random_map(3, 9, 5, 3);
  const ProfileMap back = make_profile_map(make_edit_state(map));
  EXPECT_EQ(back.log_profile, map.log_profile);
  EXPECT_EQ(back.gain, map.gain);
  EXPECT_EQ(back.dilation, map.dilation);
  map.gain.clear();
  map.dilation.clear();
  EXPECT_TRUE(make_profile_map(make_edit_state(map)).gain.empty());
}

TEST(EditState, SettingPropertiesClampsAndCounts) {
  EditState state = make_random_state(5, 4, 3, 3);
  const Plane albedo = albedo_plane(state), range = range_plane(state);
  Plane after = albedo;
  after[2] = -1;
  after[7] *= 2;
  EditReport report;
  const auto gain = state.gain;
  set_albedo(state, albedo, after, report);
  EXPECT_EQ(report.clamped_albedo, 1u);
  EXPECT_NEAR(albedo_plane(state)[2], least_albedo, 1e-18);
  EXPECT_NEAR(albedo_plane(state)[7], 2 * albedo[7], 1e-12);
  EXPECT_EQ((*state.gain)[3], (*gain)[3]);
  Plane short_range = range;
  short_range[0] = 0;
  set_range(state, range, short_range, report);
  EXPECT_EQ(report.clamped_range, 1u);
  EXPECT_NEAR(range_plane(state)[0], 0.5 * state.pixel_pitch_mm, 1e-12);
}

}  // namespace
}  // namespace parian

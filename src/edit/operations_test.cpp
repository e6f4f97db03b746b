// Properties that every edit keeps, over random materials, masks and parameters.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <numeric>

#include "edit/adjust.h"
#include "edit/blend.h"
#include "edit/bound.h"
#include "edit/geometry.h"
#include "edit/paste.h"
#include "edit/session.h"
#include "edit/shape_edit.h"
#include "edit/smooth.h"
#include "edit/test_states_internal.h"
#include "judge/row_sums.h"
#include "material/bssrdf_table.h"
#include "material/material.h"

namespace parian {
namespace {

constexpr int width = 13, height = 9;

// One edit of each kind that takes a mask, with random parameters.
using Edit = std::function<void(EditState& state, const Mask& mask)>;
struct NamedEdit {
  std::string name;
  bool albedo, range, shape;  // what it may change
  Edit apply;
};

std::vector<NamedEdit> random_edits(std::uint64_t seed) {
  Rng rng = make_rng(seed, 5);
  const auto between = [&](double a, double b) { return random_between(rng, a, b); };
  EditReport* report = [] {
    static EditReport ignored;
    return &ignored;
  }();
  const EditState other = match_knots(make_random_state(seed + 100, width, height),
                                      make_random_state(seed, 1, 1).knots_mm);
  std::vector<NamedEdit> edits;
  Adjust albedo, range, color;
  albedo.albedo_scale = {between(0.2, 3), between(0.2, 3), between(0.2, 3)};
  albedo.albedo_offset = {between(-0.01, 0.5)};
  range.range_scale = {between(0.3, 3)};
  range.range_offset_mm = {between(0, 2), 0, between(0, 2)};
  color.color = {between(-180, 180), between(0, 2), between(0.5, 1.5)};
  const auto adjust = [=](const Adjust& parameters) {
    return [=](EditState& state, const Mask& mask) { apply(parameters, state, mask, *report); };
  };
  edits.push_back({"albedo", true, false, false, adjust(albedo)});
  edits.push_back({"range", false, true, false, adjust(range)});
  edits.push_back({"color", true, false, false, adjust(color)});
  const auto blend = [=](BlendAmounts amounts) {
    return [=](EditState& state, const Mask& mask) {
      std::vector<std::uint32_t> all(state.pixels());
      std::iota(all.begin(), all.end(), 0u);
      apply(amounts, other, all, state, mask, *report);
    };
  };
  edits.push_back({"blend albedo", true, false, false, blend({between(0, 1), 0, 0})});
  edits.push_back({"blend range", false, true, false, blend({0, between(0, 1), 0})});
  edits.push_back({"blend shape", false, false, true, blend({0, 0, between(0, 1)})});
  edits.push_back({"blend all", true, true, true, blend({1, 1, 1})});
  ShapeEdit shape;
  shape.falloff = between(0.5, 2);
  shape.scale = {{0, between(0.5, 2)}, {0.3, between(0.5, 2)}, {1, between(0.5, 2)}};
  shape.offset = {{0, between(-0.1, 0.1)}, {1, 0}};
  edits.push_back({"shape", false, false, true,
                   [=](EditState& state, const Mask& mask) { apply(shape, state, mask); }});
  FilterParams filter;
  filter.sigma_mm = between(0.3, 1.5);
  filter.kind = static_cast<FilterKind>(seed % 3);
  edits.push_back({"filter", true, true, false, [=](EditState& state, const Mask& mask) {
                     apply(filter, state, mask, *report);
                   }});
  filter.albedo = filter.range = false;
  filter.shape = true;
  edits.push_back({"filter shape", false, false, true, [=](EditState& state, const Mask& mask) {
                     apply(filter, state, mask, *report);
                   }});
  PasteParams paste;
  paste.rotation_deg = between(-180, 180);
  paste.flip = seed % 2 == 0;
  paste.mixed = seed % 3 == 0;
  paste.keep_mean = true;
  edits.push_back({"paste", true, true, false, [=](EditState& state, const Mask& mask) {
                     Pattern pattern = make_pattern(other);
                     apply(paste, pattern, {width / 2.0, height / 2.0}, state, mask, *report);
                   }});
  return edits;
}

bool falls(const EditState& state) {
  const std::size_t knots = state.knots_mm.size(), pixels = state.pixels();
  for (std::size_t c = 0; c < static_cast<std::size_t>(state.channels); ++c)
    for (std::size_t k = 0; k + 1 < knots; ++k)
      for (std::size_t i = 0; i < pixels; ++i)
        if (state.shapes->log_profile[(c * knots + k + 1) * pixels + i] >
            state.shapes->log_profile[(c * knots + k) * pixels + i])
          return false;
  return true;
}

template <typename T>
bool same_bits(const T& a, const T& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

bool same_bits(const EditState& a, const EditState& b) {
  return same_bits(a.shapes->log_profile, b.shapes->log_profile) && same_bits(*a.gain, *b.gain) &&
         same_bits(*a.dilation, *b.dilation);
}

void expect_near(const Plane& a, const Plane& b, double tolerance, const std::string& what) {
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i] / b[i], 1, tolerance) << what;
}

// ln S of every profile at a few places.
std::vector<double> shapes_of(const EditState& state) {
  std::vector<double> values;
  for (int c = 0; c < state.channels; ++c)
    for (int y = 0; y < state.height; ++y)
      for (int x = 0; x < state.width; ++x) {
        const Profile shape = profile_shape(get_profile(state, c, x, y));
        for (double u : {0.0, 0.21, 0.5, 0.87}) values.push_back(eval_log_profile(shape, u));
      }
  return values;
}

TEST(Operations, KeepDecayAndSymmetry) {
  for (std::uint64_t seed = 0; seed < 6; ++seed)
    for (const NamedEdit& edit : random_edits(seed)) {
      EditState state = make_random_state(seed, width, height);
      edit.apply(state, make_random_mask(seed, width, height));
      EXPECT_TRUE(falls(state)) << edit.name;
      const ProfileMap map = make_profile_map(state);
      check(map, edit.name);  // finite and positive
      // Light from a to b as from b to a, bit for bit: the two halves of the table agree.
      const Material material = map;
      TableHeader header = natural_header(material);
      header.symmetric = false;
      header.offsets = {{0, 0}, {2, 1}, {-2, -1}};
      const auto slices = make_slices(material, header);
      std::vector<float> there(map.pixels()), back(map.pixels());
      slices->read_slice(1, 1, there.data());
      slices->read_slice(1, 2, back.data());
      for (int y = 0; y + 1 < height; ++y)
        for (int x = 0; x + 2 < width; ++x)
          EXPECT_EQ(there[static_cast<std::size_t>(y * width + x)],
                    back[static_cast<std::size_t>((y + 1) * width + x + 2)])
              << edit.name;
    }
}

TEST(Operations, AMaskOfZeroChangesNoBit) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const EditState before = make_random_state(seed, width, height);
    Mask mask = make_random_mask(seed, width, height);
    for (const NamedEdit& edit : random_edits(seed)) {
      EditState state = before;
      edit.apply(state, mask);
      for (std::size_t i = 0; i < before.values(); ++i) {
        if (mask.weight[i % before.pixels()] != 0) continue;
        EXPECT_EQ((*state.gain)[i], (*before.gain)[i]) << edit.name;
        EXPECT_EQ((*state.dilation)[i], (*before.dilation)[i]) << edit.name;
      }
      const std::size_t pixels = before.pixels();
      for (std::size_t i = 0; i < before.shapes->log_profile.size(); ++i) {
        if (mask.weight[i % pixels] != 0) continue;
        EXPECT_EQ(state.shapes->log_profile[i], before.shapes->log_profile[i]) << edit.name;
      }
    }
  }
}

TEST(Operations, EachLeavesTheOtherPropertiesAlone) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const EditState before = make_random_state(seed, width, height);
    for (const NamedEdit& edit : random_edits(seed)) {
      EditState state = before;
      edit.apply(state, make_random_mask(seed, width, height));
      if (!edit.albedo) expect_near(albedo_plane(state), albedo_plane(before), 1e-12, edit.name);
      if (!edit.range) expect_near(range_plane(state), range_plane(before), 1e-12, edit.name);
      if (edit.shape) continue;
      EXPECT_EQ(state.shapes, before.shapes) << edit.name;
      const std::vector<double> a = shapes_of(state), b = shapes_of(before);
      for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 1e-10) << edit.name;
    }
  }
}

float next_ulps(float value, int ulps) {
  for (int i = 0; i < std::abs(ulps); ++i) value = std::nextafter(value, ulps > 0 ? 1e30f : 0.0f);
  return value;
}

TEST(Operations, AnInverseEditRestoresGainAndDilation) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng = make_rng(seed, 6);
    const EditState before = make_random_state(seed, width, height);
    EditState state = before;
    Adjust edit, inverse;
    const double s = random_between(rng, 0.3, 3), o = random_between(rng, 0, 0.3);
    const double t = random_between(rng, 0.5, 3), p = random_between(rng, 0.1, 2);
    edit.albedo_scale = {s};
    edit.albedo_offset = {o};
    edit.range_scale = {t};
    edit.range_offset_mm = {p};
    inverse.albedo_scale = {1 / s};
    inverse.albedo_offset = {-o / s};
    inverse.range_scale = {1 / t};
    inverse.range_offset_mm = {-p / t};
    const Mask all = make_mask(width, height, 1);
    EditReport report;
    apply(edit, state, all, report);
    apply(inverse, state, all, report);
    EXPECT_EQ(report.clamped_albedo + report.clamped_range, 0u);
    const ProfileMap a = make_profile_map(before), b = make_profile_map(state);
    for (std::size_t i = 0; i < a.gain.size(); ++i) {
      EXPECT_LE(b.gain[i], next_ulps(a.gain[i], 2));
      EXPECT_GE(b.gain[i], next_ulps(a.gain[i], -2));
      EXPECT_LE(b.dilation[i], next_ulps(a.dilation[i], 2));
      EXPECT_GE(b.dilation[i], next_ulps(a.dilation[i], -2));
    }
  }
}

TEST(Operations, AdjustmentsComposeAsAffineMaps) {
  const EditState before = make_random_state(3, width, height);
  Adjust first, second, both;
  first.albedo_scale = {1.7};
  first.albedo_offset = {0.2};
  second.albedo_scale = {0.6};
  second.albedo_offset = {0.05};
  both.albedo_scale = {1.7 * 0.6};
  both.albedo_offset = {0.2 * 0.6 + 0.05};
  EditState step = before, once = before;
  EditReport report;
  const Mask all = make_mask(width, height, 1);
  apply(first, step, all, report);
  apply(second, step, all, report);
  apply(both, once, all, report);
  expect_near(albedo_plane(step), albedo_plane(once), 1e-14, "affine");
}

TEST(Operations, BlendsAgreeWithProfileByProfile) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const EditState before = make_random_state(seed, width, height);
    const EditState other = make_random_state(seed + 50, width, height);
    Mask mask = make_random_mask(seed, width, height);
    EditState state = before;
    EditReport report;
    std::vector<std::uint32_t> all(state.pixels());
    std::iota(all.begin(), all.end(), 0u);
    apply({0.7, 1, 0.8}, other, all, state, mask, report);
    for (int c = 0; c < 3; ++c)
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const auto w = static_cast<double>(mask.weight[static_cast<std::size_t>(y * width + x)]);
          const Profile expected = blend_profiles(
              get_profile(before, c, x, y), get_profile(other, c, x, y), {0.7 * w, w, 0.8 * w});
          const Profile found = get_profile(state, c, x, y);
          EXPECT_NEAR(found.support_mm / expected.support_mm, 1, 1e-4);
          for (std::size_t k = 0; k < found.knots_mm.size(); ++k) {
            EXPECT_NEAR(found.knots_mm[k], expected.knots_mm[k], 1e-5 * expected.knots_mm.back());
            EXPECT_NEAR(found.log_value[k], expected.log_value[k], 2e-4);
          }
        }
  }
}

TEST(Operations, ABlendOfAllIsTheSource) {
  const EditState other = make_random_state(51, width, height);
  EditState state = make_random_state(1, width, height);
  std::vector<std::uint32_t> all(state.pixels());
  std::iota(all.begin(), all.end(), 0u);
  EditReport report;
  apply({1, 1, 1}, other, all, state, make_mask(width, height, 1), report);
  EXPECT_TRUE(same_bits(state.shapes->log_profile, other.shapes->log_profile));
  expect_near(*state.gain, *other.gain, 1e-14, "gain");
  expect_near(*state.dilation, *other.dilation, 1e-14, "dilation");
}

TEST(Operations, MatchingKnotsKeepsProperties) {
  const EditState state = make_random_state(4, 5, 4);
  const EditState stretched = match_knots(state, {0, 1, 2, 3.5, 5, 8, 12});  // twice the knots
  EXPECT_TRUE(same_bits(stretched.shapes->log_profile, state.shapes->log_profile));
  const EditState other = match_knots(state, {0, 0.3, 0.9, 2, 6});
  for (const EditState* matched : {&stretched, &other}) {
    expect_near(albedo_plane(*matched), albedo_plane(state), 1e-12, "albedo");
    expect_near(range_plane(*matched), range_plane(state), 1e-12, "range");
    EXPECT_TRUE(falls(*matched));
  }
}

TEST(Operations, MonotoneProfilesStayAndOthersFall) {
  ProfileMap map = make_random_map(2, width, height, 3);
  EditState state = make_edit_state(map);
  const Mask all = make_mask(width, height, 1);
  EXPECT_EQ(make_monotone(state, all), 0u);
  knot_plane(map, 1, 3)[5] += 4;
  state = make_edit_state(map);
  const Plane albedo = albedo_plane(state);
  EXPECT_EQ(make_monotone(state, all), 1u);
  EXPECT_TRUE(falls(state));
  expect_near(albedo_plane(state), albedo, 1e-12, "albedo");
}

// Algorithms, section 10: every profile integrates to at most 1, and a row of R_d to 2.
ProfileMap make_counterexample() {
  constexpr int size = 31, middle = 15;
  constexpr double pitch = 0.2, reach = 2.42;
  std::vector<double> knots{0};
  knots.reserve(41);
  for (int k = 1; k <= 40; ++k) knots.push_back(0.1 * k);
  ProfileMap map = make_profile_map(size, size, 1, pitch, knots, -30);
  const auto set_disc = [&](int x, int y, double radius) {
    const double level = -std::log(M_PI * radius * radius);
    for (std::size_t k = 0; k < knots.size(); ++k)
      knot_plane(map, 0, static_cast<int>(k))[y * size + x] =
          static_cast<float>(knots[k] <= radius ? level : -30.0);
  };
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      set_disc(x, y, std::min(3.8, std::hypot(x - middle, y - middle) * pitch + 0.11));
  set_disc(middle, middle, reach);
  return map;
}

TEST(Operations, TheEnergyBoundHoldsWhereBoundedProfilesDoNot) {
  const auto largest = [](const EditState& state) {
    const Material material = make_profile_map(state);
    return measure_row_sums(*make_slices(material, natural_header(material))).max;
  };
  EditState state = make_edit_state(make_counterexample());
  for (double albedo : albedo_plane(state)) EXPECT_LT(albedo, 1.25);
  const double before = largest(state);
  EXPECT_GT(before, 1.6);
  const Mask all = make_mask(state.width, state.height, 1);
  for (int iterations : {0, 4}) {
    EditState bounded = state;
    BoundParams params;
    params.iterations = iterations;
    EXPECT_EQ(bound_energy(params, bounded, all), before);
    EXPECT_LE(largest(bounded), 1.0 + 1e-6);
  }
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    EditState random = make_random_state(seed, width, height);
    bound_energy({}, random, make_mask(width, height, 1));
    EXPECT_LE(largest(random), 1.0 + 1e-6);
  }
}

TEST(Operations, GridsMoveWholeProfiles) {
  const EditState state = make_random_state(7, width, height);
  EXPECT_TRUE(same_bits(flip(flip(state, true, false), true, false), state));
  EXPECT_TRUE(same_bits(rotate_quarters(rotate_quarters(state, 1), 3), state));
  EXPECT_TRUE(same_bits(rotate(state, -450), rotate_quarters(state, 3)));
  EXPECT_EQ(get_profile(rotate_quarters(state, 1), 0, height - 1, 0).log_value,
            get_profile(state, 0, 0, 0).log_value);  // the left upper corner turns to the right
  const EditState tiled = tile(state, 2, 3, false);
  EXPECT_TRUE(same_bits(crop(tiled, width, height, 2 * width, 2 * height), state));
  const EditState mirrored = tile(state, 2, 1, true);
  EXPECT_TRUE(same_bits(crop(mirrored, width, 0, 2 * width, height), flip(state, true, false)));
}

TEST(Operations, ResamplingKeepsWhatIsEqualAndFallsEverywhere) {
  ProfileMap map = make_random_map(8, 1, 1, 3);
  const EditState one = make_edit_state(map);
  const EditState uniform = gather_pixels(one, std::vector<std::uint32_t>(48, 0), 8, 6);
  for (const EditState& changed :
       {resample_to_pitch(uniform, 0.2), resample_to_pitch(uniform, 1.3), rotate(uniform, 33)}) {
    const Plane albedo = albedo_plane(changed), range = range_plane(changed);
    for (std::size_t i = 0; i < changed.values(); ++i) {
      EXPECT_NEAR(albedo[i] / albedo_plane(one)[i / changed.pixels()], 1, 1e-6);
      EXPECT_NEAR(range[i] / range_plane(one)[i / changed.pixels()], 1, 1e-6);
    }
  }
  const EditState state = make_random_state(9, width, height);
  EXPECT_TRUE(falls(resample_to_pitch(state, 0.3)));
  EXPECT_TRUE(same_bits(resample_to_pitch(state, state.pixel_pitch_mm).shapes->log_profile,
                        state.shapes->log_profile));
  // Halving the resolution keeps the mean albedo but for the border.
  const EditState coarse = resample_to_pitch(make_random_state(10, 40, 40), 1.0);
  const auto mean = [](const Plane& plane) {
    return std::accumulate(plane.begin(), plane.end(), 0.0) / static_cast<double>(plane.size());
  };
  EXPECT_NEAR(mean(albedo_plane(coarse)) / mean(albedo_plane(make_random_state(10, 40, 40))), 1,
              0.02);
}

TEST(Operations, PastingAPatternOntoItselfChangesNothing) {
  const EditState before = make_random_state(11, width, height);
  EditState state = before;
  Mask inner = make_mask(width, height, 0);
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) inner.weight[static_cast<std::size_t>(y * width + x)] = 1;
  EditReport report;
  apply(PasteParams{}, make_pattern(before), {width / 2.0, height / 2.0}, state, inner, report);
  expect_near(albedo_plane(state), albedo_plane(before), 1e-4, "albedo");
  expect_near(range_plane(state), range_plane(before), 1e-4, "range");
}

TEST(Operations, AWideBilateralFilterIsAGaussian) {
  const EditState before = make_random_state(12, width, height);
  EditState gaussian = before, bilateral = before, sharp = before, blurred = before;
  EditReport report;
  const Mask all = make_mask(width, height, 1);
  FilterParams params;
  params.sigma_mm = 0.8;
  apply(params, gaussian, all, report);
  params.kind = FilterKind::bilateral;
  params.range_sigma = 1e5;
  apply(params, bilateral, all, report);
  expect_near(albedo_plane(bilateral), albedo_plane(gaussian), 1e-5, "albedo");
  expect_near(range_plane(bilateral), range_plane(gaussian), 1e-5, "range");
  params.kind = FilterKind::unsharp;
  params.amount = -1;
  apply(params, blurred, all, report);
  expect_near(albedo_plane(blurred), albedo_plane(gaussian), 1e-5, "unsharp by -1");
  params.amount = 0;
  apply(params, sharp, all, report);
  expect_near(albedo_plane(sharp), albedo_plane(before), 1e-6, "unsharp by 0");
}

}  // namespace
}  // namespace parian

#include "transport/moment_tree.h"

#include <gtest/gtest.h>

#include "base/test_errors.h"
#include "transport/test_surfaces.h"

namespace parian {
namespace {

struct Setting {
  ProfileField field;
  GatherSources sources;
  std::vector<GatherPoint> targets;
  double near_mm = 0;
  std::vector<Rgb> brute;
};

Setting make_setting(double steepness = 1) {
  Setting setting;
  setting.field = make_profile_field(make_checker(steepness));
  setting.sources = make_sphere_sources(6000, 8);
  setting.targets = make_sphere_points(500, 8, 0.37);
  setting.near_mm = default_near_mm(setting.sources.area_mm2);
  setting.brute = gather_brute(setting.field, setting.sources, setting.targets, setting.near_mm);
  return setting;
}

double largest_error(const Setting& setting, const TreeGatherResult& result) {
  double largest = 0;
  for (std::size_t i = 0; i < result.exitance.size(); ++i)
    largest = std::max(largest, relative_difference(result.exitance[i], setting.brute[i]));
  return largest;
}

TEST(MomentTree, BecomesBruteForceAsQualityRises) {
  const Setting setting = make_setting();
  const MomentTree tree(setting.field, setting.sources);
  double previous = 1, previous_count = 0;
  for (double quality : {3e-2, 3e-3, 3e-4, 3e-5}) {
    TreeGatherParams params;
    params.quality = quality;
    const TreeGatherResult result = tree.gather(setting.targets, setting.near_mm, params);
    const double error = largest_error(setting, result);
    EXPECT_LE(error, previous);
    EXPECT_LT(error, 8 * quality + 0.02);
    EXPECT_GT(result.nodes_per_target, previous_count);
    previous = error;
    previous_count = result.nodes_per_target;
  }
  TreeGatherParams params;
  params.quality = 0;
  EXPECT_LT(largest_error(setting, tree.gather(setting.targets, setting.near_mm, params)), 1e-5);
}

// Knots that are far denser than nodes are wide, and go on far beyond the support.
TEST(MomentTree, SeesSupportsThatEndAmongDenseKnots) {
  Setting setting = make_setting();
  const ProfileField dipole = make_profile_field(Material(Dipole{{{0.008, 3.2}}, 1.4}));
  setting.field = dipole;
  setting.field.width = 2;  // rows of their own
  const float last = dipole.knots_mm.back();
  for (int k = 1; k <= 20; ++k)
    setting.field.knots_mm.push_back(last * (1 + 0.03f * static_cast<float>(k)));
  setting.field.eval = [dipole](double x, double y, float* half_log, float* support) {
    dipole.eval(x, y, half_log, support);
    const std::size_t row = dipole.row();
    for (std::size_t j = 0; j < 60; ++j)
      half_log[row + j] = half_log[row - 3 + j % 3] - 0.03f * static_cast<float>(j / 3 + 1);
  };
  setting.brute = gather_brute(setting.field, setting.sources, setting.targets, setting.near_mm);
  const MomentTree tree(setting.field, setting.sources);
  TreeGatherParams params;
  params.quality = 5e-4;
  EXPECT_LT(largest_error(setting, tree.gather(setting.targets, setting.near_mm, params)), 0.02);
}

// The bracket of every target holds the exact sum.
TEST(MomentTree, BracketsHoldWithoutExceptions) {
  for (double steepness : {0.3, 1.0, 3.0}) {
    const Setting setting = make_setting(steepness);
    const MomentTree tree(setting.field, setting.sources);
    for (double quality : {1e-1, 1e-2, 1e-3}) {
      TreeGatherParams params;
      params.quality = quality;
      params.certify_every = 1;
      const TreeGatherResult result = tree.gather(setting.targets, setting.near_mm, params);
      EXPECT_EQ(result.certified, setting.targets.size());
      EXPECT_GT(result.max_half_width, 0);
      for (std::size_t i = 0; i < setting.targets.size(); ++i) {
        // The half-width is relative to the estimate.
        const double error = relative_difference(setting.brute[i], result.exitance[i]);
        EXPECT_LE(error, static_cast<double>(result.half_width[i]) + 1e-6);
      }
    }
  }
}

TEST(MomentTree, RefinesUntilTheToleranceIsCertified) {
  const Setting setting = make_setting();
  const MomentTree tree(setting.field, setting.sources);
  double previous = 0;
  for (double tolerance : {0.2, 0.05, 0.01}) {
    TreeGatherParams params;
    params.tolerance = tolerance;
    const TreeGatherResult result = tree.gather(setting.targets, setting.near_mm, params);
    EXPECT_EQ(result.certified, setting.targets.size());
    EXPECT_LE(result.max_half_width, tolerance);
    EXPECT_LE(largest_error(setting, result), tolerance / (1 - tolerance));
    EXPECT_GT(result.nodes_per_target, previous);
    previous = result.nodes_per_target;
  }
}

TEST(MomentTree, CertifiesEverySoManyBlocks) {
  const Setting setting = make_setting();
  const MomentTree tree(setting.field, setting.sources);
  TreeGatherParams params;
  params.certify_every = 0;
  EXPECT_EQ(tree.gather(setting.targets, setting.near_mm, params).certified, 0u);
  params.certify_every = 4;
  const TreeGatherResult some = tree.gather(setting.targets, setting.near_mm, params);
  EXPECT_NEAR(static_cast<double>(some.certified), 500.0 / 4, 8);
}

// The order of the targets does not matter, nor do rotation and the unit of length.
TEST(MomentTree, IsInvariant) {
  const Setting setting = make_setting();
  const MomentTree tree(setting.field, setting.sources);
  TreeGatherParams params;
  params.quality = 3e-4;
  const std::vector<Rgb> plain = tree.gather(setting.targets, setting.near_mm, params).exitance;
  const auto turn = [](Vec3 v) { return Vec3{-v.z, v.y, v.x}; };
  Setting turned = setting;
  for (auto* points : {&turned.sources.points, &turned.targets})
    for (GatherPoint& point : *points) {
      point.position = turn(point.position);
      point.normal = turn(point.normal);
    }
  const std::vector<Rgb> rotated = MomentTree(turned.field, turned.sources)
                                       .gather(turned.targets, turned.near_mm, params)
                                       .exitance;
  // Ten times as large in every respect: R_d falls by 100, areas grow by 100.
  ProfileMap map = make_checker();
  for (double& knot : map.knots_mm) knot *= 10;
  for (float& value : map.log_profile) value -= std::log(100.0f);
  map.pixel_pitch_mm *= 10;
  GatherSources sources = make_sphere_sources(6000, 80);
  const std::vector<GatherPoint> targets = make_sphere_points(500, 80, 0.37);
  const std::vector<Rgb> scaled = MomentTree(make_profile_field(map), sources)
                                      .gather(targets, default_near_mm(sources.area_mm2), params)
                                      .exitance;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    EXPECT_LT(relative_difference(rotated[i], plain[i]), 0.01);
    EXPECT_LT(relative_difference(scaled[i], plain[i]), 1e-3);
  }
}

TEST(MomentTree, DarkChannelsAndPlacesStayDark) {
  Setting setting = make_setting();
  for (Rgb& flux : setting.sources.flux) flux = {flux.x, 0, 0};
  const TreeGatherResult result =
      MomentTree(setting.field, setting.sources).gather(setting.targets, setting.near_mm);
  for (const Rgb& value : result.exitance) {
    EXPECT_GT(value.x, 0);
    EXPECT_EQ(value.y, 0);
    EXPECT_TRUE(is_finite(value));
  }
}

TEST(MomentTree, RefusesBracketsForProfilesThatRise) {
  ProfileMap map = make_checker();
  knot_plane(map, 0, 5)[17] += 9;
  const GatherSources sources = make_sphere_sources(200, 8);
  const MomentTree tree(make_profile_field(map), sources);
  TreeGatherParams params;
  EXPECT_EQ(tree.gather(sources.points, 1, params).certified, 0u);
  params.tolerance = 0.1;
  EXPECT_EQ(error_of([&] { tree.gather(sources.points, 1, params); }),
            "tolerance: expected profiles that fall everywhere, without which no bracket "
            "holds, found a map that was fitted with --no-monotone");
}

}  // namespace
}  // namespace parian

#include "transport/gather.h"

#include <gtest/gtest.h>

#include "base/parallel.h"
#include "transport/moment_tree.h"
#include "transport/test_surfaces.h"

namespace parian {
namespace {

// Jittered samples of a square plane of side 2 * half, lit evenly with irradiance 1, in the middle
// of a homogeneous sample.
GatherSources make_plane(double half, int per_side) {
  GatherSources plane;
  const double step = 2 * half / per_side;
  plane.area_mm2 = step * step;
  Rng rng = make_rng(3);
  for (int i = 0; i < per_side * per_side; ++i) {
    GatherPoint point;
    point.normal = {0, 1, 0};
    const int column = i % per_side;
    const int row = i / per_side;
    point.position = {static_cast<float>(-half + (column + sample_uniform(rng)) * step), 0,
                      static_cast<float>(-half + (row + sample_uniform(rng)) * step)};
    plane.points.push_back(point);
    plane.flux.push_back(Rgb{1, 1, 1} * static_cast<float>(plane.area_mm2));
  }
  return plane;
}

std::vector<GatherPoint> make_plane_targets(int count, float extent) {
  std::vector<GatherPoint> targets;
  Rng rng = make_rng(9);
  for (int i = 0; i < count; ++i) {
    GatherPoint target;
    target.normal = {0, 1, 0};
    target.position = {extent * static_cast<float>(2 * sample_uniform(rng) - 1), 0,
                       extent * static_cast<float>(2 * sample_uniform(rng) - 1)};
    targets.push_back(target);
  }
  return targets;
}

// Profiles e^{-slope r} times `scale`, with knots to `reach`.
ProfileMap make_exponential(double slope, double scale, double reach) {
  std::vector<double> knots;
  for (int k = 0; k <= 8; ++k) knots.push_back(reach * k / 8);
  ProfileMap map = make_profile_map(1, 1, 3, 1, knots);
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k <= 8; ++k)
      *knot_plane(map, c, k) =
          static_cast<float>(std::log(scale) - slope * knots[static_cast<std::size_t>(k)]);
  map.boundary = Boundary::included;
  return map;
}

TEST(GatherBrute, IsTheDefiningSum) {
  const ProfileField field = make_profile_field(make_checker());
  const GatherSources sources = make_sphere_sources(1500, 5);
  const std::vector<GatherPoint> targets = make_sphere_points(61, 5, 0.1);
  const std::vector<Rgb> exitance = gather_brute(field, sources, targets, 0);
  for (std::size_t i = 0; i < targets.size(); ++i)
    EXPECT_LT(relative_difference(exitance[i], gather_plainly(field, sources, targets[i])), 2e-5);
}

// A plane under even light gives back its diffuse albedo 2 pi C.
TEST(GatherBrute, PlaneFurnace) {
  for (double slope : {0.5, 2.0, 8.0}) {  // from many to few samples within the range
    const ProfileMap map = make_exponential(slope, 0.05 * slope * slope, 6 / slope);
    const double albedo = diffuse_albedo(get_profile(map, 0, 0, 0));
    const GatherSources plane = make_plane(24, 96);  // a spacing of 0.5 mm
    const std::vector<GatherPoint> targets = make_plane_targets(64, 4);
    const std::vector<Rgb> exitance =
        gather_brute(make_profile_field(map), plane, targets, default_near_mm(plane.area_mm2));
    double mean = 0;
    for (const Rgb& value : exitance) {
      EXPECT_NEAR(static_cast<double>(value.y) / albedo, 1, 0.1) << slope;
      mean += static_cast<double>(value.y) / 64;
    }
    EXPECT_NEAR(mean / albedo, 1, 0.01) << slope;
  }
}

// A profile far narrower than the spacing: Lambertian, no matter where the samples lie.
TEST(GatherBrute, ZeroRadiusIsLambertian) {
  const ProfileMap map = make_exponential(1e4, 1e7, 1e-3);
  const double albedo = diffuse_albedo(get_profile(map, 0, 0, 0));
  const GatherSources plane = make_plane(10, 20);
  for (const Rgb& value : gather_brute(make_profile_field(map), plane, make_plane_targets(50, 8),
                                       default_near_mm(plane.area_mm2)))
    EXPECT_NEAR(static_cast<double>(value.x) / albedo, 1, 1e-3);
}

// Behind a thin sheet the other side's light arrives by the plain sum.
TEST(GatherBrute, NearTermLeavesTheOtherSideAlone) {
  const ProfileField field = make_profile_field(make_exponential(1, 1, 6));
  GatherSources plane = make_plane(12, 48);
  for (GatherPoint& point : plane.points) {
    point.position.y = -0.2f;
    point.normal = {0, -1, 0};
  }
  const std::vector<GatherPoint> targets = make_plane_targets(20, 2);
  const std::vector<Rgb> with =
      gather_brute(field, plane, targets, default_near_mm(plane.area_mm2));
  const std::vector<Rgb> without = gather_brute(field, plane, targets, 0);
  for (std::size_t i = 0; i < targets.size(); ++i)
    EXPECT_LT(relative_difference(with[i], without[i]), 1e-5);
}

// <f, R g> = <R f, g> over the samples.
TEST(GatherBrute, IsReciprocal) {
  const ProfileField field = make_profile_field(make_checker());
  GatherSources g = make_sphere_sources(800, 3);
  GatherSources f = g;
  Rng rng = make_rng(2);
  for (Rgb& flux : f.flux) flux = Rgb{1, 1, 1} * static_cast<float>(sample_uniform(rng));
  const std::vector<Rgb> Rg = gather_brute(field, g, g.points, 0);
  const std::vector<Rgb> Rf = gather_brute(field, f, f.points, 0);
  double left = 0, right = 0;
  for (std::size_t i = 0; i < g.points.size(); ++i) {
    left += static_cast<double>(f.flux[i].x) * static_cast<double>(Rg[i].x);
    right += static_cast<double>(Rf[i].x) * static_cast<double>(g.flux[i].x);
  }
  EXPECT_NEAR(left / right, 1, 1e-6);
}

TEST(GatherBrute, IsLinearInLight) {
  const ProfileField field = make_profile_field(make_checker());
  const GatherSources a = make_sphere_sources(600, 4);
  GatherSources b = a, both = a;
  for (std::size_t i = 0; i < a.flux.size(); ++i) {
    b.flux[i] = {0.1f, i % 7 == 0 ? 2.0f : 0.0f, 1};
    both.flux[i] = a.flux[i] * 2 + b.flux[i];
  }
  const std::vector<GatherPoint> targets = make_sphere_points(40, 4, 1);
  const double near = default_near_mm(a.area_mm2);
  const std::vector<Rgb> Ma = gather_brute(field, a, targets, near);
  const std::vector<Rgb> Mb = gather_brute(field, b, targets, near);
  const std::vector<Rgb> M = gather_brute(field, both, targets, near);
  for (std::size_t i = 0; i < targets.size(); ++i)
    EXPECT_LT(relative_difference(M[i], Ma[i] * 2 + Mb[i]), 1e-5);
}

// Profiles that are equal everywhere make a homogeneous material.
TEST(GatherBrute, EqualProfilesAreHomogeneous) {
  const ProfileMap one = make_exponential(1, 1, 4);
  ProfileMap many = make_profile_map(16, 16, 3, 1, one.knots_mm);
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 9; ++k) std::fill_n(knot_plane(many, c, k), 256, *knot_plane(one, c, k));
  const GatherSources sources = make_sphere_sources(900, 4);
  const std::vector<GatherPoint> targets = make_sphere_points(50, 4, 1);
  const std::vector<Rgb> a = gather_brute(make_profile_field(one), sources, targets, 1);
  const std::vector<Rgb> b = gather_brute(make_profile_field(many), sources, targets, 1);
  const std::vector<Rgb> tree_a =
      MomentTree(make_profile_field(one), sources).gather(targets, 1).exitance;
  const std::vector<Rgb> tree_b =
      MomentTree(make_profile_field(many), sources).gather(targets, 1).exitance;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    EXPECT_LT(relative_difference(a[i], b[i]), 2e-5);
    EXPECT_LT(relative_difference(tree_a[i], tree_b[i]), 2e-5);
  }
}

TEST(GatherBrute, SameBitsForAnyNumberOfThreads) {
  const ProfileField field = make_profile_field(make_checker());
  const GatherSources sources = make_sphere_sources(700, 4);
  const std::vector<GatherPoint> targets = make_sphere_points(333, 4, 1);
  std::vector<Rgb> results[2], tree[2];
  for (int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    const auto i = static_cast<std::size_t>(threads - 1);
    results[i] = gather_brute(field, sources, targets, 1);
    tree[i] = MomentTree(field, sources).gather(targets, 1).exitance;
  }
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(tree[0], tree[1]);
}

TEST(GatherBrute, NothingFromNoSources) {
  const ProfileField field = make_profile_field(make_checker());
  const std::vector<GatherPoint> targets = make_sphere_points(3, 4);
  EXPECT_EQ(gather_brute(field, {}, targets, 1), std::vector<Rgb>(3));
  EXPECT_TRUE(gather_brute(field, make_sphere_sources(10, 1), {}, 1).empty());
}

}  // namespace
}  // namespace parian

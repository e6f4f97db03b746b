#include "mesh/surface_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

double nearest_distance(const SurfaceSamples& samples, float least_cosine) {
  double nearest = 1e30;
  for (std::size_t i = 0; i < samples.points.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const SurfacePoint& a = samples.points[i];
      const SurfacePoint& b = samples.points[j];
      if (dot(a.geometric_normal, b.geometric_normal) > least_cosine)
        nearest = std::min<double>(nearest, distance(a.position, b.position));
    }
  return nearest;
}

Vec3 random_axis(std::uint64_t i) {
  const double z = 2 * hash_to_uniform(hash_u64(i, 11)) - 1;
  const double phi = 2 * pi * hash_to_uniform(hash_u64(i, 12));
  const double r = std::sqrt(1 - z * z);
  return {static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
          static_cast<float>(z)};
}

// Variance of the number of points in caps of a sphere, over that of as many random points.
double relative_variance(const SurfaceSamples& samples, double cap) {
  constexpr int caps = 400;
  const double expected = static_cast<double>(samples.points.size()) * cap;
  double sum = 0;
  for (int i = 0; i < caps; ++i) {
    const Vec3 axis = random_axis(static_cast<std::uint64_t>(i));
    const auto inside =
        std::count_if(samples.points.begin(), samples.points.end(), [&](const SurfacePoint& point) {
          return dot(normalize(point.position), axis) > static_cast<float>(1 - 2 * cap);
        });
    sum += (static_cast<double>(inside) - expected) * (static_cast<double>(inside) - expected);
  }
  return sum / caps / (expected * (1 - cap));
}

TEST(SurfaceSamples, AreAsManyAsAskedForAndOnTheSurface) {
  const TriangleMesh knot = make_knot();
  const TriangleMesh box = make_box({1, 2, 3});
  for (const TriangleMesh* mesh : {&knot, &box}) {
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{3000}}) {
      const SurfaceSamples samples = make_surface_samples(*mesh, count);
      ASSERT_EQ(samples.points.size(), count);
      EXPECT_NEAR(samples.area_mm2 * static_cast<double>(count), surface_area(*mesh), 1e-5);
      EXPECT_DOUBLE_EQ(samples.spacing_mm(), std::sqrt(samples.area_mm2));
      for (const SurfacePoint& point : samples.points) {
        const Vec3 corner = mesh->positions[mesh->triangles[point.triangle][0]];
        EXPECT_NEAR(dot(point.position - corner, point.geometric_normal), 0, 1e-5);
      }
    }
  }
}

// The best possible spacing of N points is that of a triangular lattice, 1.07 sqrt(A / N).
TEST(SurfaceSamples, KeepTheirDistance) {
  const SurfaceSamples on_sphere = make_surface_samples(make_sphere(4), 4000);
  EXPECT_GT(nearest_distance(on_sphere, -2), 0.55 * on_sphere.spacing_mm());
  const SurfaceSamples on_fin = make_surface_samples(make_fin(), 4000);
  EXPECT_GT(nearest_distance(on_fin, 0), 0.5 * on_fin.spacing_mm());
}

// Points on the two sides of a sheet much thinner than their spacing know nothing of each other.
TEST(SurfaceSamples, SidesOfAThinSheetAreFilledAlike) {
  const TriangleMesh sheet = make_box({1, 1, 0.001f});
  const SurfaceSamples samples = make_surface_samples(sheet, 4000);
  SurfaceSamples front;
  front.area_mm2 = samples.area_mm2;
  for (const SurfacePoint& point : samples.points)
    if (point.geometric_normal.z > 0.5f) front.points.push_back(point);
  EXPECT_NEAR(static_cast<double>(front.points.size()), 2000, 40);
  EXPECT_GT(nearest_distance(front, 0), 0.6 * samples.spacing_mm());
  EXPECT_LT(nearest_distance(samples, -2), 0.2 * samples.spacing_mm());
}

TEST(SurfaceSamples, NumbersFollowTheAreaBetterThanChance) {
  const SurfaceSamples samples = make_surface_samples(make_sphere(5), 6000);
  EXPECT_LT(relative_variance(samples, 0.1), 0.08);
  EXPECT_LT(relative_variance(samples, 0.02), 0.15);
}

TEST(SurfaceSamples, DoNotSeeTheTessellation) {
  // The same sphere with triangles of one size, and with one hemisphere 64 times finer.
  TriangleMesh mixed = make_sphere(3);
  const TriangleMesh fine = make_sphere(6);
  const auto is_upper = [](const TriangleMesh& mesh, const auto& t) {
    return mesh.positions[t[0]].z + mesh.positions[t[1]].z + mesh.positions[t[2]].z > 0;
  };
  std::erase_if(mixed.triangles, [&](const auto& t) { return is_upper(mixed, t); });
  const auto first = static_cast<std::uint32_t>(mixed.positions.size());
  mixed.positions.insert(mixed.positions.end(), fine.positions.begin(), fine.positions.end());
  mixed.normals.insert(mixed.normals.end(), fine.normals.begin(), fine.normals.end());
  mixed.texcoords.insert(mixed.texcoords.end(), fine.texcoords.begin(), fine.texcoords.end());
  for (const auto& t : fine.triangles)
    if (is_upper(fine, t)) mixed.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  for (const TriangleMesh& mesh : {make_sphere(3), make_sphere(6), mixed}) {
    const SurfaceSamples samples = make_surface_samples(mesh, 4000);
    EXPECT_LT(relative_variance(samples, 0.1), 0.13);
    EXPECT_GT(nearest_distance(samples, -2), 0.55 * samples.spacing_mm());
    Vec3 mean;
    for (const SurfacePoint& point : samples.points) mean += point.position * (1 / 4000.0f);
    EXPECT_LT(length(mean), 0.01f);
  }
}

TEST(SurfaceSamples, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh knot = make_knot();
  const auto make = [&](int threads, std::uint64_t seed) {
    const ThreadLimit limit(threads);
    return make_surface_samples(knot, 5000, seed);
  };
  const SurfaceSamples one = make(1, 1);
  const SurfaceSamples two = make(2, 1);
  const SurfaceSamples other = make(2, 2);
  const auto same = [](const SurfaceSamples& a, const SurfaceSamples& b) {
    return std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(),
                      [](const SurfacePoint& p, const SurfacePoint& q) {
                        return p.position == q.position && p.triangle == q.triangle;
                      });
  };
  EXPECT_TRUE(same(one, two));
  EXPECT_FALSE(same(one, other));
}

TEST(SurfaceSamples, CanBeCancelled) {
  Progress progress;
  progress.is_cancelled = [] { return true; };
  EXPECT_THROW(make_surface_samples(make_sphere(1), 100, 1, progress), Error);
}

}  // namespace
}  // namespace parian

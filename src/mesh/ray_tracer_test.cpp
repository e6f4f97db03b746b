#include "mesh/ray_tracer.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

Vec3 direction_of(std::uint64_t i) {
  const double z = 2 * hash_to_uniform(hash_u64(i, 1)) - 1;
  const double phi = 6.283185307179586 * hash_to_uniform(hash_u64(i, 2));
  const double r = std::sqrt(1 - z * z);
  return {static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
          static_cast<float>(z)};
}

TEST(RayTracer, HitsABoxWhereItIs) {
  const TriangleMesh box = make_box({2, 2, 2}, 3);
  const RayTracer tracer(box);
  const auto hit = tracer.intersect({{0.3f, -0.4f, 5}, {0, 0, -1}});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 4, 1e-6);
  EXPECT_FALSE(hit->from_inside);
  const SurfacePoint point = get_surface_point(box, hit->triangle, hit->barycentric);
  EXPECT_LT(distance(point.position, {0.3f, -0.4f, 1}), 1e-6f);
  EXPECT_EQ(point.geometric_normal, (Vec3{0, 0, 1}));
  const auto inside = tracer.intersect({{0, 0, 0}, {1, 0, 0}});
  ASSERT_TRUE(inside);
  EXPECT_NEAR(inside->t, 1, 1e-6);
  EXPECT_TRUE(inside->from_inside);
}

TEST(RayTracer, KeepsToItsInterval) {
  const RayTracer tracer(make_box({2, 2, 2}));
  EXPECT_FALSE(tracer.intersect({{0, 0, 5}, {0, 0, 1}}));
  EXPECT_FALSE(tracer.intersect({{0, 0, 5}, {0, 0, -1}, 0, 3.9f}));
  EXPECT_NEAR(tracer.intersect({{0, 0, 5}, {0, 0, -1}, 4.1f})->t, 6, 1e-6);
  EXPECT_TRUE(tracer.is_occluded({{0, 0, 5}, {0, 0, -1}}));
  EXPECT_FALSE(tracer.is_occluded({{0, 0, 5}, {0, 0, -1}, 0, 3.9f}));
  EXPECT_FALSE(tracer.is_occluded({{0, 0, 5}, {0, 0, -1}, 6.1f}));
}

bool escapes(const RayTracer& tracer, const Ray& ray) {
  return !tracer.intersect(ray) || !tracer.is_occluded(ray);
}

// No ray from inside a closed mesh slips out between two triangles. Embree's robust test is exact
// at edges; of rays within rounding of a vertex a few in a thousand miss all triangles around it.
TEST(RayTracer, ClosedMeshesAreTight) {
  const Vec3 origin{0.013f, 0.021f, -0.017f};
  for (const TriangleMesh& mesh : {make_sphere(4), make_box({1, 1, 1}, 5)}) {
    const RayTracer tracer(mesh);
    std::atomic<int> escaped{0};
    parallel_for(50000, [&](std::size_t i) {
      if (escapes(tracer, {origin, direction_of(i)})) ++escaped;
    });
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 middle = (mesh.positions[a] + mesh.positions[b]) * 0.5f;
      if (escapes(tracer, {origin, normalize(middle - origin)})) ++escaped;
    }
    EXPECT_EQ(escaped, 0);
    std::size_t at_vertices = 0;
    for (const Vec3& p : mesh.positions)
      if (escapes(tracer, {origin, normalize(p - origin)})) ++at_vertices;
    EXPECT_LT(at_vertices, mesh.positions.size() / 100);
  }
}

TEST(RayTracer, EpsilonLeavesTheSurfaceBehind) {
  TriangleMesh mesh = make_sphere(4);
  for (Vec3& p : mesh.positions) p = p * 40 + Vec3{300, 0, -100};
  const RayTracer tracer(mesh);
  EXPECT_LT(tracer.epsilon_mm(), 0.01f);
  int occluded = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const SurfacePoint point = get_surface_point(mesh, t, {0.2f, 0.5f});
    const Vec3 origin = point.position + point.geometric_normal * tracer.epsilon_mm();
    if (tracer.is_occluded({origin, point.geometric_normal})) ++occluded;
  }
  EXPECT_EQ(occluded, 0);
}

TEST(RayTracer, SameHitsForAnyNumberOfThreads) {
  const TriangleMesh mesh = make_knot();
  const auto trace = [&](int threads) {
    const ThreadLimit limit(threads);
    const RayTracer tracer(mesh);
    std::vector<std::pair<std::uint32_t, float>> hits(4000);
    parallel_for(hits.size(), [&](std::size_t i) {
      // At vertices, where six triangles meet.
      const Vec3 target = mesh.positions[i * 5];
      const Vec3 origin = target + direction_of(i);
      const auto hit = tracer.intersect({origin, normalize(target - origin)});
      if (hit) hits[i] = {hit->triangle, hit->t};
    });
    return hits;
  };
  EXPECT_EQ(trace(1), trace(2));
}

TEST(RayTracer, NothingIsHitWithoutTriangles) {
  RayTracer tracer{TriangleMesh{}};
  EXPECT_FALSE(tracer.intersect({{0, 0, 0}, {0, 0, 1}}));
  tracer = RayTracer(make_box({1, 1, 1}));
  EXPECT_TRUE(tracer.intersect({{0, 0, 0}, {0, 0, 1}}));
}

}  // namespace
}  // namespace parian

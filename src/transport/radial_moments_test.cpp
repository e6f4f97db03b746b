#include "transport/radial_moments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "base/parallel.h"
#include "material/dipole.h"
#include "transport/curve_basis.h"
#include "transport/test_surfaces.h"

namespace parian {
namespace {

SplineBasis make_basis(int degree, double reach) {
  SplineBasis basis{.degree = degree, .knots = {0}};
  for (double r = 0.02 * reach; r < 0.9 * reach; r *= 1.5) basis.knots.push_back(r);
  basis.knots.push_back(reach);
  return basis;
}

double at(const RadialMoments& moments, const SplineBasis& basis, std::size_t target, std::size_t j,
          std::size_t c) {
  return static_cast<double>(moments.value[(target * basis.size() + j) * 3 + c]);
}

// A square of size x size mm in the xz plane, facing +y.
GatherSources make_plane_sources(double size, int side, Rgb irradiance) {
  GatherSources sources;
  const double step = size / side;
  sources.area_mm2 = step * step;
  Rng rng = make_rng(4);
  for (int i = 0; i < side; ++i)
    for (int k = 0; k < side; ++k) {
      GatherPoint point;  // jittered, as blue noise has no lattice either
      point.position = {static_cast<float>((i + sample_uniform(rng)) * step - size / 2), 0,
                        static_cast<float>((k + sample_uniform(rng)) * step - size / 2)};
      point.normal = {0, 1, 0};
      sources.points.push_back(point);
      sources.flux.push_back(irradiance * static_cast<float>(sources.area_mm2));
    }
  return sources;
}

TEST(RadialMoments, SumToTheFluxWithinReach) {
  const GatherSources sources = make_sphere_sources(3000, 5);
  const std::vector<GatherPoint> targets = make_sphere_points(20, 5, 0.3);
  double flux[3] = {};
  for (const Rgb& value : sources.flux) {
    flux[0] += static_cast<double>(value.x);
    flux[1] += static_cast<double>(value.y);
    flux[2] += static_cast<double>(value.z);
  }
  for (const int degree : {1, 2}) {
    const SplineBasis basis = make_basis(degree, 10.1);  // all of the sphere is within
    const RadialMoments moments = compute_radial_moments(basis, sources, targets, 0);
    for (std::size_t i = 0; i < targets.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        double sum = 0;
        for (std::size_t j = 0; j < basis.size(); ++j) sum += at(moments, basis, i, j, c);
        EXPECT_NEAR(sum / flux[c], 1, 1e-5);
      }
  }
}

// Without a hierarchy and a near term: the definition.
TEST(RadialMoments, OpeningNothingIsTheSum) {
  const GatherSources sources = make_sphere_sources(500, 3);
  const std::vector<GatherPoint> targets = make_sphere_points(7, 3, 0.1);
  for (const int degree : {1, 2}) {
    const SplineBasis basis = make_basis(degree, 4);  // not all of it
    const RadialMoments moments =
        compute_radial_moments(basis, sources, targets, 0, {.opening = 0});
    EXPECT_LE(moments.nodes_per_target, 500);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      std::vector<double> expected(basis.size(), 0);
      for (std::size_t s = 0; s < sources.points.size(); ++s) {
        const Vec3 d = sources.points[s].position - targets[i].position;
        const double r = std::sqrt(static_cast<double>(dot(d, d)));
        if (r > 4) continue;
        const SplineValues values = eval_basis(basis, r);
        for (std::size_t b = 0; b <= static_cast<std::size_t>(degree); ++b)
          expected[values.first + b] += values.value[b] * static_cast<double>(sources.flux[s].y);
      }
      const double total = std::accumulate(expected.begin(), expected.end(), 0.0);
      for (std::size_t j = 0; j < basis.size(); ++j)
        EXPECT_NEAR(at(moments, basis, i, j, 1), expected[j], 1e-5 * total);
    }
  }
}

TEST(RadialMoments, HierarchyStaysWithinItsCertifiedBound) {
  const GatherSources sources = make_sphere_sources(8000, 20);
  const std::vector<GatherPoint> targets = make_sphere_points(60, 20, 0.3);
  const double near = default_near_mm(sources.area_mm2);
  for (const int degree : {1, 2}) {
    const SplineBasis basis = make_reflectance_basis(30, 1.3, {16, degree, KnotChoice::balanced});
    const RadialMoments exact =
        compute_radial_moments(basis, sources, targets, near, {.opening = 0, .certify = true});
    EXPECT_EQ(*std::max_element(exact.bound.begin(), exact.bound.end()), 0.0f);
    float last = 0;
    for (const double opening : {0.25, 0.5, 1.0}) {
      const RadialMoments moments = compute_radial_moments(basis, sources, targets, near,
                                                           {.opening = opening, .certify = true});
      float largest = 0;
      for (std::size_t i = 0; i < moments.value.size(); ++i) {
        EXPECT_LE(std::abs(moments.value[i] - exact.value[i]),
                  1.00001f * moments.bound[i] + 1e-5f * exact.value[i])
            << i;
        largest = std::max(largest, moments.bound[i]);
      }
      EXPECT_GT(largest, last);
      last = largest;
    }
  }
}

TEST(RadialMoments, HierarchyKeepsExitance) {
  const GatherSources sources = make_sphere_sources(20000, 20);
  const std::vector<GatherPoint> targets = make_sphere_points(60, 20, 0.3);
  const SplineBasis basis = make_reflectance_basis(41, 1.3);
  const SplineProjection projection = make_reflectance_projection(basis, KnotChoice::balanced);
  const double near = default_near_mm(sources.area_mm2);
  const RadialMoments exact = compute_radial_moments(basis, sources, targets, near, {.opening = 0});
  double last = 1;
  for (const double opening : {1.0, 0.5, 0.25}) {
    const RadialMoments moments =
        compute_radial_moments(basis, sources, targets, near, {.opening = opening});
    EXPECT_LT(moments.nodes_per_target, exact.nodes_per_target);
    double worst = 0;
    for (const double sigma_s : {0.2, 1.0, 3.0, 10.0})
      for (const double ratio : {0.002, 0.05}) {
        const auto c = projection.fit([&](double r) {
          return eval_dipole({ratio * sigma_s, sigma_s}, 1.3, r);
        });
        for (std::size_t i = 0; i < targets.size(); ++i)
          for (std::size_t channel = 0; channel < 3; ++channel) {
            double sum = 0, expected = 0;
            for (std::size_t j = 0; j < basis.size(); ++j) {
              sum += c[j] * at(moments, basis, i, j, channel);
              expected += c[j] * at(exact, basis, i, j, channel);
            }
            worst = std::max(worst, std::abs(sum / expected - 1));
          }
      }
    EXPECT_LT(worst, opening == 1 ? 0.05 : 0.005) << opening;
    EXPECT_LT(worst, last);
    last = worst;
  }
}

// T_j = 2 pi I int B_j r dr, also of functions much narrower than the spacing.
TEST(RadialMoments, PlaneHasClosedForm) {
  const Rgb irradiance{2, 0.5f, 1};
  const GatherSources sources = make_plane_sources(40, 200, irradiance);  // spacing 0.2 mm
  std::vector<GatherPoint> targets;
  Rng rng = make_rng(9);
  for (int i = 0; i < 10; ++i) {
    GatherPoint target;
    target.position = {static_cast<float>(sample_uniform(rng) - 0.5), 0,
                       static_cast<float>(sample_uniform(rng) - 0.5)};
    target.normal = {0, 1, 0};
    targets.push_back(target);
  }
  for (const int degree : {1, 2}) {
    const SplineBasis basis{.degree = degree,
                            .knots = {0, 0.01, 0.03, 0.1, 0.2, 0.4, 0.8, 1.6, 3, 6, 12}};
    const RadialMoments moments =
        compute_radial_moments(basis, sources, targets, default_near_mm(sources.area_mm2));
    const std::vector<double> integrals =
        integrate_basis(basis, [](double r) { return 2 * M_PI * r; });
    for (std::size_t i = 0; i < targets.size(); ++i)
      for (std::size_t j = 0; j < basis.size(); ++j) {
        // Jittered points are less even than blue noise.
        EXPECT_NEAR(at(moments, basis, i, j, 0) / (2 * integrals[j]), 1, 0.1) << j;
        EXPECT_NEAR(at(moments, basis, i, j, 1), at(moments, basis, i, j, 0) / 4,
                    1e-4 * at(moments, basis, i, j, 0));
      }
  }
}

TEST(RadialMoments, AreLinearInFlux) {
  GatherSources a = make_sphere_sources(2000, 4), b = a, both = a;
  Rng rng = make_rng(2);
  for (std::size_t i = 0; i < a.flux.size(); ++i) {
    b.flux[i] = Rgb{1, 1, 1} * static_cast<float>(sample_uniform(rng));
    both.flux[i] = a.flux[i] + b.flux[i] * 0.5f;
  }
  const std::vector<GatherPoint> targets = make_sphere_points(9, 4, 0.2);
  const SplineBasis basis = make_basis(1, 8.1);
  const RadialMoments of_a = compute_radial_moments(basis, a, targets, 0.5, {.opening = 0}),
                      of_b = compute_radial_moments(basis, b, targets, 0.5, {.opening = 0}),
                      of_both = compute_radial_moments(basis, both, targets, 0.5, {.opening = 0});
  for (std::size_t i = 0; i < of_a.value.size(); ++i)
    EXPECT_NEAR(of_both.value[i], of_a.value[i] + 0.5f * of_b.value[i],
                1e-4f * (of_a.value[i] + of_b.value[i]) + 1e-6f);
}

TEST(RadialMoments, ThreadsGiveTheSameBits) {
  const GatherSources sources = make_sphere_sources(3000, 5);
  const std::vector<GatherPoint> targets = make_sphere_points(1500, 5, 0.3);
  const SplineBasis basis = make_basis(1, 10);
  const RadialMoments all = compute_radial_moments(basis, sources, targets, 0.6);
  const ThreadLimit limit(1);
  EXPECT_EQ(all.value, compute_radial_moments(basis, sources, targets, 0.6).value);
}

TEST(RadialMoments, NothingAndOnePointAreFine) {
  const SplineBasis basis = make_basis(1, 10);
  GatherSources one = make_sphere_sources(1, 5);
  EXPECT_TRUE(compute_radial_moments(basis, one, {}, 0.6).value.empty());
  const std::vector<GatherPoint> same(3, one.points[0]);  // at the sample itself
  for (const float value : compute_radial_moments(basis, one, same, 0.6).value)
    EXPECT_TRUE(std::isfinite(value));
  one.points.assign(40, one.points[0]);
  one.flux.assign(40, Rgb{0, 1, 0});
  for (const float value : compute_radial_moments(basis, one, same, 0.6).value)
    EXPECT_TRUE(std::isfinite(value));
  for (const float value : compute_radial_moments(basis, {}, same, 0.6).value) EXPECT_EQ(value, 0);
}

TEST(RadialMoments, CanBeCancelled) {
  const Progress cancelled{.report = {}, .is_cancelled = [] { return true; }};
  EXPECT_THROW(compute_radial_moments(make_basis(1, 10), make_sphere_sources(10, 5),
                                      make_sphere_points(3, 5), 0, {}, cancelled),
               Error);
}

}  // namespace
}  // namespace parian

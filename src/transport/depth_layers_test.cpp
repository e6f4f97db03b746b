#include "transport/depth_layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/random.h"
#include "mesh/ray_tracer.h"
#include "mesh/shapes.h"
#include "transport/curve_basis.h"
#include "transport/irradiance.h"
#include "transport/single_scattering_kernels.h"

namespace parian {
namespace {

Vec3 draw_direction(Rng& rng) {
  const auto part = [&] { return static_cast<float>(sample_normal(rng)); };
  const float x = part(), y = part();
  return normalize({x, y, part()});
}

TEST(RefractEntry, ObeysSnellAndStaysUnit) {
  Rng rng = make_rng(3);
  for (int i = 0; i < 200; ++i) {
    const Vec3 normal = draw_direction(rng), light = draw_direction(rng);
    const float eta = 1 + 0.8f * static_cast<float>(sample_uniform(rng));
    const Refraction r = refract_entry(normal, light, eta);
    const float cosine = dot(normal, light);
    if (cosine <= 0) {
      EXPECT_EQ(r.transmission, 0.0f);
      continue;
    }
    EXPECT_NEAR(length(r.direction), 1, 2e-6f);
    const Vec3 outside = cross(normal, light), inside = cross(normal, r.direction) * eta;
    EXPECT_NEAR(distance(outside, inside), 0, 2e-6f);
    EXPECT_NEAR(r.length_ratio, cosine / dot(normal, r.direction), 1e-5f);
    EXPECT_EQ(r.transmission, fresnel_transmission(eta, cosine));
  }
  const Refraction straight = refract_entry({0, 1, 0}, {0.6f, 0.8f, 0}, 1);
  EXPECT_NEAR(distance(straight.direction, {0.6f, 0.8f, 0}), 0, 1e-6f);
  EXPECT_NEAR(straight.length_ratio, 1, 1e-6f);
}

// Rays through the texels' centres find the same layers.
TEST(DepthLayers, AreWhatRaysMeet) {
  TriangleMesh mesh = make_knot();
  fit_to_size(mesh, 20);
  const RayTracer tracer(mesh);
  Rng rng = make_rng(5);
  int entries = 0, wrong = 0;
  for (int k = 0; k < 3; ++k) {
    const Vec3 light = draw_direction(rng);
    const DepthLayers layers = make_depth_layers(mesh, light, 64, 1.3f);
    EXPECT_EQ(std::max(layers.width, layers.height), 64);
    for (int row = 0; row < layers.height; ++row)
      for (int column = 0; column < layers.width; ++column) {
        const float x = static_cast<float>(column) + 0.5f - layers.offset.x,
                    y = static_cast<float>(row) + 0.5f - layers.offset.y;
        const float square = layers.texel_mm * layers.texel_mm;
        const Vec3 start = (layers.axis_x * x + layers.axis_y * y) * square + light * 100.0f;
        const DepthTexel& texel =
            layers.texels[static_cast<std::size_t>(row * layers.width + column)];
        const auto depth_at = [&](float t) {
          return dot(layers.axis_z, start - light * t) + layers.offset.z;
        };
        const auto hit = tracer.intersect({.origin = start, .direction = -light});
        if (!hit) continue;
        ++entries;
        wrong += std::abs(texel.entry - depth_at(hit->t)) > 1e-3f;
        const auto back =
            tracer.intersect({.origin = start, .direction = -light, .t_min = hit->t + 1e-3f});
        wrong += !back || std::abs(texel.exit - depth_at(back->t)) > 1e-3f;
      }
  }
  EXPECT_GT(entries, 1000);
  EXPECT_LT(wrong, entries / 100);  // along outlines
}

TEST(DepthLayers, BoxIsExact) {
  const TriangleMesh mesh = make_box({8, 2, 4});
  const DepthLayers layers = make_depth_layers(mesh, {0, 1, 0}, 34, 1.4f);
  EXPECT_EQ(std::max(layers.width, layers.height), 34);
  EXPECT_FLOAT_EQ(layers.texel_mm, 0.25f);
  int covered = 0;
  // Inside, and one more along each side.
  const int expected = 32 * 16 + 2 * (32 + 16);
  for (const DepthTexel& texel : layers.texels) {
    if (!(texel.exit > 0)) continue;
    ++covered;
    EXPECT_NEAR(texel.entry, 0, 1e-6f);
    EXPECT_NEAR(texel.exit, 2, 1e-6f);
    EXPECT_NEAR(texel.length_ratio, 1, 1e-6f);
    EXPECT_NEAR(texel.flux[1], fresnel_transmission(1.4f, 1), 1e-6f);
  }
  EXPECT_EQ(covered, expected);
}

// A back face first, as seen through a hole: nothing enters there.
TEST(DepthLayers, BacksAreNoEntries) {
  const TriangleMesh mesh = make_plane(4);
  for (const DepthTexel& texel : make_depth_layers(mesh, {0, -1, 0}, 16, 1.3f).texels)
    EXPECT_LT(texel.exit, 0);
  int open = 0;
  for (const DepthTexel& texel : make_depth_layers(mesh, {0, 1, 0}, 16, 1.3f).texels)
    open += texel.exit == std::numeric_limits<float>::infinity();
  EXPECT_EQ(open, 14 * 14 + 4 * 14);
}

TEST(DepthLayers, EdgeOnMeshesHaveAMap) {
  const DepthLayers layers = make_depth_layers(make_plane(4), {1, 0, 0}, 16, 1.3f);
  EXPECT_GE(layers.width, 1);
  EXPECT_GE(layers.height, 1);
  EXPECT_EQ(layers.texels.size(), static_cast<std::size_t>(layers.width * layers.height));
}

TEST(DepositPath, IsTheBasis) {
  Rng rng = make_rng(11);
  for (const int degree : {1, 2})
    for (const int intervals : {1, 2, 16}) {
      const SplineBasis basis =
          make_attenuation_basis(40, {.intervals = intervals, .degree = degree});
      const BasisTable table = make_basis_table(basis);
      const float colour[3] = {1, 2, 4};
      for (int k = 0; k < 300; ++k) {
        // Also on knots, at 0 and beyond the last.
        const double u = sample_uniform(rng);
        double x = 50 * u * u * u;
        if (k < 17)
          x = basis.knots[std::min<std::size_t>(static_cast<std::size_t>(k), basis.intervals())];
        LitPath lit;
        lit.count = 1;
        lit.length[0] = static_cast<float>(x);
        for (int c = 0; c < 4; ++c) lit.source[0][c] = static_cast<float>(1 + c);
        std::vector<float> sums(4 * basis.size()), value(12 * basis.size());
        deposit_path(view_of(table), lit, colour, sums.data(), value.data());
        std::vector<double> expected(basis.size());
        const SplineValues exact = eval_basis(basis, x);
        for (std::size_t i = 0; i <= static_cast<std::size_t>(degree); ++i)
          expected[exact.first + i] = exact.value[i];
        for (std::size_t j = 0; j < basis.size(); ++j)
          for (std::size_t c = 0; c < 12; ++c) {
            const std::size_t row = 1 + c / 3;
            EXPECT_NEAR(static_cast<double>(value[12 * j + c]),
                        expected[j] * static_cast<double>(row) * static_cast<double>(colour[c % 3]),
                        2e-4)
                << degree << ' ' << intervals << ' ' << x;
          }
        for (const float sum : sums) ASSERT_EQ(sum, 0.0f);
      }
    }
}

}  // namespace
}  // namespace parian

#include "transport/homogeneous_transport.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"
#include "transport/half.h"
#include "transport/irradiance.h"
#include "transport/transport_kernels_variants.h"

namespace parian {
namespace {

std::vector<float> make_values(std::size_t count, double low, double high, std::uint64_t seed) {
  Rng rng = make_rng(seed);
  std::vector<float> values(count);
  for (float& value : values) value = static_cast<float>(low + (high - low) * sample_uniform(rng));
  return values;
}

// Two lights on places around a ball; values are made up.
struct Fixture {
  static constexpr std::size_t places = 1037;
  HomogeneousTransport transport;
  std::vector<float> multiple[2], single[2];
  std::vector<Vec3> positions, normals;
  TransportView view;
  Dipole material;

  Fixture() {
    transport.places = places;
    transport.multiple_basis = make_reflectance_basis(20, 1.3, {.intervals = 8});
    transport.single_basis = make_attenuation_basis(20, {.intervals = 6});
    for (std::size_t i = 0; i < 2; ++i) {
      multiple[i] = make_values(places * 9 * 3, 0, 3000, 10 + i);
      single[i] = make_values(places * 7 * 12, -20, 40, 20 + i);
      transport.lights.push_back({.name = i == 0 ? "a" : "b",
                                  .multiple = pack_transport(multiple[i], 9, 3),
                                  .single = pack_transport(single[i], 7, 12)});
    }
    const std::vector<float> at = make_values(3 * places, -1, 1, 3);
    for (std::size_t i = 0; i < places; ++i) {
      normals.push_back(normalize(Vec3{at[3 * i], at[3 * i + 1], at[3 * i + 2] + 0.01f}));
      positions.push_back(normals.back() * 10);
    }
    view = make_transport_view(positions, normals, {0, 0, 100}, 1.3);
    material.channels = {{0.01, 1}, {0.02, 2}, {0.05, 0.5}};
    material.single_scattering = true;
    for (std::size_t c = 0; c < 3; ++c) material.channels[c].g = 0.2 - 0.4 * static_cast<double>(c);
  }

  // Eq. 9 and 14 in double precision, from values that were not packed.
  double expect(const TransportCoefficients& coefficients, std::size_t place, std::size_t c) const {
    const auto cosine =
        std::max(dot(normals[place], normalize(Vec3{0, 0, 100} - positions[place])), 0.0f);
    double sum = 0;
    for (std::size_t light = 0; light < 2; ++light) {
      for (std::size_t j = 0; j < 9; ++j)
        sum += static_cast<double>(coefficients.multiple[3 * j + c]) *
               static_cast<double>(multiple[light][(place * 9 + j) * 3 + c]);
      for (std::size_t j = 0; j < 7; ++j) {
        const float* S = &single[light][(place * 7 + j) * 12];
        double phase = static_cast<double>(S[c]);
        for (std::size_t k = 1; k < 4; ++k)
          phase -= static_cast<double>(coefficients.three_g[c]) *
                   static_cast<double>(view.value[(place / 8 * 4 + k) * 8 + place % 8]) *
                   static_cast<double>(S[3 * k + c]);
        sum += static_cast<double>(coefficients.single[3 * j + c]) * phase;
      }
    }
    return sum * static_cast<double>(fresnel_transmission(1.3f, cosine));
  }
};

TEST(Half, ConvertsEveryFiniteNumber) {
  for (std::uint32_t bits = 0; bits < 0x10000u; ++bits) {
    if ((bits & 0x7c00u) == 0x7c00u) continue;  // infinities and NaN
    const auto half = static_cast<std::uint16_t>(bits);
    const float value = half_to_float(half);
    EXPECT_EQ(float_to_half(value), half) << bits;
    const int exponent = static_cast<int>((bits >> 10u) & 31u);
    const double mantissa = (bits & 1023u) / 1024.0;
    const double expected =
        std::ldexp(exponent == 0 ? mantissa : 1 + mantissa, std::max(exponent, 1) - 15);
    EXPECT_EQ(static_cast<double>(std::abs(value)), expected) << bits;
  }
}

TEST(Half, RoundsToTheNearest) {
  Rng rng = make_rng(1);
  for (int i = 0; i < 20000; ++i) {
    const auto value = static_cast<float>(std::exp(-25 + 36 * sample_uniform(rng)));
    if (value >= 65504) continue;
    const std::uint16_t half = float_to_half(value);
    const double error =
        std::abs(static_cast<double>(half_to_float(half)) - static_cast<double>(value));
    for (const int step : {-1, 1}) {
      const auto other = static_cast<std::uint16_t>(half + step);
      EXPECT_LE(error,
                std::abs(static_cast<double>(half_to_float(other)) - static_cast<double>(value)));
    }
  }
}

TEST(HomogeneousTransport, PackingKeepsElevenBits) {
  const std::vector<float> values = make_values(100 * 5 * 3, 1e5, 1e9, 7);
  const PackedTransport packed = pack_transport(values, 5, 3);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double kept = static_cast<double>(unpack(packed, i / 15, i % 15 / 3, i % 3));
    EXPECT_NEAR(kept / static_cast<double>(values[i]), 1, 0x1p-11);
  }
}

TEST(HomogeneousTransport, RadianceIsTheDotProducts) {
  const Fixture fixture;
  const TransportCoefficients coefficients =
      TransportProjection(fixture.transport).fit(fixture.material);
  std::vector<Rgb> radiance;
  eval_transport(fixture.transport, coefficients, {{1, 1, 1}, {1, 1, 1}}, fixture.view, radiance);
  ASSERT_EQ(radiance.size(), Fixture::places);
  double largest = 0;
  for (const Rgb& value : radiance) largest = std::max(largest, static_cast<double>(value.y));
  for (std::size_t i = 0; i < Fixture::places; ++i) {
    const double found[3] = {static_cast<double>(radiance[i].x), static_cast<double>(radiance[i].y),
                             static_cast<double>(radiance[i].z)};
    for (std::size_t c = 0; c < 3; ++c)
      EXPECT_NEAR(found[c], fixture.expect(coefficients, i, c), 1e-3 * largest) << i;
  }
}

TEST(HomogeneousTransport, LightsAreAddedWithTheirColours) {
  const Fixture fixture;
  const TransportCoefficients coefficients =
      TransportProjection(fixture.transport).fit(fixture.material);
  std::vector<Rgb> first, second, both;
  const Rgb warm{2, 1, 0.5f}, cold{0.25f, 0.5f, 1};
  eval_transport(fixture.transport, coefficients, {warm, {0, 0, 0}}, fixture.view, first);
  eval_transport(fixture.transport, coefficients, {{0, 0, 0}, cold}, fixture.view, second);
  eval_transport(fixture.transport, coefficients, {warm, cold}, fixture.view, both);
  for (std::size_t i = 0; i < both.size(); ++i) {
    EXPECT_NEAR(both[i].x, first[i].x + second[i].x, 1e-4f * (1 + std::abs(both[i].x)));
    EXPECT_NEAR(both[i].z, first[i].z + second[i].z, 1e-4f * (1 + std::abs(both[i].z)));
  }
}

TEST(HomogeneousTransport, ThreadsAndProcessorsGiveTheSameBits) {
  const Fixture fixture;
  const TransportCoefficients coefficients =
      TransportProjection(fixture.transport).fit(fixture.material);
  std::vector<Rgb> all, one;
  eval_transport(fixture.transport, coefficients, {{1, 1, 1}, {1, 1, 1}}, fixture.view, all);
  {
    const ThreadLimit limit(1);
    eval_transport(fixture.transport, coefficients, {{1, 1, 1}, {1, 1, 1}}, fixture.view, one);
  }
  EXPECT_EQ(all, one);
#ifdef PARIAN_TRANSPORT_HAS_F16C
  if (__builtin_cpu_supports("avx2") == 0 || __builtin_cpu_supports("f16c") == 0) return;
  const PackedTransport& S = fixture.transport.lights[0].single;
  const std::size_t blocks = S.half.size() / (S.functions * 12 * transport_lanes);
  std::vector<float> baseline(blocks * 24), f16c(blocks * 24);
  transport_baseline::add_single(S.half.data(), blocks, S.functions, coefficients.single.data(),
                                 coefficients.three_g.data(), fixture.view.value.data(),
                                 baseline.data());
  transport_f16c::add_single(S.half.data(), blocks, S.functions, coefficients.single.data(),
                             coefficients.three_g.data(), fixture.view.value.data(), f16c.data());
  EXPECT_EQ(baseline, f16c);
#endif
}

TEST(HomogeneousTransport, CoefficientsFollowTheMaterial) {
  const Fixture fixture;
  const TransportProjection projection(fixture.transport);
  Dipole material = fixture.material;
  material.channels[0].g = 0.9;  // the phase function is clamped, sigma_s' is not
  const TransportCoefficients coefficients = projection.fit(material);
  EXPECT_FLOAT_EQ(coefficients.three_g[0], 1);
  EXPECT_FLOAT_EQ(coefficients.three_g[1], static_cast<float>(3 * material.channels[1].g));
  // E(0) = 1: the first hat's coefficient is close to sigma_s / 4 pi.
  const double sigma_s = material.channels[0].sigma_s_prime / (1 - 0.9);
  double sum = 0;  // int sum e_j B_j ds = sigma_s / (4 pi sigma_t)
  const std::vector<double> integrals =
      integrate_basis(fixture.transport.single_basis, [](double) { return 1.0; });
  for (std::size_t j = 0; j < integrals.size(); ++j)
    sum += static_cast<double>(coefficients.single[3 * j]) * integrals[j];
  const double sigma_t = sigma_s + material.channels[0].sigma_a;
  EXPECT_NEAR(sum, sigma_s / sigma_t / (4 * std::numbers::pi), 0.02 * sum);
  Dipole drawn = material;
  drawn.attenuation_gain = {{0, 2}};
  drawn.reflectance_gain = {{5, 3}};
  const TransportCoefficients edited = projection.fit(drawn);
  for (std::size_t j = 0; j < edited.single.size(); ++j)
    EXPECT_NEAR(edited.single[j], 2 * coefficients.single[j], 1e-4f * edited.single[0]);
  for (std::size_t j = 0; j < edited.multiple.size(); ++j)
    EXPECT_NEAR(edited.multiple[j], 3 * coefficients.multiple[j], 1e-4f * edited.multiple[0]);
  material.single_scattering = false;
  for (const float value : projection.fit(material).single) EXPECT_EQ(value, 0);
}

TEST(HomogeneousTransport, ViewRefracts) {
  const TransportView view = make_transport_view({{0, 0, 0}}, {{0, 0, 1}}, {3, 0, 3}, 1.5);
  const double sine = std::sqrt(0.5) / 1.5;
  EXPECT_NEAR(view.value[8], sine, 1e-6);
  EXPECT_NEAR(view.value[24], std::sqrt(1 - sine * sine), 1e-6);
  EXPECT_FLOAT_EQ(view.value[0], fresnel_transmission(1.5f, std::sqrt(0.5f)));
  const TransportView behind = make_transport_view({{0, 0, 0}}, {{0, 0, 1}}, {0, 0, -3}, 1.5);
  EXPECT_NEAR(behind.value[0], 0, 1e-6);
}

}  // namespace
}  // namespace parian

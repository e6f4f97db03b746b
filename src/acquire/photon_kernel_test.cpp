// The samplers of the photon engine, each against its distribution.
#include "acquire/photon_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>

#include "acquire/test_statistics_internal.h"
#include "base/random.h"

namespace parian {
namespace {

constexpr int tests = 14;  // chi-square tests in this file
constexpr int batches = 400;

// One voxel of sigma_t = 1 everywhere.
struct Plain {
  std::array<float, 2> voxel{1.f, 1.f};
  std::array<float, 1> g{0.f}, inverse_majorant{1.f};
  PhotonMedium medium;

  Plain() {
    medium.voxels = voxel.data();
    medium.inverse_majorant = inverse_majorant.data();
    medium.cell_voxels = 1e6f;
    medium.thickness = std::numeric_limits<float>::infinity();
  }
};

// Photons at (0, 0, z) with direction u, number `batch` x count and on.
std::unique_ptr<PhotonLanes> make_lanes(int batch, float z, std::array<float, 3> u) {
  auto lanes = std::make_unique<PhotonLanes>();
  for (std::size_t i = 0; i < PhotonLanes::count; ++i) {
    const std::uint64_t id = static_cast<std::uint64_t>(batch) * PhotonLanes::count + i;
    const std::uint64_t low = hash_u64(12345, id), high = hash_u64(low);
    lanes->x[i] = lanes->y[i] = 0, lanes->z[i] = z;
    lanes->ux[i] = u[0], lanes->uy[i] = u[1], lanes->uz[i] = u[2];
    lanes->weight[i] = 1, lanes->absorbed[i] = 0, lanes->state[i] = 0;
    lanes->a[i] = static_cast<std::uint32_t>(low);
    lanes->b[i] = static_cast<std::uint32_t>(low >> 32u);
    lanes->c[i] = static_cast<std::uint32_t>(high);
    lanes->counter[i] = static_cast<std::uint32_t>(high >> 32u);
  }
  return lanes;
}

std::size_t bin_of(double u, std::size_t bins) {
  return static_cast<std::size_t>(
      std::clamp(u * static_cast<double>(bins), 0.0, static_cast<double>(bins) - 1));
}

// Runs one flight of many photons and counts bins of what `uniforms` makes of each: numbers that
// are uniform in [0, 1) if the sampler is right.
using Uniforms = std::function<std::array<double, 2>(const PhotonLanes&, std::size_t)>;
std::vector<double> count_after_flight(const Plain& plain, bool anisotropic,
                                       std::array<float, 3> direction, const Uniforms& uniforms,
                                       std::size_t bins) {
  std::vector<double> counts(bins * bins);
  for (int batch = 0; batch < batches; ++batch) {
    const auto lanes = make_lanes(batch, 1000, direction);
    (anisotropic ? fly_anisotropic : fly_isotropic)(lanes.get(), &plain.medium, PhotonLanes::count,
                                                    1);
    for (std::size_t i = 0; i < PhotonLanes::count; ++i) {
      const auto [u, v] = uniforms(*lanes, i);
      counts[bin_of(u, bins) * bins + bin_of(v, bins)] += 1;
    }
  }
  return counts;
}

double turns(double y, double x) {
  const double angle = std::atan2(y, x) / (2 * std::numbers::pi);
  return angle < 0 ? angle + 1 : angle;
}

TEST(PhotonKernel, NumbersAreUniformAndConsecutiveOnesIndependent) {
  for (const int lag : {1, 2, 4}) {
    std::vector<double> pairs(32 * 32);
    for (std::uint64_t id = 0; id < 4000; ++id) {
      const std::uint64_t low = hash_u64(id), high = hash_u64(low);
      auto a = static_cast<std::uint32_t>(low), b = static_cast<std::uint32_t>(low >> 32u);
      auto c = static_cast<std::uint32_t>(high), counter = static_cast<std::uint32_t>(high >> 32u);
      std::array<double, 60> u{};
      for (double& value : u) {
        value = to_open_uniform(sample_sfc32(a, b, c, counter));
        ASSERT_GT(value, 0);
        ASSERT_LT(value, 1);
      }
      for (std::size_t i = 0; i + static_cast<std::size_t>(lag) < u.size();
           i += 2 * static_cast<std::size_t>(lag))
        pairs[bin_of(u[i], 32) * 32 + bin_of(u[i + static_cast<std::size_t>(lag)], 32)] += 1;
    }
    EXPECT_GT(chi_square_p(pairs), least_p(tests)) << "lag " << lag;
  }
}

TEST(PhotonKernel, FlightsAreExponential) {
  const Plain plain;
  const auto counts = count_after_flight(
      plain, false, {0.6f, 0, 0.8f},
      [](const PhotonLanes& lanes, std::size_t i) {
        const double s = std::hypot(lanes.x[i], lanes.z[i] - 1000);
        return std::array{1 - std::exp(-s), 0.5};
      },
      64);
  std::vector<double> used;
  for (std::size_t k = 0; k < 64; ++k) used.push_back(counts[k * 64 + 32]);
  EXPECT_GT(chi_square_p(used), least_p(tests));
}

// Half of the flights end in a collision, independently of their length.
TEST(PhotonKernel, CollisionsAreAcceptedByTheMajorant) {
  Plain plain;
  plain.inverse_majorant[0] = 0.5f;
  plain.voxel[1] = 0.25f;  // albedo: weights tell collisions
  std::vector<double> accepted(16), all(16);
  for (int batch = 0; batch < batches; ++batch) {
    const auto lanes = make_lanes(batch, 1000, {1, 0, 0});
    fly_isotropic(lanes.get(), &plain.medium, PhotonLanes::count, 1);
    for (std::size_t i = 0; i < PhotonLanes::count; ++i) {
      const std::size_t bin = bin_of(1 - std::exp(-2 * static_cast<double>(lanes->x[i])), 16);
      all[bin] += 1;
      if (lanes->weight[i] < 1) accepted[bin] += 2;
    }
  }
  // Variance of 2 x binomial(n, 1/2) is n, as chi-square of counts assumes.
  double sum = 0;
  for (std::size_t k = 0; k < 16; ++k)
    sum += (accepted[k] - all[k]) * (accepted[k] - all[k]) / all[k];
  EXPECT_GT(chi_square_tail(sum, 16), least_p(tests));
}

TEST(PhotonKernel, IsotropicScatteringIsUniformOverTheSphere) {
  const Plain plain;
  const auto counts = count_after_flight(
      plain, false, {0, 0, 1},
      [](const PhotonLanes& lanes, std::size_t i) {
        return std::array{(1 + static_cast<double>(lanes.uz[i])) / 2,
                          turns(lanes.uy[i], lanes.ux[i])};
      },
      24);
  EXPECT_GT(chi_square_p(counts), least_p(tests));
}

// The cosine's distribution function, (1 - g^2) / 2 g (1 / sqrt(1 + g^2 - 2 g c) - 1 / (1 + g)).
double henyey_greenstein_cdf(double g, double c) {
  if (g == 0) return (1 + c) / 2;
  return (1 - g * g) / (2 * g) * (1 / std::sqrt(1 + g * g - 2 * g * c) - 1 / (1 + g));
}

std::vector<double> count_henyey_greenstein(double g, double tested_g, std::array<float, 3> u) {
  Plain plain;
  plain.g[0] = static_cast<float>(g);
  plain.medium.g = plain.g.data();
  return count_after_flight(
      plain, true, u,
      [&](const PhotonLanes& lanes, std::size_t i) {
        const std::array<double, 3> v{lanes.ux[i], lanes.uy[i], lanes.uz[i]};
        EXPECT_NEAR(std::hypot(v[0], v[1], v[2]), 1, 2e-6);
        const double c = v[0] * u[0] + v[1] * u[1] + v[2] * u[2];
        // Azimuth around u, in a basis of the test's own.
        const std::array<double, 3> helper =
            std::abs(u[0]) < 0.5f ? std::array<double, 3>{1, 0, 0} : std::array<double, 3>{0, 1, 0};
        const auto cross = [](std::array<double, 3> a, std::array<double, 3> b) {
          return std::array<double, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                       a[0] * b[1] - a[1] * b[0]};
        };
        std::array<double, 3> p = cross({u[0], u[1], u[2]}, helper);
        const double length = std::hypot(p[0], p[1], p[2]);
        for (double& x : p) x /= length;
        const std::array<double, 3> q = cross({u[0], u[1], u[2]}, p);
        const auto dot = [&](std::array<double, 3> a) {
          return a[0] * v[0] + a[1] * v[1] + a[2] * v[2];
        };
        return std::array{henyey_greenstein_cdf(tested_g, std::clamp(c, -1.0, 1.0)),
                          turns(dot(q), dot(p))};
      },
      20);
}

TEST(PhotonKernel, HenyeyGreenstein) {
  const std::array<std::array<float, 3>, 3> directions{
      {{0, 0, 1}, {0, 0, -1}, {0.48f, -0.6f, 0.64f}}};
  for (const double g : {0.0, 0.5, -0.3}) {
    const auto u = directions[g == 0 ? 0 : g > 0 ? 1 : 2];
    EXPECT_GT(chi_square_p(count_henyey_greenstein(g, g, u)), least_p(tests)) << g;
  }
  EXPECT_GT(chi_square_p(count_henyey_greenstein(0.9, 0.9, directions[2])), least_p(tests));
  // The test would notice an error of 0.01.
  EXPECT_LT(chi_square_p(count_henyey_greenstein(0.9, 0.89, directions[2])), 1e-6);
}

// Photons that meet a boundary are reflected as Fresnel's equations say, also beyond the critical
// angle, and go on in the mirrored direction.
TEST(PhotonKernel, BoundariesReflectByFresnel) {
  Plain plain;
  plain.medium.eta = 1.5f;
  plain.medium.thickness = 1e-3f;
  const double eta = 1.5;
  std::vector<double> reflected, expected;
  double all = 0;
  for (const double cosine : {1.0, 0.9, 0.8, 0.77, 0.76, 0.75, 0.7, 0.3}) {
    const auto sine = static_cast<float>(std::sqrt(1 - cosine * cosine));
    const double t2 = 1 - eta * eta * (1 - cosine * cosine);
    const double t = t2 > 0 ? std::sqrt(t2) : 0;
    const double s = (eta * cosine - t) / (eta * cosine + t),
                 p = (cosine - eta * t) / (cosine + eta * t);
    const double fresnel = t2 > 0 ? (s * s + p * p) / 2 : 1;
    double count = 0;
    all = 0;
    for (const float up : {-1.f, 1.f})
      for (int batch = 0; batch < 100; ++batch) {
        const float start = up < 0 ? 1e-6f : 1e-3f - 1e-6f;
        const auto lanes = make_lanes(batch, start, {sine, 0, up * static_cast<float>(cosine)});
        fly_isotropic(lanes.get(), &plain.medium, PhotonLanes::count, 1);
        for (std::size_t i = 0; i < PhotonLanes::count; ++i) {
          const bool at_boundary = lanes->z[i] == (up < 0 ? 0 : 1e-3f);
          if (!at_boundary) continue;  // a collision before it
          all += 1;
          if (lanes->state[i] != 0) {
            EXPECT_EQ(lanes->state[i], up < 0 ? 1u : 2u);
            continue;
          }
          count += 1;
          EXPECT_EQ(lanes->uz[i], -up * static_cast<float>(cosine));
          EXPECT_EQ(lanes->ux[i], sine);
        }
      }
    if (fresnel == 1) {
      EXPECT_EQ(count, all) << cosine;
      continue;
    }
    reflected.push_back((count - all * fresnel) / std::sqrt(all * fresnel * (1 - fresnel)));
  }
  double sum = 0;
  for (const double z : reflected) sum += z * z;
  EXPECT_GT(chi_square_tail(sum, static_cast<double>(reflected.size())), least_p(tests));
}

TEST(PhotonKernel, LightEntersUniformlyAndLambertian) {
  const float eta = 1.4f;
  std::vector<double> place(20 * 20), direction(20 * 20);
  auto lanes = std::make_unique<PhotonLanes>();
  std::vector<std::uint64_t> ids(PhotonLanes::count);
  for (int batch = 0; batch < batches; ++batch) {
    for (std::size_t i = 0; i < ids.size(); ++i) {
      ids[i] = static_cast<std::uint64_t>(batch) * ids.size() + i;
      lanes->entry_x[i] = 3, lanes->entry_y[i] = 7;
    }
    launch_photons(lanes.get(), ids.data(), 99, 2.f, eta, true, ids.size());
    for (std::size_t i = 0; i < ids.size(); ++i) {
      place[bin_of((lanes->x[i] - 3) / 2, 20) * 20 + bin_of((lanes->y[i] - 7) / 2, 20)] += 1;
      // Snell: sin^2 outside is uniform for Lambertian light.
      const double sine2 = static_cast<double>(lanes->ux[i]) * lanes->ux[i] +
                           static_cast<double>(lanes->uy[i]) * lanes->uy[i];
      direction[bin_of(sine2 * eta * eta, 20) * 20 +
                bin_of(turns(lanes->uy[i], lanes->ux[i]), 20)] += 1;
      // The transmitted part, from outside with cosines `out` and `in`.
      const double in = lanes->uz[i], out = std::sqrt(std::max(0.0, 1 - sine2 * eta * eta));
      const double s = (out - eta * in) / (out + eta * in), p = (eta * out - in) / (eta * out + in);
      ASSERT_NEAR(lanes->weight[i], 1 - (s * s + p * p) / 2, 2e-3);
    }
  }
  EXPECT_GT(chi_square_p(place), least_p(tests));
  EXPECT_GT(chi_square_p(direction), least_p(tests));
}

TEST(PhotonKernel, NormalLightKeepsItsDirection) {
  auto lanes = std::make_unique<PhotonLanes>();
  std::vector<std::uint64_t> ids(16);
  std::fill_n(lanes->entry_x, 16, 0.f);
  std::fill_n(lanes->entry_y, 16, 0.f);
  launch_photons(lanes.get(), ids.data(), 1, 1.f, 1.5f, false, 16);
  EXPECT_EQ(lanes->uz[3], 1.f);
  EXPECT_NEAR(lanes->weight[3], 0.96, 1e-6);  // 1 - ((n - 1) / (n + 1))^2
}

// Flights may not go further than their bound holds.
TEST(PhotonKernel, FlightsEndWithinTheCell) {
  Plain plain;
  plain.medium.cell_voxels = 0.5f;
  const auto lanes = make_lanes(1, 1000, {1, 0, 0});
  fly_isotropic(lanes.get(), &plain.medium, PhotonLanes::count, 1);
  std::size_t cut = 0;
  for (std::size_t i = 0; i < PhotonLanes::count; ++i) {
    EXPECT_LE(lanes->x[i], 0.5f);
    if (lanes->x[i] < 0.5f) continue;
    ++cut;
    EXPECT_EQ(lanes->ux[i], 1.f);
  }
  EXPECT_NEAR(static_cast<double>(cut), 256 * std::exp(-0.5), 5 * 8);
}

// Marks: what has left, and weights far from the target.
TEST(PhotonKernel, WeightWindow) {
  const WeightWindow window{.near = 1,
                            .reach = 8,
                            .depth_factor = 2,
                            .least = 0.25f,
                            .most = 10,
                            .low = 0.5f,
                            .high = 2,
                            .restored = 1};
  auto lanes = make_lanes(1, 0, {0, 0, 1});
  const std::array<float, 6> x{0.5f, 2, 6, 16, 800, 0}, z{0, 0, 0, 0, 0, 1};
  const std::array<float, 6> target{1, 0.5f, 0.25f, 4, 10, 0.5f};
  for (std::size_t i = 0; i < x.size(); ++i) {
    lanes->entry_x[i] = 10, lanes->entry_y[i] = 0;
    lanes->x[i] = 10 + x[i], lanes->y[i] = 0, lanes->z[i] = z[i];
    lanes->weight[i] = 1;
  }
  lanes->state[0] = 1;
  mark_lanes(lanes.get(), &window, 6);
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_FLOAT_EQ(lanes->target[i], target[i]) << i;
  const std::array<std::uint32_t, 6> attention{1, 0, 8, 8, 8, 0};
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(lanes->attention[i], attention[i]) << i;
}

}  // namespace
}  // namespace parian

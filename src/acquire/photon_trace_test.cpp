// Photons against exact totals, against a plain code of the test's own, and against themselves.
#include "acquire/photon_trace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "acquire/test_statistics_internal.h"
#include "base/random.h"

namespace parian {
namespace {

PhotonVolume make_homogeneous(double sigma_a, double sigma_s, double eta, double thickness_mm = 0,
                              double g = 0, double voxel_mm = 1) {
  PhotonVolume volume;
  volume.voxel_mm = voxel_mm;
  volume.eta = eta;
  volume.thickness_mm = thickness_mm;
  volume.sigma_a = {static_cast<float>(sigma_a)};
  volume.sigma_s = {static_cast<float>(sigma_s)};
  if (g != 0) volume.g = {static_cast<float>(g)};
  return volume;
}

struct Estimate {
  double value = 0, error = 0;
};
struct Totals {
  Estimate reflected, transmitted;
  double balance = 0;
};

struct TraceOptions {
  PhotonEntry entry = PhotonEntry::normal;
  WeightWindow window;
  std::uint64_t photons = 1500;  // per batch
  int cell_voxels = 0;
  std::uint64_t key = 5;
};

Totals measure(const PhotonVolume& volume, const TraceOptions& options = {}) {
  constexpr int batches = 20;
  const PhotonChannel channel = make_photon_channel(volume, 0, options.cell_voxels);
  std::array<double, 2> sum{}, squares{};
  Totals totals;
  for (int batch = 0; batch < batches; ++batch) {
    PhotonTask task;
    task.volume = &volume, task.channel = &channel;
    task.entry = options.entry, task.window = options.window;
    task.key = options.key;
    task.photons = options.photons;
    task.first_photon = static_cast<std::uint64_t>(batch) * options.photons;
    std::vector<float> tally(9);
    const PhotonTotals found = trace_photons(task, tally.data());
    const std::array<double, 2> parts{found.reflected / found.launched,
                                      found.transmitted / found.launched};
    for (std::size_t i = 0; i < 2; ++i) sum[i] += parts[i], squares[i] += parts[i] * parts[i];
    totals.balance = std::max(totals.balance, std::abs(balance(found)) / found.launched);
  }
  const auto estimate = [&](std::size_t i) {
    const double mean = sum[i] / batches;
    return Estimate{mean, std::sqrt((squares[i] / batches - mean * mean) / (batches - 1))};
  };
  totals.reflected = estimate(0);
  totals.transmitted = estimate(1);
  return totals;
}

// Student's t of 19 degrees has heavier tails than the normal law; Hill's transformation.
double tail_of(Estimate estimate, double exact) {
  const double n = 19, t = (estimate.value - exact) / estimate.error;
  const double z = std::sqrt(n * std::log1p(t * t / n)) * (1 - 3 / (4 * n));
  return normal_tail(z);
}

// Half-infinite, isotropic, light along the normal; the diffuse part alone (H functions and Fresnel
// by a linear solve).
TEST(PhotonTrace, TotalsOfTheHalfSpace) {
  constexpr std::array<double, 7> albedo{0.5, 0.8, 0.9, 0.95, 0.98, 0.99, 0.999};
  constexpr std::array<double, 4> eta{1, 1.3, 1.4, 1.5};
  constexpr double exact[7][4] = {
      {.11523, .06241, .05230, .04425}, {.28525, .17824, .15305, .13198},
      {.41495, .28578, .25060, .21992}, {.53554, .40088, .35913, .32112},
      {.67108, .54782, .50378, .46147}, {.75272, .64539, .60359, .56198},
      {.91285, .85675, .83012, .80146}};
  for (std::size_t i = 0; i < albedo.size(); ++i)
    for (std::size_t k = 0; k < eta.size(); ++k) {
      TraceOptions options;
      options.key = 10 * i + k;
      if (albedo[i] > 0.99) options.photons = 300;
      const Totals totals = measure(make_homogeneous(1 - albedo[i], albedo[i], eta[k]), options);
      EXPECT_GT(tail_of(totals.reflected, exact[i][k]), least_p(28))
          << albedo[i] << " " << eta[k] << ": " << totals.reflected.value << " +- "
          << totals.reflected.error;
      EXPECT_LT(totals.balance, 1e-6);
      EXPECT_EQ(totals.transmitted.value, 0);
    }
}

// Slabs of optical thickness b with matched boundaries: van de Hulst's tables and MCML's test case.
TEST(PhotonTrace, TotalsOfSlabs) {
  struct Case {
    double albedo, g, b, reflected, transmitted;  // negative: not listed
  };
  for (const Case& c : {Case{1, 0, 1, .34133, .65867}, Case{1, 0.5, 1, .17611, .82389},
                        Case{0.9, 0.5, 1, -1, .73909}, Case{0.9, 0.75, 2, .09739, .66096}}) {
    const Totals totals = measure(make_homogeneous(1 - c.albedo, c.albedo, 1, c.b, c.g, 0.5));
    EXPECT_GT(tail_of(totals.transmitted, c.transmitted), least_p(8)) << c.b << " " << c.g;
    if (c.reflected > 0) {
      EXPECT_GT(tail_of(totals.reflected, c.reflected), least_p(8)) << c.b << " " << c.g;
    }
    EXPECT_LT(totals.balance, 1e-6);
  }
}

TEST(PhotonTrace, AnAbsorberTransmitsExponentially) {
  for (const double depth : {0.5, 2.0}) {
    const Totals totals = measure(make_homogeneous(1, 1e-12, 1, depth, 0, 0.3));
    EXPECT_GT(tail_of(totals.transmitted, std::exp(-depth)), least_p(2));
    EXPECT_LT(totals.reflected.value, 1e-6);
  }
}

// Importance, whatever its numbers, changes variances and no mean; weights stay in balance.
TEST(PhotonTrace, SplittingAndRouletteKeepTheMean) {
  const PhotonVolume volume = make_homogeneous(0.02, 1, 1.4);
  for (const float least : {1.f, 0.25f, 0.03f}) {
    TraceOptions options;
    options.window = {.near = 1,
                      .reach = 4,
                      .depth_factor = 2,
                      .least = least,
                      .most = 10,
                      .low = 0.5f,
                      .high = 2,
                      .restored = 1};
    const Totals totals = measure(volume, options);
    EXPECT_GT(tail_of(totals.reflected, .50378), least_p(3)) << least;
    EXPECT_LT(totals.balance, 2e-6);
  }
}

// A board of 8 x 8 x 4 voxels with two very different materials, in pixels of one voxel.
PhotonVolume make_board(double thickness_mm = 0) {
  PhotonVolume volume = make_homogeneous(0, 0, 1.4, thickness_mm, 0, 0.5);
  volume.nx = volume.ny = 8, volume.nz = 4;
  volume.width = volume.height = 4;
  volume.margin = 2;
  volume.sigma_a.resize(volume.voxels());
  volume.sigma_s.resize(volume.voxels());
  for (std::size_t i = 0; i < volume.voxels(); ++i) {
    const bool dark = (i % 8 / 2 + i / 8 % 8 / 2 + i / 64) % 2 == 0;
    volume.sigma_a[i] = dark ? 0.3f : 0.01f;
    volume.sigma_s[i] = dark ? 6.f : 1.f;
  }
  return volume;
}

TEST(PhotonTrace, BoundsOnTheCoefficientDoNotMatter) {
  const PhotonVolume volume = make_board(2);
  TraceOptions options;
  options.entry = PhotonEntry::lambertian;
  options.photons = 2000;
  const Totals local = measure(volume, options);
  options.cell_voxels = 64, options.key = 6;
  const Totals global = measure(volume, options);
  options.cell_voxels = 1, options.key = 7;
  const Totals short_flights = measure(volume, options);
  for (const Totals* other : {&global, &short_flights}) {
    const auto z = [](Estimate a, Estimate b) {
      return (a.value - b.value) / std::hypot(a.error, b.error);
    };
    EXPECT_GT(normal_tail(z(local.reflected, other->reflected)), least_p(4));
    EXPECT_GT(normal_tail(z(local.transmitted, other->transmitted)), least_p(4));
  }
}

// Tallies of all 16 pixels over a window of 3 pixels around each.
std::vector<float> tally_board(const PhotonVolume& volume, PhotonEntry entry, std::uint64_t first,
                               std::uint64_t photons, const WeightWindow& window = {}) {
  const PhotonChannel channel = make_photon_channel(volume, 0);
  PhotonTask task;
  task.volume = &volume, task.channel = &channel;
  task.entry = entry, task.window = window;
  task.radius = 3, task.columns = task.rows = 4;
  task.key = 17, task.first_photon = first, task.photons = photons;
  std::vector<float> tally(16 * 49);
  trace_photons(task, tally.data());
  return tally;
}

// Power from pixel a to pixel b of the board.
double power(const std::vector<float>& tally, int a, int b) {
  const int dx = b % 4 - a % 4, dy = b / 4 - a / 4;
  return tally[static_cast<std::size_t>(a * 49 + (dy + 3) * 7 + dx + 3)];
}

// Light sent at b from a is light sent at a from b: chi-square over all pairs, with weights between
// 0 and 1 bounding the variance by the sum.
double reciprocity_p(const std::vector<float>& tally) {
  double sum = 0, pairs = 0;
  for (int a = 0; a < 16; ++a)
    for (int b = 0; b < a; ++b) {
      const double both = power(tally, a, b) + power(tally, b, a);
      if (both == 0) continue;
      const double difference = power(tally, a, b) - power(tally, b, a);
      sum += difference * difference / both;
      pairs += 1;
    }
  return chi_square_tail(sum, pairs);
}

// Columns, between boundaries that let light pass at all angles: what enters along the normal stays
// in its column, what comes from all sides meets the walls.
PhotonVolume make_columns() {
  PhotonVolume volume = make_board();
  volume.eta = 1;
  for (std::size_t i = 0; i < volume.voxels(); ++i) {
    const bool dark = (i % 8 + i / 8 % 8) % 2 == 0;
    volume.sigma_a[i] = dark ? 10.f : 0.01f;
    volume.sigma_s[i] = dark ? 10.f : 1.f;
  }
  return volume;
}

TEST(PhotonTrace, LambertianLightIsReciprocal) {
  const PhotonVolume volume = make_columns();
  EXPECT_GT(reciprocity_p(tally_board(volume, PhotonEntry::lambertian, 0, 20000)), 1e-3);
  // A beam along the normal is not, and the test sees it.
  EXPECT_LT(reciprocity_p(tally_board(volume, PhotonEntry::normal, 0, 20000)), 1e-6);
}

TEST(PhotonTrace, TalliesAddUp) {
  const PhotonVolume volume = make_board();
  const auto all = tally_board(volume, PhotonEntry::lambertian, 0, 600);
  const auto first = tally_board(volume, PhotonEntry::lambertian, 0, 250);
  const auto rest = tally_board(volume, PhotonEntry::lambertian, 250, 350);
  double total = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    ASSERT_NEAR(all[i], first[i] + rest[i], 1e-5 * (1 + static_cast<double>(all[i])));
    total += all[i];
  }
  EXPECT_GT(total, 1000);
  EXPECT_EQ(all, tally_board(volume, PhotonEntry::lambertian, 0, 600));
}

// Where all places are alike, a path is as likely from every pixel of the task: they share all.
TEST(PhotonTrace, SharedPathsCountAlikeWhereTheMediumIsAlike) {
  PhotonVolume volume = make_board();
  volume.sigma_a.assign(volume.voxels(), 0.1f);
  volume.sigma_s.assign(volume.voxels(), 2.f);
  const PhotonChannel channel = make_shared_channel(volume, 0);
  PhotonTask task;
  task.volume = &volume, task.channel = &channel, task.shared = true;
  task.radius = 3, task.columns = task.rows = 4;
  task.key = 17, task.photons = 300;
  std::vector<float> tally(16 * 49);
  const PhotonTotals totals = trace_photons(task, tally.data());
  EXPECT_LT(std::abs(balance(totals)), 1e-6 * totals.launched);
  for (int a = 1; a < 16; ++a)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = a % 4 + dx, y = a / 4 + dy;
        if (x < 0 || y < 0 || x > 3 || y > 3) continue;
        // Pixel 5 has all nine neighbours.
        const double expected = power(tally, 5, 5 + dy * 4 + dx);
        EXPECT_GT(expected, 0);
        EXPECT_NEAR(power(tally, a, y * 4 + x), expected, 1e-4 * expected);
      }
}

// A wall between two halves: paths are shared within a half and hardly across, whatever the block.
TEST(PhotonTrace, SharedPathsSeeTheirPlace) {
  PhotonVolume volume = make_board();
  for (std::size_t i = 0; i < volume.voxels(); ++i) {
    const bool left = i % 8 < 4;
    volume.sigma_a[i] = left ? 0.01f : 2.f;
    volume.sigma_s[i] = left ? 4.f : 1.f;
  }
  const PhotonChannel shared = make_shared_channel(volume, 0);
  const PhotonChannel plain = make_photon_channel(volume, 0);
  std::array<std::vector<float>, 2> tallies;
  for (const bool is_shared : {false, true}) {
    PhotonTask task;
    task.volume = &volume, task.channel = is_shared ? &shared : &plain, task.shared = is_shared;
    task.radius = 3, task.columns = task.rows = 4;
    task.key = is_shared ? 1 : 2, task.photons = 6000;
    tallies[is_shared ? 1 : 0].resize(16 * 49);
    trace_photons(task, tallies[is_shared ? 1 : 0].data());
  }
  // Sums over rows by columns of entry and exit; weights <= 1 bound variances by sums.
  for (int from = 0; from < 4; ++from)
    for (int to = 0; to < 4; ++to) {
      std::array<double, 2> sum{};
      for (int a = from; a < 16; a += 4)
        for (int b = to; b < 16; b += 4)
          for (std::size_t k = 0; k < 2; ++k) sum[k] += power(tallies[k], a, b);
      EXPECT_GT(normal_tail((sum[0] - sum[1]) / std::sqrt(sum[0] + sum[1])), least_p(16))
          << from << " to " << to << ": " << sum[0] << " " << sum[1];
    }
}

// The same light in a grid of equal voxels, in pixels of other sizes, by a plain code in doubles.
struct PlainPhoton {
  double x, y, z, ux, uy, uz;
};
double fresnel(double c, double eta) {
  const double t2 = 1 - eta * eta * (1 - c * c);
  if (t2 <= 0) return 1;
  const double t = std::sqrt(t2), s = (eta * c - t) / (eta * c + t),
               p = (c - eta * t) / (c + eta * t);
  return (s * s + p * p) / 2;
}
// Power per photon that leaves within rings of these outer radii, entering at a point.
std::vector<double> trace_plainly(double sigma_a, double sigma_s, double eta, int photons,
                                  const std::vector<double>& radii) {
  Rng rng = make_rng(77);
  const auto uniform = [&] { return sample_uniform(rng); };
  std::vector<double> rings(radii.size());
  const double sigma_t = sigma_a + sigma_s;
  for (int i = 0; i < photons; ++i) {
    double weight = 1 - fresnel(1, eta);
    PlainPhoton p{0, 0, 0, 0, 0, 1};
    for (;;) {
      const double s = -std::log(1 - uniform()) / sigma_t;
      if (p.z + s * p.uz < 0) {
        const double t = -p.z / p.uz;
        p.x += t * p.ux, p.y += t * p.uy, p.z = 0;
        if (uniform() < fresnel(-p.uz, eta)) {
          p.uz = -p.uz;
          continue;
        }
        const auto ring = std::upper_bound(radii.begin(), radii.end(), std::hypot(p.x, p.y));
        if (ring != radii.end()) rings[static_cast<std::size_t>(ring - radii.begin())] += weight;
        break;
      }
      p.x += s * p.ux, p.y += s * p.uy, p.z += s * p.uz;
      weight *= sigma_s / sigma_t;
      if (weight < 1e-2) {
        if (uniform() >= 0.1) break;
        weight *= 10;
      }
      p.uz = 2 * uniform() - 1;
      const double phi = 2 * std::numbers::pi * uniform(), r = std::sqrt(1 - p.uz * p.uz);
      p.ux = r * std::cos(phi), p.uy = r * std::sin(phi);
    }
  }
  return rings;
}

TEST(PhotonTrace, EqualVoxelsAreAHomogeneousMedium) {
  // A grid of 81 x 81 x 5 voxels of 0.05 mm around a pixel that is small beside the mean free path.
  PhotonVolume volume = make_homogeneous(0.1, 2, 1.4, 0, 0, 0.05);
  volume.nx = volume.ny = volume.width = volume.height = 81, volume.nz = 5;
  volume.sigma_a.assign(volume.voxels(), 0.1f);
  volume.sigma_s.assign(volume.voxels(), 2.f);
  const PhotonChannel channel = make_photon_channel(volume, 0);
  constexpr int photons = 40000;
  PhotonTask task;
  task.volume = &volume, task.channel = &channel;
  task.entry = PhotonEntry::normal;
  task.radius = 40, task.x0 = task.y0 = 40, task.photons = photons, task.key = 3;
  std::vector<float> tally(81 * 81);
  trace_photons(task, tally.data());
  const std::vector<double> radii{0.3, 0.6, 1.0, 1.5, 2.0};
  std::vector<double> rings(radii.size());
  for (int dy = -40; dy <= 40; ++dy)
    for (int dx = -40; dx <= 40; ++dx) {
      const auto ring = std::upper_bound(radii.begin(), radii.end(), 0.05 * std::hypot(dx, dy));
      if (ring != radii.end())
        rings[static_cast<std::size_t>(ring - radii.begin())] +=
            tally[static_cast<std::size_t>((dy + 40) * 81 + dx + 40)];
    }
  const std::vector<double> plain = trace_plainly(0.1, 2, 1.4, photons, radii);
  for (std::size_t k = 0; k < radii.size(); ++k)  // weights <= 1 bound the variance by the mean
    EXPECT_GT(normal_tail((rings[k] - plain[k]) / std::sqrt(rings[k] + plain[k])), least_p(5))
        << radii[k] << ": " << rings[k] / photons << " " << plain[k] / photons;
}

}  // namespace
}  // namespace parian

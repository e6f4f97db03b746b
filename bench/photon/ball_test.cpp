#include "bench/photon/ball.h"

#include <gtest/gtest.h>

#include <cmath>

#include "acquire/test_statistics_internal.h"
#include "base/parallel.h"
#include "base/random.h"
#include "bench/photon/batches.h"

namespace parian::photon {
namespace {

constexpr std::size_t batches = 32;
using Batches = std::vector<BallTally>;

Batches trace(const Ball& ball, const std::vector<double>& edges, std::uint64_t seed,
              std::uint64_t photons) {
  Batches found(batches);
  parallel_for(batches, [&](std::size_t i) {
    found[i] = trace_ball(ball, edges, hash_u64(seed, i), photons / batches);
  });
  return found;
}

TEST(Ball, LosesNoPower) {
  for (const double curvature : {0.0, 0.1, 0.5}) {
    const BallTally tally =
        trace_ball({.curvature = curvature, .sigma_a = 0.3, .sigma_s = 2}, {0, 1}, 1, 20000);
    EXPECT_NE(tally.totals.roulette, 0);
    EXPECT_GT(tally.totals.reflected, 0);
    EXPECT_LT(std::abs(balance(tally.totals)), 1e-11 * tally.totals.launched);
  }
}

TEST(Ball, ReturnsAllLightWithoutAbsorption) {
  const double radius = 3;
  const BallTally tally =
      trace_ball({.curvature = 1 / radius, .sigma_a = 0, .sigma_s = 2}, {0, 2 * radius}, 2, 20000);
  const PhotonTotals& totals = tally.totals;
  EXPECT_EQ(totals.absorbed, 0);
  EXPECT_EQ(totals.roulette, 0);
  EXPECT_NEAR(totals.specular + totals.reflected, totals.launched, 1e-11 * totals.launched);
  // No place is further away than the diameter, but for rounding at the opposite pole.
  EXPECT_NEAR(tally.rings[0], totals.reflected, 1e-11 * totals.reflected);
}

// A Lambertian point of a sphere lights the whole sphere evenly.
TEST(Ball, SendsLightEvenlyThroughClearSpheres) {
  const double radius = 2;
  std::vector<double> edges;
  for (int i = 0; i <= 10; ++i) edges.push_back(2 * radius * std::sqrt(0.1 * i));
  const double photons = 100000;
  const BallTally tally =
      trace_ball({.curvature = 1 / radius, .sigma_a = 0, .sigma_s = 1e-12, .eta = 1}, edges, 3,
                 static_cast<std::uint64_t>(photons));
  EXPECT_GT(chi_square_p(tally.rings, std::vector<double>(10, photons / 10)), least_p(1));
}

// In the equilibrium of a ball that does not absorb, radiance inside is eta^2 times that outside,
// however it scatters; absorbed to first order, per power sent, sigma_a eta^2 4 V / S.
TEST(Ball, AbsorbsByTheMeanPathLength) {
  const double sigma_a = 1e-7;
  for (const double radius : {0.5, 2.0})
    for (const double eta : {1.0, 1.3})
      for (const double sigma_s : {0.2, 2.0}) {
        const Ball ball{
            .curvature = 1 / radius, .sigma_a = sigma_a, .sigma_s = sigma_s, .eta = eta};
        const PhotonEstimate found = estimate(
            trace(ball, {0, 1}, 4, 60000),
            [](const BallTally& each) { return each.totals.absorbed / each.totals.launched; });
        const double expected = sigma_a * eta * eta * 4 * radius / 3;
        const double z = (found.value - expected) / found.error;
        EXPECT_GT(normal_tail(z), least_p(8)) << radius << ' ' << eta << ' ' << sigma_s;
        EXPECT_LT(found.error, 0.02 * expected);
      }
}

TEST(Ball, MeetsThePlaneWhenLarge) {
  const std::vector<double> edges{0, 0.25, 0.5, 1, 2, 4};
  Ball ball{.sigma_a = 0.1, .sigma_s = 2};
  const Batches plane = trace(ball, edges, 5, 100000);
  ball.curvature = 1e-5;
  const Batches large = trace(ball, edges, 6, 100000);
  const auto count = static_cast<int>(edges.size());
  const auto compare = [&](const auto& power) {
    const PhotonEstimate a = estimate(plane, power), b = estimate(large, power);
    const double z = (a.value - b.value) / std::hypot(a.error, b.error);
    EXPECT_GT(normal_tail(z), least_p(count));
    EXPECT_LT(a.error, 0.05 * a.value);
  };
  for (std::size_t i = 0; i + 1 < edges.size(); ++i)
    compare([i](const BallTally& each) { return each.rings[i] / each.totals.launched; });
  compare([](const BallTally& each) { return each.totals.reflected / each.totals.launched; });
}

PhotonTotals trace_by_engine(const Ball& ball, std::uint64_t photons) {
  PhotonVolume volume;
  volume.eta = ball.eta;
  volume.sigma_a = {static_cast<float>(ball.sigma_a)};
  volume.sigma_s = {static_cast<float>(ball.sigma_s)};
  const PhotonChannel channel = make_photon_channel(volume, 0);
  PhotonTask task;
  task.volume = &volume, task.channel = &channel, task.key = 7, task.photons = photons;
  std::vector<float> tally(9);
  return trace_photons(task, tally.data());
}

TEST(Ball, PlaneMeetsThePhotonEngine) {
  const Ball ball{.sigma_a = 0.1, .sigma_s = 2};
  const double photons = 100000;
  const PhotonTotals engine = trace_by_engine(ball, static_cast<std::uint64_t>(photons));
  const auto compare = [&](double PhotonTotals::*part) {
    const PhotonEstimate found = estimate(
        trace(ball, {0, 1}, 8, static_cast<std::uint64_t>(photons)),
        [part](const BallTally& each) { return each.totals.*part / each.totals.launched; });
    // As many photons on both sides; the engine's weight window only lowers the variance.
    const double z = (found.value - engine.*part / engine.launched) / (std::sqrt(2) * found.error);
    EXPECT_GT(normal_tail(z), least_p(2));
    EXPECT_LT(found.error, 0.005 * found.value);
  };
  compare(&PhotonTotals::reflected);
  compare(&PhotonTotals::specular);
}

}  // namespace
}  // namespace parian::photon

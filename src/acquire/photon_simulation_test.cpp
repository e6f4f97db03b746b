#include "acquire/photon_simulation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "acquire/test_documents_internal.h"
#include "acquire/test_statistics_internal.h"
#include "base/parallel.h"
#include "base/test_errors.h"
#include "material/bssrdf_table.h"

namespace parian {
namespace {

// 8 x 6 pixels of 0.5 mm, radius 2, squares of light and dark, one channel.
Document small_description() {
  return object(
      {{"name", "board"},
       {"materials", array({object({{"name", "light"}, {"sigma_a", 0.01}, {"sigma_s_prime", 2.0}}),
                            object({{"name", "dark"}, {"sigma_a", 0.2}, {"sigma_s_prime", 1.0}})})},
       {"layout", object({{"kind", "chessboard"}, {"tile_mm", 1}})},
       {"channels", 1},
       {"pitch_mm", 0.5},
       {"size", array({8, 6})},
       {"radius_px", 2},
       {"depth", object({{"margin_px", 2}})}});
}
Sample small_sample(const Document& document = small_description()) {
  return read_sample(locate(document), {});
}

PhotonProgress run(const Sample& sample, const PhotonParams& params) {
  PhotonSimulation simulation(sample, params);
  while (!simulation.is_done()) simulation.advance();
  return simulation.progress();
}

void expect_equal(const PhotonProgress& a, const PhotonProgress& b) {
  EXPECT_EQ(a.steps, b.steps);
  ASSERT_EQ(a.sums.size(), b.sums.size());
  for (std::size_t c = 0; c < a.sums.size(); ++c) {
    EXPECT_EQ(a.sums[c].forward, b.sums[c].forward);
    EXPECT_EQ(a.sums[c].backward, b.sums[c].backward);
    EXPECT_EQ(a.sums[c].squares, b.sums[c].squares);
    EXPECT_EQ(a.totals[c].sum, b.totals[c].sum);
    EXPECT_EQ(a.totals[c].flights, b.totals[c].flights);
  }
}

TEST(PhotonSimulation, SameBitsForAnyNumberOfThreads) {
  const Sample sample = small_sample();
  PhotonProgress one, three;
  {
    const ThreadLimit limit(1);
    one = run(sample, {.photons = 400});
  }
  {
    const ThreadLimit limit(3);
    three = run(sample, {.photons = 400});
  }
  expect_equal(one, three);
}

TEST(PhotonSimulation, ResumedRunsGiveTheSameBits) {
  Document document = small_description();
  set(document, "channels", 3);
  const Sample sample = small_sample(document);
  const PhotonParams params{.photons = 160};
  PhotonSimulation first(sample, params);
  for (int step = 0; step < 7; ++step) first.advance();  // in the middle of a round
  EXPECT_FALSE(first.is_done());
  PhotonSimulation second(sample, params);
  EXPECT_EQ(first.fingerprint(), second.fingerprint());
  second.resume(first.progress());
  while (!second.is_done()) second.advance();
  EXPECT_EQ(second.progress().steps, 48u);
  expect_equal(second.progress(), run(sample, params));
}

TEST(PhotonSimulation, FingerprintsTellRunsApart) {
  const Sample sample = small_sample();
  const auto of = [&](const Sample& s, const PhotonParams& params) {
    return PhotonSimulation(s, params).fingerprint();
  };
  const std::uint64_t plain = of(sample, {});
  EXPECT_EQ(plain, of(sample, {}));
  EXPECT_NE(plain, of(sample, {.photons = 100}));
  EXPECT_NE(plain, of(sample, {.photon_seed = 2}));
  EXPECT_NE(plain, of(sample, {.entry = PhotonEntry::normal}));
  Document other = small_description();
  set(other, "layout", object({{"kind", "chessboard"}, {"tile_mm", 1.5}}));
  EXPECT_NE(plain, of(small_sample(other), {}));
}

TEST(PhotonSimulation, ProgressOfAnotherSizeIsRefused) {
  const Sample sample = small_sample();
  PhotonSimulation simulation(sample, {});
  PhotonProgress progress = simulation.progress();
  progress.sums[0].squares.pop_back();
  EXPECT_EQ(error_of([&] { simulation.resume(progress); }),
            "board: values of a channel: expected 336, found 335");
  progress.sums.clear();
  EXPECT_EQ(error_of([&] { simulation.resume(progress); }), "board: channels: expected 1, found 0");
}

TEST(PhotonSimulation, ParametersOutOfRange) {
  const Sample sample = small_sample();
  EXPECT_EQ(error_of([&] { PhotonSimulation(sample, {.until = 1.5}); }),
            "until: expected a value in [0, 1], found 1.5");
}

TEST(PhotonSimulation, TheTableSaysWhatItIs) {
  const Sample sample = small_sample();
  PhotonSimulation simulation(sample, {.photons = 64});
  while (!simulation.is_done()) simulation.advance();
  const auto source = make_photon_source(simulation);
  const TableHeader& header = source->header();
  EXPECT_EQ(header.boundary, Boundary::included);
  EXPECT_EQ(header.sampling, Sampling::area);
  EXPECT_TRUE(header.symmetric);
  EXPECT_TRUE(header.has_noise_model());
  EXPECT_TRUE(header.provenance.starts_with(R"({"kind":"photon","simulated":true,"parameters":{)"));
  const BssrdfTable table = read_table(*source);
  std::size_t missing = 0, empty = 0;
  for (const float value : table.reflectance) {
    missing += std::isnan(value) ? 1 : 0;
    empty += value == 0 ? 1 : 0;
  }
  EXPECT_EQ(missing, 68u);  // pairs that leave the grid
  EXPECT_EQ(empty, make_report(simulation).empty_pairs);
}

// Variances of repeated runs beside what the runs themselves say.
struct Repeated {
  double measured = 0, own = 0;        // sums over pairs; from the spread over rounds
  double largest = 0, smallest = 1e9;  // variance by offset over that of the noise model
  double reflected_p = 0;              // of the total's spread, given its standard errors
};
Repeated repeat(PhotonTracking tracking) {
  const Sample sample = small_sample();
  constexpr int runs = 24;
  std::vector<double> sum(7 * 48), squares(7 * 48);
  Repeated found;
  double reflected = 0, reflected2 = 0, error2 = 0, floor2 = 0, gain = 0;
  for (int i = 0; i < runs; ++i) {
    PhotonSimulation simulation(
        sample,
        {.photons = 512, .tracking = tracking, .photon_seed = static_cast<std::uint64_t>(i)});
    while (!simulation.is_done()) simulation.advance();
    const auto source = make_photon_source(simulation);
    const BssrdfTable table = read_table(*source);
    const PhotonSums& sums = simulation.progress().sums[0];
    const auto n = static_cast<double>(simulation.rounds(0));
    for (std::size_t k = 0; k < sum.size(); ++k) {
      const double value = table.reflectance[k];
      sum[k] += value, squares[k] += value * value;
      if (std::isnan(value)) continue;
      const double mean = (static_cast<double>(sums.forward[k]) + sums.backward[k]) / 2 / n;
      // per pixel of 1/4 mm^2
      found.own += (sums.squares[k] / n - mean * mean) / (n - 1) * 16 / runs;
    }
    floor2 += source->header().noise_floor[0] * source->header().noise_floor[0] / runs;
    gain += source->header().noise_gain[0] / runs;
    const PhotonEstimate total = make_report(simulation).channels[0].reflected;
    reflected += total.value;
    reflected2 += total.value * total.value;
    error2 += total.error * total.error / runs;
  }
  for (std::size_t d = 0; d < 7; ++d) {
    double variance = 0, mean = 0, pairs = 0;
    for (std::size_t k = d * 48; k < (d + 1) * 48; ++k) {
      if (std::isnan(sum[k])) continue;
      variance += (squares[k] - sum[k] * sum[k] / runs) / (runs - 1);
      mean += sum[k] / runs, pairs += 1;
    }
    found.measured += variance;
    const double ratio = variance / (pairs * floor2 + gain * mean);
    if (d == 0) continue;  // one direction alone: twice the variance of others at equal R
    found.largest = std::max(found.largest, ratio);
    found.smallest = std::min(found.smallest, ratio);
  }
  const double variance = (reflected2 - reflected * reflected / runs) / (runs - 1);
  found.reflected_p = chi_square_tail(variance / error2 * (runs - 1), runs - 1);
  return found;
}

TEST(PhotonSimulation, NoiseIsThatOfRepeatedRuns) {
  for (const PhotonTracking tracking : {PhotonTracking::analogue, PhotonTracking::importance}) {
    const Repeated found = repeat(tracking);
    EXPECT_NEAR(found.measured, found.own, 0.1 * found.own);
    EXPECT_GT(found.smallest, 0.7);
    EXPECT_LT(found.largest, 1.4);
    EXPECT_GT(found.reflected_p, 5e-4);
    EXPECT_LT(found.reflected_p, 1 - 5e-4);
  }
  // Pairs of a block share their noise, so that there is less to average over, and its variance is
  // not linear in R.
  const Repeated found = repeat(PhotonTracking::shared);
  EXPECT_NEAR(found.measured, found.own, 0.25 * found.own);
  EXPECT_GT(found.smallest, 0.5);
  EXPECT_LT(found.largest, 2);
}

TEST(PhotonSimulation, DirectionsDifferByNoiseAlone) {
  const Sample sample = small_sample();
  PhotonSimulation simulation(sample, {.photons = 4096, .tracking = PhotonTracking::importance});
  while (!simulation.is_done()) simulation.advance();
  const PhotonReport report = make_report(simulation);
  EXPECT_GT(report.asymmetry, 0);
  EXPECT_NEAR(report.asymmetry, report.expected_asymmetry, 0.2 * report.expected_asymmetry);
}

// Pairs' means of two runs of 16 rounds: chi-square over all pairs that 50 photons and more have
// met, so that means are about normal.
double compare_runs(const PhotonSums& first, const PhotonSums& second, double photons) {
  constexpr double n = 16;
  double chi = 0, values = 0;
  for (std::size_t i = 0; i < first.forward.size(); ++i) {
    const auto mean = [&](const PhotonSums& sums) {
      return (static_cast<double>(sums.forward[i]) + sums.backward[i]) / 2 / n;
    };
    const auto variance = [&](const PhotonSums& sums) {
      return (sums.squares[i] / n - mean(sums) * mean(sums)) / (n - 1);
    };
    if ((mean(first) + mean(second)) * photons < 50) continue;
    const double difference = mean(first) - mean(second);
    chi += difference * difference / (variance(first) + variance(second));
    values += 1;
  }
  EXPECT_GT(values, 100);
  // A t variable of about 30 degrees has a variance of 30/28.
  return chi_square_tail(chi / (30.0 / 28), values);
}

// However work is spent, pairs have the means of analogue tracing; also where blocks are not whole,
// a pixel has several voxels, the sample has a thickness and scattering a direction.
TEST(PhotonSimulation, TrackingDoesNotChangeTheTable) {
  Document stones = small_description();
  set(stones, "size", array({11, 5}));
  set(stones, "layout", object({{"kind", "stones"}, {"size_mm", 1.5}}));
  set(stones, "depth",
      object({{"solid", true}, {"thickness_mm", 2}, {"voxels_per_pixel", 2}, {"margin_px", 1}}));
  set(stones, "materials",
      array({object({{"name", "light"}, {"sigma_a", 0.02}, {"sigma_s_prime", 2.0}, {"g", 0.5}}),
             object({{"name", "dark"}, {"sigma_a", 0.3}, {"sigma_s_prime", 1.0}, {"g", 0.5}})}));
  constexpr std::uint64_t photons = 3200;  // 16 rounds
  for (const Document& description : {small_description(), stones}) {
    const Sample sample = small_sample(description);
    const auto trace = [&](PhotonTracking tracking, std::uint64_t seed) {
      return run(sample, {.photons = photons, .tracking = tracking, .photon_seed = seed}).sums[0];
    };
    const PhotonSums plain = trace(PhotonTracking::analogue, 9);
    EXPECT_GT(compare_runs(plain, trace(PhotonTracking::importance, 1), photons), least_p(4));
    EXPECT_GT(compare_runs(plain, trace(PhotonTracking::shared, 1), photons), least_p(4));
  }
}

TEST(PhotonSimulation, UntilStopsAtTheError) {
  const Sample sample = small_sample();
  PhotonSimulation simulation(sample, {.photons = 20000, .until = 0.3});
  double before = 0;
  while (!simulation.is_done()) {
    simulation.advance();
    EXPECT_GE(simulation.done(), 0);
    before = simulation.done();
  }
  EXPECT_LE(simulation.median_error(), 0.3);
  EXPECT_EQ(simulation.rounds(0), 16u);
  EXPECT_EQ(before, 1);
  const Offset median =
      simulation.header().offsets[static_cast<std::size_t>(median_offset(simulation.header()))];
  EXPECT_EQ(median.dx * median.dx + median.dy * median.dy, 2);
}

TEST(PhotonVolume, ExtrudedSamplesNeedOneLayer) {
  const PhotonVolume volume = make_photon_volume(small_sample());
  EXPECT_EQ(volume.nz, 1);
  EXPECT_EQ(volume.nx, 12);
  EXPECT_EQ(volume.margin, 2);
  EXPECT_FLOAT_EQ(volume.sigma_s[2 * 12 + 2], 2.f);
}

TEST(PhotonVolume, TiltedLayersMoveWithDepth) {
  Document document = small_description();
  set(document, "layout",
      object({{"kind", "layers"},
              {"thickness_mm", 1},
              {"angle_deg", 90},
              {"waviness_mm", 0},
              {"irregularity", 0},
              {"softness_mm", 0}}));
  set(document, "depth", object({{"thickness_mm", 2}, {"tilt_deg", 45}}));
  const PhotonVolume volume = make_photon_volume(small_sample(document));
  ASSERT_EQ(volume.nz, 4);
  // 45 degrees: one voxel down is one voxel to the side.
  const auto at = [&](int x, int z) {
    return volume.sigma_s[static_cast<std::size_t>((z * volume.ny) * volume.nx + x)];
  };
  bool changes = false;
  for (int z = 1; z < 4; ++z)
    for (int x = z; x < volume.nx; ++x) {
      EXPECT_FLOAT_EQ(at(x, z), at(x - z, 0));
      changes = changes || at(x, z) != at(x, 0);
    }
  EXPECT_TRUE(changes);
}

TEST(PhotonVolume, AnisotropyKeepsTheReducedCoefficient) {
  Document document = small_description();
  set(document, "materials",
      array({object({{"name", "light"}, {"sigma_a", 0.01}, {"sigma_s_prime", 2.0}, {"g", 0.8}}),
             object({{"name", "dark"}, {"sigma_a", 0.2}, {"sigma_s_prime", 1.0}})}));
  set(document, "layout", object({{"kind", "mixing"}, {"wavelength_mm", 2}}));
  const Sample sample = small_sample(document);
  const PhotonVolume volume = make_photon_volume(sample);
  const PhotonVolume reduced = reduce_by_similarity(volume);
  ASSERT_FALSE(volume.g.empty());
  EXPECT_TRUE(reduced.g.empty());
  const auto margin = static_cast<std::size_t>(volume.margin);
  for (std::size_t y = 0; y < 6; ++y)
    for (std::size_t x = 0; x < 8; ++x) {
      const std::size_t i = (y + margin) * static_cast<std::size_t>(volume.nx) + x + margin;
      // The plane's weights are means over 4 x 4 points, the volume's too where one layer is
      // enough.
      EXPECT_NEAR(reduced.sigma_s[i], sample.sigma_s_prime[y * 8 + x], 1e-4);
      EXPECT_LE(volume.sigma_s[i], 10.001f);
    }
}

TEST(PhotonVolume, PathsAreSharedWhereThatIsWorthIt) {
  PhotonVolume volume = make_photon_volume(small_sample());
  EXPECT_TRUE(can_share(volume, 0));
  volume.g.assign(volume.voxels(), 0.5f);
  EXPECT_TRUE(can_share(volume, 0));
  volume.g[3] = 0.4f;
  EXPECT_FALSE(can_share(volume, 0));
  volume.g.clear();
  volume.sigma_a[3] = 20;  // a wall
  EXPECT_FALSE(can_share(volume, 0));
}

TEST(PhotonVolume, SolidStonesAreBoundedBelow) {
  Document document = small_description();
  set(document, "layout", object({{"kind", "stones"}, {"size_mm", 1.5}, {"gap_mm", 0}}));
  set(document, "depth", object({{"solid", true}, {"thickness_mm", 4}, {"margin_px", 1}}));
  const PhotonVolume volume = make_photon_volume(small_sample(document));
  EXPECT_EQ(volume.nz, 8);
  // Columns see both materials: stones have ends.
  const int columns = volume.nx * volume.ny;
  int mixed = 0;
  for (int i = 0; i < columns; ++i) {
    bool stone = false, matrix = false;
    for (int z = 0; z < volume.nz; ++z) {
      const float s = volume.sigma_s[static_cast<std::size_t>(z * columns + i)];
      stone = stone || s < 1.01f;
      matrix = matrix || s > 1.99f;
    }
    mixed += stone && matrix ? 1 : 0;
  }
  EXPECT_GT(mixed, columns / 4);
}

TEST(PhotonVolume, Errors) {
  Document document = small_description();
  set(document, "layout", object({{"kind", "stones"}}));
  set(document, "depth",
      object({{"solid", true}, {"grid_mm", 1000}, {"voxels_per_pixel", 16}, {"margin_px", 1024}}));
  EXPECT_EQ(
      error_of([&] { make_photon_volume(small_sample(document)); }),
      "s.json: /depth: expected at most 134217728 voxels, all channels together, found 32896 x "
      "32864 x 32000 x 1");
  set(document, "depth", object({{"thickness_mm", 2}, {"grid_mm", 3}}));
  EXPECT_EQ(error_of([&] { small_sample(document); }),
            "s.json: /depth/grid_mm: expected no 'grid_mm' beside 'thickness_mm', found both");
  set(document, "depth", object({{"tilt", 2}}));
  EXPECT_EQ(error_of([&] { small_sample(document); }),
            "s.json: /depth/tilt: expected one of the keys 'thickness_mm', 'grid_mm', "
            "'voxels_per_pixel', 'margin_px', 'tilt_deg', 'tilt_direction_deg' or 'solid', found "
            "the unknown key 'tilt'");
  set(document, "depth", object({{"tilt_deg", 90}}));
  EXPECT_EQ(error_of([&] { small_sample(document); }),
            "s.json: /depth/tilt_deg: expected a value in [-85, 85], found 90");
}

}  // namespace
}  // namespace parian

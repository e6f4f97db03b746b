// What a photon simulation has found: the table with its noise model, and the report.
#include <algorithm>
#include <cmath>
#include <limits>

#include "acquire/photon_simulation.h"
#include "acquire/positive_fit_internal.h"
#include "base/check.h"

namespace parian {
namespace {

// One pair's R_d and the variance of that mean, in table units.
struct PairEstimate {
  double value = 0, variance = 0, difference = 0;  // forward - backward
};

class Pairs {
 public:
  Pairs(const PhotonSimulation& simulation, int channel)
      : header_(simulation.header()),
        sums_(simulation.progress().sums[static_cast<std::size_t>(channel)]),
        rounds_(static_cast<double>(simulation.rounds(channel))),
        per_area_(1 / (header_.pixel_pitch_mm * header_.pixel_pitch_mm)) {}

  PairEstimate at(std::size_t offset, std::size_t pixel) const {
    const std::size_t i = offset * header_.pixels() + pixel;
    const double n = std::max(1.0, rounds_);
    const double forward = static_cast<double>(sums_.forward[i]) / n;
    const double backward = static_cast<double>(sums_.backward[i]) / n;
    const double mean = 0.5 * (forward + backward);
    const double scatter = std::max(0.0, static_cast<double>(sums_.squares[i]) / n - mean * mean);
    return {mean * per_area_, scatter / std::max(1.0, n - 1) * per_area_ * per_area_,
            (forward - backward) * per_area_};
  }

  // Calls body(offset, pair) for every pair within the grid.
  template <typename Body>
  void for_each(const Body& body) const {
    for (std::size_t k = 0; k < header_.offsets.size(); ++k) {
      const PixelRange range = pairs_in_grid(header_, header_.offsets[k]);
      for (int y = range.y0; y < range.y1; ++y)
        for (int x = range.x0; x < range.x1; ++x)
          body(k, at(k, static_cast<std::size_t>(y) * static_cast<std::size_t>(header_.width) +
                            static_cast<std::size_t>(x)));
    }
  }

 private:
  const TableHeader& header_;
  const PhotonSums& sums_;
  double rounds_, per_area_;
};

struct NoiseModel {
  double floor = 0, gain = 0;
};

// variance = floor^2 + gain R, fitted to the means over each offset's pairs with relative weights:
// both sides are linear, so means obey the model that pairs obey. A pair that no photon has met is
// known to half a photon at best, which bounds the floor from below.
NoiseModel fit_noise(const PhotonSimulation& simulation, int channel) {
  struct Mean {
    double value = 0, variance = 0, count = 0;
  };
  std::vector<Mean> means(simulation.header().offsets.size());
  Pairs(simulation, channel).for_each([&](std::size_t k, const PairEstimate& pair) {
    means[k].value += pair.value;
    means[k].variance += pair.variance;
    means[k].count += 1;
  });
  std::array<Coefficients<2>, 2> normal{};
  Coefficients<2> right{};
  double scale = 0;
  for (const Mean& mean : means)
    scale = std::max(scale, mean.count > 0 ? mean.value / mean.count : 0);
  for (const Mean& mean : means) {
    if (!(mean.variance > 0)) continue;
    // Values in units of the largest, so that both columns are of one size.
    const double variance = mean.variance / mean.count, value = mean.value / mean.count / scale;
    const Coefficients<2> row{1 / variance, value / variance};
    for (std::size_t a = 0; a < 2; ++a) {
      for (std::size_t b = 0; b < 2; ++b) normal[a][b] += row[a] * row[b];
      right[a] += row[a];
    }
  }
  const Coefficients<2> c = solve_positive(normal, right);
  const double gain = scale > 0 ? c[1] / scale : 0;
  return {std::sqrt(std::max(c[0], 0.5 * gain * gain)), gain};
}

class PhotonSource : public SliceSource {
 public:
  explicit PhotonSource(const PhotonSimulation& simulation)
      : simulation_(simulation), header_(simulation.header()) {
    for (int c = 0; c < header_.channels; ++c) {
      const NoiseModel model = fit_noise(simulation, c);
      header_.noise_floor.push_back(model.floor);
      header_.noise_gain.push_back(model.gain);
    }
  }

  const TableHeader& header() const override { return header_; }
  std::string name() const override { return {}; }

  void read_slice(int channel, int offset_index, float* slice) const override {
    PARIAN_CHECK(channel >= 0 && channel < header_.channels);
    const auto k = static_cast<std::size_t>(offset_index);
    const Pairs pairs(simulation_, channel);
    std::fill_n(slice, header_.pixels(), std::numeric_limits<float>::quiet_NaN());
    const PixelRange range = pairs_in_grid(header_, header_.offsets.at(k));
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const std::size_t i =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(header_.width) +
            static_cast<std::size_t>(x);
        slice[i] = static_cast<float>(pairs.at(k, i).value);
      }
  }

 private:
  const PhotonSimulation& simulation_;
  TableHeader header_;
};

PhotonEstimate estimate(const PhotonRoundTotals& totals, std::size_t i, double rounds) {
  const double n = std::max(1.0, rounds), mean = totals.sum[i] / n;
  const double scatter = std::max(0.0, totals.squares[i] / n - mean * mean);
  return {mean, std::sqrt(scatter / std::max(1.0, n - 1))};
}

}  // namespace

PhotonReport make_report(const PhotonSimulation& simulation) {
  const TableHeader& header = simulation.header();
  PhotonReport report;
  double asymmetry = 0, expected = 0, power = 0;
  for (int c = 0; c < header.channels; ++c) {
    const PhotonRoundTotals& totals = simulation.progress().totals[static_cast<std::size_t>(c)];
    const auto n = static_cast<double>(simulation.rounds(c));
    report.channels.push_back({estimate(totals, 0, n), estimate(totals, 1, n),
                               estimate(totals, 2, n), estimate(totals, 3, n),
                               totals.roulette / std::max(1.0, n), totals.balance});
    report.flights += totals.flights;
    report.photons += n * static_cast<double>(simulation.photons_per_round() * header.pixels());
    Pairs(simulation, c).for_each([&](std::size_t k, const PairEstimate& pair) {
      report.empty_pairs += pair.value == 0 ? 1 : 0;
      power += pair.value * pair.value;
      if (header.offsets[k] == Offset{}) return;
      asymmetry += pair.difference * pair.difference;
      expected += 4 * pair.variance;  // of the difference, as both directions are independent
    });
  }
  report.rounds = simulation.rounds(header.channels - 1);
  const Offset median = header.offsets[static_cast<std::size_t>(median_offset(header))];
  report.median_offset_mm = length_px(median) * header.pixel_pitch_mm;
  report.median_error = simulation.median_error();
  report.asymmetry = power > 0 ? std::sqrt(asymmetry / power) : 0;
  report.expected_asymmetry = power > 0 ? std::sqrt(expected / power) : 0;
  return report;
}

std::unique_ptr<SliceSource> make_photon_source(const PhotonSimulation& simulation) {
  return std::make_unique<PhotonSource>(simulation);
}

}  // namespace parian

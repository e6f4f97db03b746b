// The photon engine: light enters each pixel of a sample in turn, and what leaves is tallied per
// offset. A state that is advanced, so that it can be watched, stopped, stored and taken up again.
//
// R_d(x, y) = power that leaves within pixel y per power sent onto pixel x, over the pixel's area:
// boundary included, sampling area, the mean of both directions. With Lambertian light both
// directions have the same expectation.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "acquire/photon_trace.h"
#include "base/params.h"
#include "material/slices.h"

namespace parian {

// How work is spent. `analogue`: all photons alike, each for the pixel in which it entered.
// `importance`: photons are split on their way out, and those that have gone beyond the table's
// radius play roulette. `shared`: paths count for all pixels of their block of 8 x 8, each by the
// probability that it would have had there (photon_trace.h), and roulette beyond the radius; where
// g differs within a channel or sigma_t by much (can_share), importance instead.
enum class PhotonTracking { shared, importance, analogue };

struct PhotonParams {
  // Per pixel and channel; 0: default_photons, or with `until` as many as that takes.
  std::uint64_t photons = 0;
  // Stop when the mean relative standard error at the median offset is this; 0: never.
  double until = 0;
  PhotonEntry entry = PhotonEntry::lambertian;
  PhotonTracking tracking = PhotonTracking::shared;
  bool similarity = false;  // sigma_s (1 - g), isotropic, instead of sigma_s and g
  std::uint64_t photon_seed = 1;

  static constexpr std::uint64_t default_photons = 16384;
};
ParamList describe(PhotonParams& params);

// Sums over rounds of one channel: [offset][y][x], in units of power per photon.
struct PhotonSums {
  std::vector<float> forward;   // from x to x + d
  std::vector<float> backward;  // from x + d to x
  std::vector<float> squares;   // of a round's mean of both
};

// Totals of one round, to be averaged with their deviation.
struct PhotonRoundTotals {
  std::array<double, 4> sum{};  // specular, reflected, transmitted, absorbed, per power sent
  std::array<double, 4> squares{};
  double roulette = 0;  // what it has added on balance, per power sent
  double balance = 0;   // the largest |1 + roulette - all four| of a round
  double flights = 0;
};

// What a run has gathered: all that has to be stored to take it up again. Steps are taken channel
// by channel, round by round.
struct PhotonProgress {
  std::uint64_t steps = 0;
  std::vector<PhotonSums> sums;           // [channel]
  std::vector<PhotonRoundTotals> totals;  // [channel]
};

class PhotonSimulation {
 public:
  // Throws Error for params out of range.
  PhotonSimulation(const Sample& sample, const PhotonParams& params);

  const TableHeader& header() const { return header_; }  // without noise model
  const PhotonProgress& progress() const { return progress_; }
  // What it depends on: a stored progress fits when this agrees.
  std::uint64_t fingerprint() const { return fingerprint_; }
  // Takes up what another one has gathered. Sizes must fit (check_progress).
  void resume(PhotonProgress progress);

  bool is_done() const;
  // 0 to 1, an estimate where `until` decides.
  double done() const;
  // One channel of one round: about a second of work.
  void advance();

  std::uint64_t photons_per_round() const { return photons_per_round_; }
  std::uint64_t rounds(int channel) const;
  // Mean relative standard error of the pairs at the median offset, over all channels; 1 at most.
  double median_error() const;

 private:
  PhotonTask make_task(int channel) const;
  void add_round(int channel, const std::vector<float>& tally);

  PhotonParams params_;
  std::string name_;
  TableHeader header_;
  std::uint64_t fingerprint_ = 0;
  int radius_ = 1;
  std::uint64_t photons_per_round_ = 1;
  std::uint64_t rounds_wanted_ = 0;  // 0: as `until` says
  PhotonVolume volume_;
  std::vector<PhotonChannel> channels_;
  PhotonProgress progress_;
};

// Throws Error naming `file` when sizes do not fit the simulation.
void check_progress(const PhotonSimulation& simulation, const PhotonProgress& progress,
                    const std::string& file);

// Index into header.offsets of the offset of median length.
int median_offset(const TableHeader& header);

struct PhotonEstimate {
  double value = 0, error = 0;  // and its standard error
};
struct PhotonReport {
  struct Channel {
    PhotonEstimate specular, reflected, transmitted, absorbed;
    double roulette = 0, balance = 0;
  };
  std::vector<Channel> channels;
  double photons = 0;  // sent, all pixels and channels
  double flights = 0;
  std::uint64_t rounds = 0;
  double median_offset_mm = 0, median_error = 0;
  // |R - R^T| / |R|, and what the noise of both directions lets one expect.
  double asymmetry = 0, expected_asymmetry = 0;
  std::uint64_t empty_pairs = 0;  // pairs within the grid that no photon has met
};
PhotonReport make_report(const PhotonSimulation& simulation);

// The table: means of both directions, and the noise model that summarises the pairs' variances.
// Refers to the simulation.
std::unique_ptr<SliceSource> make_photon_source(const PhotonSimulation& simulation);

}  // namespace parian

#include "acquire/photon_simulation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "acquire/provenance.h"
#include "base/check.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "base/random.h"

namespace parian {
namespace {

constexpr std::uint64_t photons_in_round = 1u << 22u;  // about, all pixels and channels
constexpr std::uint64_t least_rounds = 16;             // for the variances
constexpr std::uint64_t engine_version = 1;  // changes when the same seed gives other bits

TableHeader make_header(const Sample& sample, const PhotonParams& params) {
  PhotonParams described = params;
  const std::string provenance = make_provenance(
      "photon", {"parameters", write_params(describe(described))}, sample.description);
  return make_table_header(sample, Boundary::included, Sampling::area, provenance);
}

// The photons that reach the table's radius are few, and those beyond or deep below it rarely come
// back. The numbers are the best of those tried (docs/acquisition.md).
WeightWindow make_window(PhotonTracking tracking, double radius_voxels) {
  const auto reach = static_cast<float>(radius_voxels);
  WeightWindow window;
  if (tracking == PhotonTracking::analogue) return window;
  window.reach = reach;
  window.most = 10;
  window.low = 0.5f;
  window.restored = 1;
  if (tracking == PhotonTracking::shared) return window;
  window.near = 0.09f * reach;
  window.depth_factor = 2;
  window.least = 0.25f;
  window.high = 2;
  return window;
}

// The blocks of up to 8 x 8 pixels in which light enters, and in whose order tallies lie: [block]
// [pixel][window], with room for whole blocks. Where they begin changes from round to round, so
// that no border shows in the noise that their pixels share.
class Blocks {
 public:
  Blocks(const TableHeader& header, std::uint64_t round)
      : width_(header.width),
        height_(header.height),
        shift_x_(static_cast<int>(hash_u64(1, round) % shared_side)),
        shift_y_(static_cast<int>(hash_u64(2, round) % shared_side)),
        across_((width_ + shift_x_ + side - 1) / side) {}

  std::size_t count() const {
    return static_cast<std::size_t>(across_ * ((height_ + shift_y_ + side - 1) / side));
  }
  void place(std::size_t block, PhotonTask& task) const {
    const int column = static_cast<int>(block) % across_, row = static_cast<int>(block) / across_;
    task.x0 = std::max(0, column * side - shift_x_);
    task.y0 = std::max(0, row * side - shift_y_);
    task.columns = std::min(width_, (column + 1) * side - shift_x_) - task.x0;
    task.rows = std::min(height_, (row + 1) * side - shift_y_) - task.y0;
  }
  std::size_t index(int x, int y) const {
    const int block = (y + shift_y_) / side * across_ + (x + shift_x_) / side;
    PhotonTask task;
    place(static_cast<std::size_t>(block), task);
    return static_cast<std::size_t>(block * side * side + (y - task.y0) * task.columns + x -
                                    task.x0);
  }

 private:
  static constexpr int side = static_cast<int>(shared_side);
  int width_, height_, shift_x_, shift_y_, across_;
};

}  // namespace

ParamList describe(PhotonParams& params) {
  return {{.name = "photons",
           .help = fmt::format("for each pixel and channel; 0: {}, or as many as --until takes",
                               PhotonParams::default_photons),
           .target = &params.photons,
           .min = 0,
           .max = 1e12},
          {.name = "until",
           .help = "stop at this mean relative standard error of R_d at the median offset (0: off)",
           .target = &params.until,
           .min = 0,
           .max = 1},
          {.name = "entry",
           .help = "how light arrives: from all sides, or along the normal",
           .target = make_choice(params.entry, {"lambertian", "normal"})},
          {.name = "tracking",
           .help = "paths that count for all pixels near their own; more work for far pairs; or "
                   "all photons alike",
           .target = make_choice(params.tracking, {"shared", "importance", "analogue"})},
          {.name = "similarity",
           .help = "isotropic scattering with sigma_s (1 - g) instead of sigma_s and g",
           .target = &params.similarity},
          {.name = "photon-seed",
           .help = "of the photons' random numbers; --seed is the layout's",
           .target = &params.photon_seed,
           .min = 0,
           .max = 0x1.0p53}};
}

PhotonSimulation::PhotonSimulation(const Sample& sample, const PhotonParams& params)
    : params_(params),
      name_(sample.name),
      header_(make_header(sample, params)),
      radius_(static_cast<int>(sample.radius_px)),
      volume_(make_photon_volume(sample)) {
  PhotonParams checked = params;
  check(describe(checked));
  if (params.similarity) volume_ = reduce_by_similarity(std::move(volume_));
  const std::uint64_t places = header_.pixels() * static_cast<std::uint64_t>(header_.channels);
  photons_per_round_ = std::max<std::uint64_t>(1, photons_in_round / places);
  std::uint64_t wanted = params.photons;
  if (wanted == 0 && params.until == 0) wanted = PhotonParams::default_photons;
  if (wanted > 0) {
    photons_per_round_ = std::clamp<std::uint64_t>(wanted / least_rounds, 1, photons_per_round_);
    rounds_wanted_ = std::max(least_rounds, (wanted + photons_per_round_ - 1) / photons_per_round_);
  }
  for (int c = 0; c < header_.channels; ++c)
    channels_.push_back(params.tracking == PhotonTracking::shared && can_share(volume_, c)
                            ? make_shared_channel(volume_, c)
                            : make_photon_channel(volume_, c));
  const std::size_t values = header_.offsets.size() * header_.pixels();
  progress_.sums.resize(channels_.size());
  progress_.totals.resize(channels_.size());
  for (PhotonSums& sums : progress_.sums) {
    sums.forward.assign(values, 0.f);
    sums.backward.assign(values, 0.f);
    sums.squares.assign(values, 0.f);
  }
  std::uint64_t hash =
      hash_bytes(header_.provenance.data(), header_.provenance.size(), engine_version);
  for (const std::vector<float>* plane : {&volume_.sigma_a, &volume_.sigma_s, &volume_.g})
    hash = hash_values(*plane, hash);
  fingerprint_ = hash_value(photons_per_round_, hash);
}

void PhotonSimulation::resume(PhotonProgress progress) {
  check_progress(*this, progress, name_);
  progress_ = std::move(progress);
}

std::uint64_t PhotonSimulation::rounds(int channel) const {
  const auto channels = static_cast<std::uint64_t>(header_.channels);
  return (progress_.steps + channels - 1 - static_cast<std::uint64_t>(channel)) / channels;
}

bool PhotonSimulation::is_done() const {
  if (progress_.steps % static_cast<std::uint64_t>(header_.channels) != 0) return false;
  const std::uint64_t done = rounds(0);
  if (rounds_wanted_ > 0 && done >= rounds_wanted_) return true;
  return params_.until > 0 && done >= least_rounds && median_error() <= params_.until;
}

double PhotonSimulation::done() const {
  double part = 0;
  if (rounds_wanted_ > 0)
    part = static_cast<double>(progress_.steps) /
           static_cast<double>(rounds_wanted_ * static_cast<std::uint64_t>(header_.channels));
  if (params_.until > 0 && rounds(header_.channels - 1) >= 2) {
    const double ratio = params_.until / median_error();  // error falls as 1 / sqrt(photons)
    part = std::max(part, ratio * ratio);
  }
  return std::min(part, 1.0);
}

PhotonTask PhotonSimulation::make_task(int channel) const {
  PhotonTask task;
  task.volume = &volume_;
  task.channel = &channels_[static_cast<std::size_t>(channel)];
  task.entry = params_.entry;
  task.shared = !task.channel->log_events.empty();
  const bool falls_back = params_.tracking == PhotonTracking::shared && !task.shared;
  task.window = make_window(falls_back ? PhotonTracking::importance : params_.tracking,
                            (radius_ + 0.5) * volume_.voxels_per_pixel);
  task.radius = radius_;
  task.key = hash_u64(hash_u64(params_.photon_seed), static_cast<std::uint64_t>(channel));
  task.photons = photons_per_round_;
  task.first_photon = rounds(channel) * photons_per_round_;
  return task;
}

void PhotonSimulation::advance() {
  const int channel =
      static_cast<int>(progress_.steps % static_cast<std::uint64_t>(header_.channels));
  const PhotonTask task = make_task(channel);
  const auto side = static_cast<std::size_t>(2 * radius_ + 1);
  const Blocks blocks(header_, rounds(channel));
  const std::size_t block_values = shared_side * shared_side * side * side;
  std::vector<float> tally(blocks.count() * block_values, 0.f);
  std::vector<PhotonTotals> totals(blocks.count());
  parallel_for(blocks.count(), [&](std::size_t block) {
    PhotonTask part = task;
    blocks.place(block, part);
    totals[block] = trace_photons(part, tally.data() + block * block_values);
  });
  PhotonTotals sum;
  for (const PhotonTotals& part : totals) sum += part;
  PhotonRoundTotals& kept = progress_.totals[static_cast<std::size_t>(channel)];
  const std::array<double, 4> parts{sum.specular, sum.reflected, sum.transmitted, sum.absorbed};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double part = parts[i] / sum.launched;
    kept.sum[i] += part;
    kept.squares[i] += part * part;
  }
  kept.roulette += sum.roulette / sum.launched;
  kept.balance = std::max(kept.balance, std::abs(balance(sum)) / sum.launched);
  kept.flights += sum.flights;
  add_round(channel, tally);
  ++progress_.steps;
}

// Both directions of each pair, from the tallies of its two pixels.
void PhotonSimulation::add_round(int channel, const std::vector<float>& tally) {
  PhotonSums& sums = progress_.sums[static_cast<std::size_t>(channel)];
  const auto pixel = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(header_.width) +
           static_cast<std::size_t>(x);
  };
  const Blocks blocks(header_, rounds(channel));
  std::vector<std::size_t> place(header_.pixels());
  for (int y = 0; y < header_.height; ++y)
    for (int x = 0; x < header_.width; ++x) place[pixel(x, y)] = blocks.index(x, y);
  const auto side = static_cast<std::size_t>(2 * radius_ + 1);
  const float scale = 1 / static_cast<float>(photons_per_round_);
  parallel_for(header_.offsets.size(), [&](std::size_t k) {
    const Offset d = header_.offsets[k];
    const auto slot = [&](int dx, int dy) {
      return static_cast<std::size_t>(dy + radius_) * side + static_cast<std::size_t>(dx + radius_);
    };
    const std::size_t there = slot(d.dx, d.dy), back = slot(-d.dx, -d.dy);
    const PixelRange range = pairs_in_grid(header_, d);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const std::size_t from = place[pixel(x, y)];
        const std::size_t to = place[pixel(x + d.dx, y + d.dy)];
        const float forward = scale * tally[from * side * side + there];
        const float backward = scale * tally[to * side * side + back];
        const float mean = 0.5f * (forward + backward);
        const std::size_t i = k * header_.pixels() + pixel(x, y);
        sums.forward[i] += forward;
        sums.backward[i] += backward;
        sums.squares[i] += mean * mean;
      }
  });
}

double PhotonSimulation::median_error() const {
  const auto k = static_cast<std::size_t>(median_offset(header_));
  const PixelRange range = pairs_in_grid(header_, header_.offsets[k]);
  double sum = 0, count = 0;
  for (int c = 0; c < header_.channels; ++c) {
    const PhotonSums& sums = progress_.sums[static_cast<std::size_t>(c)];
    const auto n = static_cast<double>(rounds(c));
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const std::size_t i =
            k * header_.pixels() +
            static_cast<std::size_t>(y) * static_cast<std::size_t>(header_.width) +
            static_cast<std::size_t>(x);
        const double mean =
            0.5 * (static_cast<double>(sums.forward[i]) + static_cast<double>(sums.backward[i])) /
            n;
        const double square = static_cast<double>(sums.squares[i]) / n;
        const double variance = std::max(0.0, square - mean * mean) / std::max(1.0, n - 1);
        sum += mean > 0 ? std::min(1.0, std::sqrt(variance) / mean) : 1.0;
        count += 1;
      }
  }
  return count > 0 ? sum / count : 1.0;
}

int median_offset(const TableHeader& header) {
  std::vector<int> order;
  for (std::size_t k = 0; k < header.offsets.size(); ++k)
    if (header.offsets[k] != Offset{} || header.offsets.size() == 1)
      order.push_back(static_cast<int>(k));
  const auto middle = order.begin() + static_cast<std::ptrdiff_t>(order.size() / 2);
  const auto length2 = [&](int k) {
    const Offset d = header.offsets[static_cast<std::size_t>(k)];
    return d.dx * d.dx + d.dy * d.dy;
  };
  std::nth_element(order.begin(), middle, order.end(), [&](int a, int b) {
    return length2(a) != length2(b) ? length2(a) < length2(b) : a < b;
  });
  return *middle;
}

void check_progress(const PhotonSimulation& simulation, const PhotonProgress& progress,
                    const std::string& file) {
  const TableHeader& header = simulation.header();
  const auto channels = static_cast<std::size_t>(header.channels);
  const std::size_t values = header.offsets.size() * header.pixels();
  const auto expect = [&](const char* what, std::size_t expected, std::size_t found) {
    if (expected != found)
      throw Error({file, what, fmt::format("{}", expected), fmt::format("{}", found)});
  };
  expect("channels", channels, progress.sums.size());
  expect("channels of totals", channels, progress.totals.size());
  for (const PhotonSums& sums : progress.sums)
    for (const std::vector<float>* plane : {&sums.forward, &sums.backward, &sums.squares})
      expect("values of a channel", values, plane->size());
}

}  // namespace parian

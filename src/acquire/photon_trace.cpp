#include "acquire/photon_trace.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "base/random.h"
#include "math/fast_math.h"

namespace parian {
namespace {

constexpr int flights_per_look = 8;
constexpr float most_parts = 16;  // into which one photon is split at once
// Flights that are kept of each path. What is longer counts for its own pixel alone; length does
// not depend on where a path is, so nothing is lost or counted twice.
constexpr std::size_t trail_rows = 256;

// A part of a photon that waits for a lane.
struct WaitingPhoton {
  float x, y, z, ux, uy, uz, weight;
  std::uint32_t a, b, c, counter;
  std::uint32_t pixel;
  float entry_x, entry_y;
};

void copy_lane(const PhotonLanes& from, std::size_t i, PhotonLanes& to, std::size_t j) {
  to.x[j] = from.x[i], to.y[j] = from.y[i], to.z[j] = from.z[i];
  to.ux[j] = from.ux[i], to.uy[j] = from.uy[i], to.uz[j] = from.uz[i];
  to.weight[j] = from.weight[i], to.absorbed[j] = from.absorbed[i];
  to.a[j] = from.a[i], to.b[j] = from.b[i], to.c[j] = from.c[i], to.counter[j] = from.counter[i];
  to.state[j] = from.state[i], to.pixel[j] = from.pixel[i];
  to.entry_x[j] = from.entry_x[i], to.entry_y[j] = from.entry_y[i];
  to.shift_x[j] = from.shift_x[i], to.shift_y[j] = from.shift_y[i];
  to.target[j] = from.target[i], to.attention[j] = from.attention[i];
}

class Tracer {
 public:
  Tracer(const PhotonTask& task, float* tally) : task_(task), tally_(tally) {
    if (!task.shared) return;
    PARIAN_CHECK_LE(task.columns, static_cast<int>(shared_side));
    PARIAN_CHECK_LE(task.rows, static_cast<int>(shared_side));
    PARIAN_CHECK(!task.channel->log_events.empty());
    trail_.assign(trail_rows * PhotonLanes::count, -1);
  }

  PhotonTotals run() {
    for (active_ = 0; active_ < PhotonLanes::count && fill(active_);) ++active_;
    while (active_ > 0) {
      for (std::size_t i = active_; i % 16 != 0; ++i)
        lanes_.state[i] = static_cast<std::uint32_t>(PhotonState::empty);
      fly();
      mark_lanes(&lanes_, &task_.window, active_);
      for (std::size_t i = 0; i < active_;) i = look_at(i);
    }
    return totals_;
  }

 private:
  void fly() {
    const PhotonMedium& medium = task_.channel->medium;
    if (task_.shared) {
      const auto kernel = medium.g == nullptr ? record_isotropic : record_anisotropic;
      kernel(&lanes_, &medium, active_, flights_per_look, trail_.data(), trail_rows,
             clock_ % trail_rows);
    } else {
      const auto kernel = medium.g == nullptr ? fly_isotropic : fly_anisotropic;
      kernel(&lanes_, &medium, active_, flights_per_look);
    }
    clock_ += flights_per_look;
    totals_.flights += static_cast<double>(active_) * flights_per_look;
  }

  // Handles lane i where it needs that; returns the next lane to look at.
  std::size_t look_at(std::size_t i) {
    if (lanes_.attention[i] == 0) return i + 1;
    const auto state = static_cast<PhotonState>(lanes_.state[i]);
    if (state == PhotonState::flying) {
      if (lanes_.weight[i] > lanes_.target[i]) {
        split(i);
        return i + 1;
      }
      if (survive(i)) return i + 1;
    }
    if (state == PhotonState::left_top) add_exit(i);
    if (state == PhotonState::left_bottom) totals_.transmitted += lanes_.weight[i];
    if (state == PhotonState::absorbed) totals_.absorbed += lanes_.weight[i];
    totals_.absorbed += lanes_.absorbed[i];
    if (fill(i)) return i + 1;
    --active_;
    if (i != active_) move_last_to(i);
    return i;
  }

  void move_last_to(std::size_t i) {
    copy_lane(lanes_, active_, lanes_, i);
    launched_at_[i] = launched_at_[active_];
    if (!task_.shared) return;
    for (std::size_t row = 0; row < trail_rows; ++row)
      trail_[row * PhotonLanes::count + i] = trail_[row * PhotonLanes::count + active_];
  }

  void add_exit(std::size_t i) {
    const double weight = lanes_.weight[i];
    totals_.reflected += weight;
    const PhotonVolume& volume = *task_.volume;
    const auto pixel_of = [&](float voxels) {
      return static_cast<int>(std::floor((voxels - static_cast<float>(volume.margin)) /
                                         static_cast<float>(volume.voxels_per_pixel)));
    };
    const int x = pixel_of(std::clamp(lanes_.x[i], -1e6f, 1e6f));
    const int y = pixel_of(std::clamp(lanes_.y[i], -1e6f, 1e6f));
    const int from_x = static_cast<int>(lanes_.pixel[i]) % volume.width;
    const int from_y = static_cast<int>(lanes_.pixel[i]) / volume.width;
    const int dx = x - from_x, dy = y - from_y;
    if (std::abs(dx) > task_.radius || std::abs(dy) > task_.radius) return;
    const std::size_t flights = clock_ - launched_at_[i];
    if (task_.shared && flights <= trail_rows)
      share(i, flights, dx, dy);
    else
      add(from_x, from_y, dx, dy, lanes_.weight[i]);
  }

  void add(int from_x, int from_y, int dx, int dy, float weight) {
    const PhotonVolume& volume = *task_.volume;
    const int x = from_x + dx, y = from_y + dy;
    if (x < 0 || y < 0 || x >= volume.width || y >= volume.height) return;
    const int radius = task_.radius, side = 2 * radius + 1;
    const auto row =
        static_cast<std::size_t>((from_y - task_.y0) * task_.columns + from_x - task_.x0);
    const auto slot = static_cast<std::size_t>((dy + radius) * side + dx + radius);
    tally_[row * static_cast<std::size_t>(side * side) + slot] += weight;
  }

  // The path from all pixels of the task: p(shifted) / sum of p, p the product over its flights of
  // the probabilities that they end as they did.
  void share(std::size_t i, std::size_t flights, int dx, int dy) {
    constexpr std::size_t side = shared_side;
    const PhotonMedium& medium = task_.channel->medium;
    std::array<float, side * side> logs{}, parts;
    const auto pixel = static_cast<std::size_t>(task_.volume->voxels_per_pixel);
    add_trail(task_.channel->log_events.data(), trail_.data() + i, trail_rows,
              launched_at_[i] % trail_rows, flights, pixel,
              static_cast<std::size_t>(medium.nx + 2 * medium.pad), logs.data());
    const auto columns = static_cast<std::size_t>(task_.columns);
    const auto rows = static_cast<std::size_t>(task_.rows);
    float largest = -1e30f, sum = 0;
    for (std::size_t y = 0; y < rows; ++y)
      for (std::size_t x = 0; x < columns; ++x) largest = std::max(largest, logs[y * side + x]);
    for (float& log : logs) log -= largest;
    exp_array(logs.data(), parts.data(), parts.size());
    for (std::size_t y = 0; y < rows; ++y)
      for (std::size_t x = 0; x < columns; ++x) sum += parts[y * side + x];
    const float scale = lanes_.weight[i] / sum;
    for (std::size_t y = 0; y < rows; ++y)
      for (std::size_t x = 0; x < columns; ++x)
        add(task_.x0 + static_cast<int>(x), task_.y0 + static_cast<int>(y), dx, dy,
            scale * parts[y * side + x]);
  }

  // Russian roulette: with probability p the photon goes on with 1 / p of its weight.
  bool survive(std::size_t i) {
    const float restored = task_.window.restored * lanes_.target[i];
    const float before = lanes_.weight[i];
    const float u =
        to_open_uniform(sample_sfc32(lanes_.a[i], lanes_.b[i], lanes_.c[i], lanes_.counter[i]));
    const bool survives = u * restored < before;
    const float after = survives ? restored : 0.0f;
    totals_.roulette += static_cast<double>(after) - static_cast<double>(before);
    lanes_.weight[i] = after;
    return survives;
  }

  // n photons of 1/n of the weight; all but the first wait for lanes, with generators of their own.
  void split(std::size_t i) {
    const float n = std::min(most_parts, std::floor(lanes_.weight[i] / lanes_.target[i]));
    if (n < 2) return;
    const float before = lanes_.weight[i], part = before / n;
    totals_.roulette +=
        static_cast<double>(part) * static_cast<double>(n) - static_cast<double>(before);
    lanes_.weight[i] = part;
    const auto draw = [&] {
      return sample_sfc32(lanes_.a[i], lanes_.b[i], lanes_.c[i], lanes_.counter[i]);
    };
    for (int k = 1; k < static_cast<int>(n); ++k) {
      const std::uint64_t first = draw(), second = draw();
      const std::uint64_t low = hash_u64((first << 32u) | second, task_.key);
      const std::uint64_t high = hash_u64(low);
      waiting_.push_back({lanes_.x[i], lanes_.y[i], lanes_.z[i], lanes_.ux[i], lanes_.uy[i],
                          lanes_.uz[i], part, static_cast<std::uint32_t>(low),
                          static_cast<std::uint32_t>(low >> 32u), static_cast<std::uint32_t>(high),
                          static_cast<std::uint32_t>(high >> 32u), lanes_.pixel[i],
                          lanes_.entry_x[i], lanes_.entry_y[i]});
    }
  }

  // Puts the next photon into lane i; false when there is none.
  bool fill(std::size_t i) {
    if (!waiting_.empty()) {
      take(waiting_.back(), i);
      waiting_.pop_back();
      return true;
    }
    if (next_fresh_ == fresh_count_ && !launch()) return false;
    copy_lane(fresh_, next_fresh_++, lanes_, i);
    launched_at_[i] = clock_;
    return true;
  }

  void take(const WaitingPhoton& photon, std::size_t i) {
    lanes_.x[i] = photon.x, lanes_.y[i] = photon.y, lanes_.z[i] = photon.z;
    lanes_.ux[i] = photon.ux, lanes_.uy[i] = photon.uy, lanes_.uz[i] = photon.uz;
    lanes_.weight[i] = photon.weight, lanes_.absorbed[i] = 0;
    lanes_.a[i] = photon.a, lanes_.b[i] = photon.b, lanes_.c[i] = photon.c;
    lanes_.counter[i] = photon.counter;
    lanes_.state[i] = 0, lanes_.pixel[i] = photon.pixel;
    lanes_.entry_x[i] = photon.entry_x, lanes_.entry_y[i] = photon.entry_y;
  }

  // The next photons of the task, pixel by pixel.
  bool launch() {
    const std::uint64_t all = task_.pixels() * task_.photons;
    fresh_count_ =
        static_cast<std::size_t>(std::min<std::uint64_t>(all - launched_, PhotonLanes::count));
    next_fresh_ = 0;
    if (fresh_count_ == 0) return false;
    const PhotonVolume& volume = *task_.volume;
    const auto corner = [&](int pixel) {
      return static_cast<float>(volume.margin + pixel * volume.voxels_per_pixel);
    };
    for (std::size_t i = 0; i < fresh_count_; ++i) {
      const std::uint64_t k = launched_ + i;
      const int place = static_cast<int>(k / task_.photons);
      const int column = place % task_.columns, row = place / task_.columns;
      const int x = task_.x0 + column, y = task_.y0 + row, pixel = y * volume.width + x;
      ids_[i] = hash_u64(static_cast<std::uint64_t>(pixel), task_.first_photon + k % task_.photons);
      fresh_.pixel[i] = static_cast<std::uint32_t>(pixel);
      fresh_.entry_x[i] = corner(x);
      fresh_.entry_y[i] = corner(y);
      fresh_.shift_x[i] = column * volume.voxels_per_pixel;
      fresh_.shift_y[i] = row * volume.voxels_per_pixel;
    }
    launch_photons(&fresh_, ids_, task_.key, static_cast<float>(volume.voxels_per_pixel),
                   task_.channel->medium.eta, task_.entry == PhotonEntry::lambertian, fresh_count_);
    for (std::size_t i = 0; i < fresh_count_; ++i)
      totals_.specular += 1 - static_cast<double>(fresh_.weight[i]);
    totals_.launched += static_cast<double>(fresh_count_);
    launched_ += fresh_count_;
    return true;
  }

  const PhotonTask& task_;
  float* tally_;
  PhotonTotals totals_;
  PhotonLanes lanes_{}, fresh_{};
  std::uint64_t ids_[PhotonLanes::count]{};
  std::size_t active_ = 0, next_fresh_ = 0, fresh_count_ = 0;
  std::uint64_t launched_ = 0;
  std::vector<WaitingPhoton> waiting_;
  std::size_t clock_ = 0;  // flights since the beginning
  std::array<std::size_t, PhotonLanes::count> launched_at_{};
  std::vector<std::int32_t> trail_;  // [row][lane], rows in turn
};

}  // namespace

PhotonTotals& operator+=(PhotonTotals& sum, const PhotonTotals& more) {
  sum.launched += more.launched;
  sum.specular += more.specular;
  sum.reflected += more.reflected;
  sum.transmitted += more.transmitted;
  sum.absorbed += more.absorbed;
  sum.roulette += more.roulette;
  sum.flights += more.flights;
  return sum;
}

double balance(const PhotonTotals& totals) {
  return totals.launched + totals.roulette - totals.specular - totals.reflected -
         totals.transmitted - totals.absorbed;
}

PhotonTotals trace_photons(const PhotonTask& task, float* tally) {
  return Tracer(task, tally).run();
}

}  // namespace parian

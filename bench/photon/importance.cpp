// What was measured to choose how work is shared: weight windows, and the reuse of paths at
// neighbouring points of entry.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"
#include "bench/photon/study.h"

namespace parian::photon {
namespace {

constexpr int radius = 8, side = 2 * radius + 1, rounds = 16;
constexpr std::array<int, 4> distances{0, 2, 5, 8};  // pixels

// 1 / (error^2 flights) of the mean of both directions, at offsets along x.
std::array<double, 4> measure_merit(const PhotonVolume& volume, const PhotonChannel& channel,
                                    const WeightWindow& window) {
  const auto pixels = static_cast<std::size_t>(volume.width * volume.height);
  std::vector<std::vector<double>> values(distances.size());
  std::array<std::vector<double>, 4> sum, squares;
  double flights = 0;
  for (std::size_t k = 0; k < 4; ++k) sum[k].resize(pixels), squares[k].resize(pixels);
  for (std::uint64_t round = 0; round < rounds; ++round) {
    std::vector<float> tally(pixels * side * side);
    const auto rows = static_cast<std::size_t>(volume.height);
    std::vector<double> work(rows);
    parallel_for(rows, [&](std::size_t row) {
      PhotonTask task;
      task.volume = &volume, task.channel = &channel, task.window = window;
      task.radius = radius, task.y0 = static_cast<int>(row), task.columns = volume.width;
      task.key = 1, task.photons = 64, task.first_photon = 64 * round;
      work[row] = trace_photons(task, tally.data() + row * task.pixels() * side * side).flights;
    });
    for (const double each : work) flights += each;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < pixels; ++i) {
        const int d = distances[k];
        if (static_cast<int>(i) % volume.width + d >= volume.width) continue;
        const auto slot = [&](std::size_t pixel, int dx) {
          return static_cast<double>(
              tally[pixel * side * side + static_cast<std::size_t>(radius * side + radius + dx)]);
        };
        const double value = (slot(i, d) + slot(i + static_cast<std::size_t>(d), -d)) / 2;
        sum[k][i] += value, squares[k][i] += value * value;
      }
  }
  std::array<double, 4> merit{};
  for (std::size_t k = 0; k < 4; ++k) {
    double variance = 0, mean = 0, count = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      if (static_cast<int>(i) % volume.width + distances[k] >= volume.width) continue;
      const double m = sum[k][i] / rounds;
      mean += m, variance += (squares[k][i] / rounds - m * m) / (rounds - 1), count += 1;
    }
    merit[k] = mean * mean / count / (variance * flights);
  }
  return merit;
}

void write_windows(const Page& page, const PhotonVolume& volume, const PhotonChannel& channel) {
  constexpr float reach = 8.5f, near = 0.09f * reach, off = 1e15f;
  const auto window = [&](float near_at, float least, float most, float depth) {
    return WeightWindow{near_at, reach, depth, least, most, 0.5f, 2, 1};
  };
  const std::array<std::pair<const char*, WeightWindow>, 6> windows{
      {{"all photons alike", {}},
       {"roulette beyond the radius", window(off, 1, 10, 1)},
       {"and splitting to 1/4", window(near, 0.25f, 10, 1)},
       {"and the depth counted twice (used)", window(near, 0.25f, 10, 2)},
       {"splitting to 1/4, depth four times", window(near, 0.25f, 10, 4)},
       {"splitting to 1/16, depth twice", window(near, 0.0625f, 10, 2)}}};
  MarkdownTable table{{"weights", "0 mm", "1 mm", "2.5 mm", "4 mm"}, {}};
  std::array<double, 4> first{};
  for (const auto& [name, each] : windows) {
    const std::array<double, 4> merit = measure_merit(volume, channel, each);
    if (table.rows.empty()) first = merit;
    std::vector<std::string> row{name};
    for (std::size_t k = 0; k < 4; ++k) row.push_back(fmt::format("{:.1f}", merit[k] / first[k]));
    table.rows.push_back(row);
  }
  write_table(page, "windows",
              "1 / (error² · flights) by distance, relative to all photons alike, on the stone's "
              "green channel:",
              table);
}

struct Event {
  double x, y, z;
  bool real;
};

// A path from (x, y) of one photon with collisions, real ones and others, by a majorant that does
// not depend on the place. Empty unless it leaves at 4 to 7 pixels from there.
std::vector<Event> trace_path(const PhotonChannel& channel, double majorant, double x, double y,
                              Rng& rng) {
  const PhotonMedium& m = channel.medium;
  const double start_x = x, start_y = y;
  double z = 0, uz = std::sqrt(1 - sample_uniform(rng) / (m.eta * m.eta));
  double phi = 2 * std::numbers::pi * sample_uniform(rng);
  double ux = std::sqrt(1 - uz * uz) * std::cos(phi), uy = std::sqrt(1 - uz * uz) * std::sin(phi);
  std::vector<Event> path;
  while (path.size() < 2000) {
    const double s = -std::log(1 - sample_uniform(rng)) / majorant;
    if (z + s * uz < 0) {
      const double t = -z / uz;
      x += t * ux, y += t * uy, z = 0;
      const bool inside_cone = 1 - uz * uz < 1 / (static_cast<double>(m.eta) * m.eta);
      if (inside_cone) {
        const double distance = std::hypot(x - start_x, y - start_y);
        if (distance < 4 || distance > 7) return {};
        return path;
      }
      uz = -uz;
      continue;
    }
    x += s * ux, y += s * uy, z += s * uz;
    const auto index = [](double v, int n) {
      return std::clamp(static_cast<int>(std::floor(v)), 0, n - 1);
    };
    const auto voxel =
        static_cast<std::size_t>((index(z, m.nz) * m.ny + index(y, m.ny)) * m.nx + index(x, m.nx));
    const bool real = sample_uniform(rng) * majorant < static_cast<double>(m.voxels[2 * voxel]);
    path.push_back({x, y, z, real});
    if (!real) continue;
    if (sample_uniform(rng) > static_cast<double>(m.voxels[2 * voxel + 1])) return {};
    uz = 2 * sample_uniform(rng) - 1;
    phi = 2 * std::numbers::pi * sample_uniform(rng);
    ux = std::sqrt(1 - uz * uz) * std::cos(phi), uy = std::sqrt(1 - uz * uz) * std::sin(phi);
  }
  return {};
}

// ln of the path's probability when shifted by whole pixels.
double log_probability(const PhotonChannel& channel, double majorant,
                       const std::vector<Event>& path, int shift_x, int shift_y) {
  const PhotonMedium& m = channel.medium;
  double sum = 0;
  for (const Event& event : path) {
    const auto index = [](double v, int n) {
      return std::clamp(static_cast<int>(std::floor(v)), 0, n - 1);
    };
    const auto voxel = static_cast<std::size_t>(
        (index(event.z, m.nz) * m.ny + index(event.y + shift_y, m.ny)) * m.nx +
        index(event.x + shift_x, m.nx));
    const double sigma_t = m.voxels[2 * voxel], albedo = m.voxels[2 * voxel + 1];
    sum += std::log(event.real ? sigma_t * albedo / majorant : 1 - sigma_t / majorant + 1e-12);
  }
  return sum;
}

// The mean of (sum p)^2 / sum p^2 over the 25 shifts of up to two pixels: with how many independent
// paths the shifted copies of one compare, each weighted by its probability (balance heuristic).
std::pair<double, double> measure_shifts(const PhotonVolume& volume, const PhotonChannel& channel) {
  double largest = 0;
  for (std::size_t i = 0; i < channel.voxels.size(); i += 2)
    largest = std::max(largest, static_cast<double>(channel.voxels[i]));
  const double majorant = 1.05 * largest;
  Rng rng = make_rng(8);
  double sum = 0, events = 0, count = 0;
  while (count < 2000) {
    const double x = volume.margin + volume.width * sample_uniform(rng);
    const double y = volume.margin + volume.height * sample_uniform(rng);
    const std::vector<Event> path = trace_path(channel, majorant, x, y, rng);
    if (path.empty()) continue;
    const double own = log_probability(channel, majorant, path, 0, 0);
    double p1 = 0, p2 = 0;
    for (int dy = -2; dy <= 2; ++dy)
      for (int dx = -2; dx <= 2; ++dx) {
        const double p =
            std::exp(std::min(300.0, log_probability(channel, majorant, path, dx, dy) - own));
        p1 += p, p2 += p * p;
      }
    sum += p1 * p1 / p2, events += static_cast<double>(path.size()), count += 1;
  }
  return {sum / count, events / count};
}

}  // namespace

void study_importance(const Page& page) {
  const PhotonVolume stone = make_photon_volume(make_stone(0));
  const PhotonChannel green = make_photon_channel(stone, 1);
  write_windows(page, stone, green);
  MarkdownTable table{{"sample", "collisions", "worth of 25 copies"}, {}};
  const auto add = [&](const char* name, const PhotonVolume& volume, const PhotonChannel& channel) {
    const auto [worth, events] = measure_shifts(volume, channel);
    table.rows.push_back({name, fmt::format("{:.0f}", events), fmt::format("{:.1f}", worth)});
  };
  add("the stone", stone, green);
  PhotonVolume soft = stone;
  for (std::vector<float>* plane : {&soft.sigma_a, &soft.sigma_s}) {
    double mean = 0;
    const std::size_t first = stone.voxels();
    for (std::size_t i = 0; i < first; ++i)
      mean += (*plane)[first + i] / static_cast<double>(first);
    for (std::size_t i = 0; i < first; ++i)
      (*plane)[first + i] = static_cast<float>(mean + 0.1 * ((*plane)[first + i] - mean));
  }
  add("a tenth of its contrast", soft, make_photon_channel(soft, 1));
  write_table(page, "shifts",
              "Paths that leave 2 to 3.5 mm from where they entered, shifted by up to two pixels "
              "each way and weighted with their probabilities there: the number of independent "
              "paths that the 25 copies of one are worth.",
              table);
}

}  // namespace parian::photon

// How long it takes to know R_d to a given error: all photons alike, and with the job's structure.
#include <fmt/format.h>

#include <cmath>

#include "base/parallel.h"
#include "bench/photon/study.h"

namespace parian::photon {
namespace {

// Seconds to a relative error, which falls as one over the root of the time.
double seconds_to(double error, double measured, double seconds) {
  return seconds * (measured / error) * (measured / error);
}

struct Row {
  std::string name;
  double error = 0, seconds = 0;
};

MarkdownTable tabulate(const std::vector<Row>& rows) {
  MarkdownTable table{{"method", "measured error", "after", "to 15 %", "to 5 %", "sooner"}, {}};
  const double first = seconds_to(0.05, rows[0].error, rows[0].seconds);
  for (const Row& row : rows) {
    const double five = seconds_to(0.05, row.error, row.seconds);
    table.rows.push_back({row.name, fmt::format("{:.1f} %", 100 * row.error),
                          fmt::format("{:.1f} s", row.seconds),
                          fmt::format("{:.1f} s", seconds_to(0.15, row.error, row.seconds)),
                          fmt::format("{:.0f} s", five), fmt::format("{:.1f} ×", first / five)});
  }
  return table;
}

}  // namespace

void study_time(const Page& page) {
  const Sample stone = make_stone(0);
  const Run analogue = run_photons(stone, {.photons = 12288, .tracking = PhotonTracking::analogue});
  const Run importance =
      run_photons(stone, {.photons = 8192, .tracking = PhotonTracking::importance});
  const Run shared = run_photons(stone, {.photons = 8192});
  const double error = analogue.report.median_error;
  write_table(
      page, "time",
      fmt::format("Stone of 32 × 32 pixels of 0.5 mm, radius 8 px, three channels, g = 0, {} "
                  "threads. Mean relative standard error of the pairs at {:.2f} mm, the median "
                  "offset; times to 15 % and 5 % are extrapolated.",
                  thread_count(), importance.report.median_offset_mm),
      tabulate({{"all photons alike, one direction of each pair", std::sqrt(2.0) * error,
                 analogue.seconds},
                {"mean of both directions", error, analogue.seconds},
                {"and importance", importance.report.median_error, importance.seconds},
                {"or shared paths (the default)", shared.report.median_error, shared.seconds}}));
}

namespace {

// Mean of R_d over the pairs and channels of each ring of offsets.
std::vector<double> ring_means(const PhotonSimulation& simulation, double step_mm, std::size_t n) {
  const auto source = make_photon_source(simulation);
  const BssrdfTable table = read_table(*source);
  const TableHeader& header = table.header;
  std::vector<double> sum(n), count(n);
  for (std::size_t k = 0; k < header.offsets.size(); ++k) {
    const auto ring =
        static_cast<std::size_t>(length_px(header.offsets[k]) * header.pixel_pitch_mm / step_mm);
    if (ring >= n) continue;
    for (int c = 0; c < header.channels; ++c) {
      const float* slice = slice_of(table, c, static_cast<int>(k));
      for (std::size_t i = 0; i < header.pixels(); ++i)
        if (!std::isnan(slice[i])) sum[ring] += slice[i], count[ring] += 1;
    }
  }
  for (std::size_t i = 0; i < n; ++i) sum[i] /= count[i];
  return sum;
}

}  // namespace

void study_similarity(const Page& page) {
  const Sample stone = make_stone(0.8);
  const Run analogue = run_photons(stone, {.photons = 1536, .tracking = PhotonTracking::analogue});
  const Run importance =
      run_photons(stone, {.photons = 4096, .tracking = PhotonTracking::importance});
  const Run shared = run_photons(stone, {.photons = 4096});
  const Run similar = run_photons(stone, {.photons = 8192, .similarity = true});
  const double error = analogue.report.median_error;
  write_table(
      page, "similarity-time", "The same stone with g = 0.8 and the same σ_s′:",
      tabulate({{"all photons alike, one direction of each pair", std::sqrt(2.0) * error,
                 analogue.seconds},
                {"mean of both directions", error, analogue.seconds},
                {"and importance", importance.report.median_error, importance.seconds},
                {"or shared paths (the default)", shared.report.median_error, shared.seconds},
                {"and `--similarity` (biased)", similar.report.median_error, similar.seconds}}));
  constexpr std::size_t rings = 8;
  const std::vector<double> own = ring_means(*shared.simulation, 0.5, rings);
  const std::vector<double> reduced = ring_means(*similar.simulation, 0.5, rings);
  MarkdownTable bias{{"distance"}, {{"R_d with σ_s (1 − g), relative to g = 0.8"}}};
  for (std::size_t i = 0; i < rings; ++i) {
    bias.header.push_back(fmt::format("{:.1f}", 0.5 * static_cast<double>(i)));
    bias.rows[0].push_back(fmt::format("{:+.1f} %", 100 * (reduced[i] / own[i] - 1)));
  }
  double totals = 0;
  for (std::size_t c = 0; c < 3; ++c)
    totals +=
        (similar.report.channels[c].reflected.value / shared.report.channels[c].reflected.value -
         1) /
        3;
  write_table(page, "similarity-bias",
              fmt::format("Bias of similarity by distance in mm (rings of 0.5 mm); of the total "
                          "reflectance: {:+.2f} %.",
                          100 * totals),
              bias);
}

}  // namespace parian::photon

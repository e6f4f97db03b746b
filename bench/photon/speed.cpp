// Photons per millisecond in a grid of voxels of many coefficients, between reflecting boundaries.
#include <fmt/format.h>

#include <algorithm>

#include "base/parallel.h"
#include "base/random.h"
#include "base/stopwatch.h"
#include "bench/photon/study.h"

namespace parian::photon {
namespace {

struct Tissue {
  const char* name;
  double sigma_a, sigma_s_prime, g;
};

// 80 x 80 x 40 voxels of 0.25 mm, each with coefficients of its own between half and one and a half
// times the material's; 40 x 40 pixels of 2 x 2 voxels in the middle.
PhotonVolume make_grid(const Tissue& tissue, double eta) {
  PhotonVolume volume;
  volume.nx = volume.ny = 80, volume.nz = 40;
  volume.width = volume.height = 20, volume.voxels_per_pixel = 2, volume.margin = 20;
  volume.voxel_mm = 0.25;
  volume.eta = eta;
  Rng rng = make_rng(4);
  const auto vary = [&] { return 0.5 + sample_uniform(rng); };
  for (std::size_t i = 0; i < volume.voxels(); ++i) {
    volume.sigma_a.push_back(static_cast<float>(tissue.sigma_a * vary()));
    volume.sigma_s.push_back(static_cast<float>(tissue.sigma_s_prime / (1 - tissue.g) * vary()));
    if (tissue.g != 0) volume.g.push_back(static_cast<float>(tissue.g));
  }
  return volume;
}

// All photons alike, light from all sides onto all pixels; the best of three.
std::vector<std::string> measure(const Tissue& tissue) {
  const PhotonVolume volume = make_grid(tissue, 1.5);
  const PhotonChannel channel = make_photon_channel(volume, 0);
  constexpr std::size_t pixels = 400, rows = 20, photons = 1000;
  double best = 1e30, flights = 0;
  for (int repeat = 0; repeat < 3; ++repeat) {
    std::vector<double> found(rows);
    const Stopwatch watch;
    parallel_for(rows, [&](std::size_t row) {
      PhotonTask task;
      task.volume = &volume, task.channel = &channel;
      task.radius = 8, task.y0 = static_cast<int>(row), task.columns = 20;
      task.key = 2, task.photons = photons;
      std::vector<float> tally(task.pixels() * 17 * 17);
      found[row] = trace_photons(task, tally.data()).flights;
    });
    best = std::min(best, watch.seconds());
    flights = 0;
    for (const double each : found) flights += each;
  }
  const double all = pixels * photons;
  return {tissue.name,
          fmt::format("{}", tissue.sigma_a),
          fmt::format("{}", tissue.sigma_s_prime),
          fmt::format("{}", tissue.g),
          fmt::format("{:.0f}", flights / all),
          fmt::format("{:.0f}", all / best / 1000),
          fmt::format("{:.1f}", all / best / 1000 / 35)};
}

}  // namespace

void study_speed(const Page& page) {
  MarkdownTable table{
      {"material", "σ_a [1/mm]", "σ_s′ [1/mm]", "g", "flights per photon", "photons / ms", "/ 35"},
      {}};
  for (const Tissue& tissue :
       {Tissue{"wax", 0.01, 2, 0}, Tissue{"wax", 0.01, 2, 0.8}, Tissue{"skin", 0.05, 1, 0},
        Tissue{"skin", 0.05, 1, 0.8}, Tissue{"skin", 0.05, 1, 0.9}})
    table.rows.push_back(measure(tissue));
  write_table(page, "speed",
              fmt::format("{} threads; 80 × 80 × 40 voxels of 0.25 mm, η = 1.5, every voxel of "
                          "coefficients of its own, all photons alike:",
                          thread_count()),
              table);
}

}  // namespace parian::photon

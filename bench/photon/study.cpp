#include "bench/photon/study.h"

#include <cmath>

#include "base/hash.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "bench/photon/batches.h"

namespace parian::photon {

PhotonVolume make_homogeneous(double sigma_a, double sigma_s, double g, double eta,
                              double thickness_mm) {
  PhotonVolume volume;
  volume.eta = eta;
  volume.thickness_mm = thickness_mm;
  volume.sigma_a = {static_cast<float>(sigma_a)};
  volume.sigma_s = {static_cast<float>(sigma_s)};
  if (g != 0) volume.g = {static_cast<float>(g)};
  return volume;
}

Totals measure_totals(const PhotonVolume& volume, PhotonEntry entry, std::uint64_t photons) {
  constexpr std::size_t batches = 32;
  const PhotonChannel channel = make_photon_channel(volume, 0);
  // Media are measured with photons of their own, so that errors are independent.
  const std::uint64_t key =
      hash_value(volume.thickness_mm, hash_value(volume.eta, hash_values(channel.voxels)));
  std::array<PhotonTotals, batches> found{};
  const Stopwatch watch;
  parallel_for(batches, [&](std::size_t i) {
    PhotonTask task;
    task.volume = &volume, task.channel = &channel, task.entry = entry;
    task.key = key, task.photons = photons / batches, task.first_photon = i * task.photons;
    std::vector<float> tally(9);
    found[i] = trace_photons(task, tally.data());
  });
  Totals totals;
  totals.seconds = watch.seconds();
  const auto share = [](double PhotonTotals::*part) {
    return [part](const PhotonTotals& each) { return each.*part / each.launched; };
  };
  totals.reflected = estimate(found, share(&PhotonTotals::reflected));
  totals.transmitted = estimate(found, share(&PhotonTotals::transmitted));
  for (const PhotonTotals& each : found)
    totals.photons += each.launched, totals.flights += each.flights;
  return totals;
}

Sample make_stone(double g) {
  const auto material = [&](const char* name, Document::Array sigma_a, Document::Array sigma_s) {
    return Document(Document::Object{{"name", name},
                                     {"sigma_a", std::move(sigma_a)},
                                     {"sigma_s_prime", std::move(sigma_s)},
                                     {"g", g}});
  };
  return read_sample(
      Document::Object{
          {"name", "stone"},
          {"materials", Document::Array{material("matrix", {0.02, 0.04, 0.08}, {1.6, 1.8, 2.0}),
                                        material("light", {0.004, 0.006, 0.01}, {2.2, 2.6, 3.0}),
                                        material("dark", {0.15, 0.06, 0.03}, {0.9, 0.9, 0.9})}},
          {"layout", Document::Object{{"kind", "stones"}, {"size_mm", 6}}},
          {"depth", Document::Object{{"solid", true}, {"grid_mm", 8}}},
          {"eta", 1.5},
          {"pitch_mm", 0.5},
          {"size", Document::Array{32, 32}},
          {"radius_px", 8},
          {"seed", 3}},
      {});
}

Run run_photons(const Sample& sample, const PhotonParams& params) {
  Run run;
  run.simulation = std::make_unique<PhotonSimulation>(sample, params);
  const Stopwatch watch;
  while (!run.simulation->is_done()) run.simulation->advance();
  run.seconds = watch.seconds();
  run.report = make_report(*run.simulation);
  return run;
}

}  // namespace parian::photon

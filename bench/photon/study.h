// Studies of the photon engine, for docs/acquisition.md and docs/limits.md: what they share.
#pragma once

#include <array>
#include <string>

#include "acquire/photon_simulation.h"
#include "acquire/photon_trace.h"
#include "bench/common/page.h"
#include "material/bssrdf_table.h"

namespace parian::photon {

// One voxel that goes on without end.
PhotonVolume make_homogeneous(double sigma_a, double sigma_s, double g, double eta,
                              double thickness_mm = 0);

// Reflected and transmitted power of photons that enter one pixel, over batches on all threads.
struct Totals {
  PhotonEstimate reflected, transmitted;
  double photons = 0, seconds = 0, flights = 0;
};
Totals measure_totals(const PhotonVolume& volume, PhotonEntry entry, std::uint64_t photons);

// The 32 x 32 stone of the targets: radius 8 px, pitch 0.5 mm, stones in space, three channels.
Sample make_stone(double g);

// Runs to the end; `seconds` of the tracing.
struct Run {
  std::unique_ptr<PhotonSimulation> simulation;
  PhotonReport report;
  double seconds = 0;
};
Run run_photons(const Sample& sample, const PhotonParams& params);

void study_speed(const Page& page);
void study_totals(const Page& page);
void study_time(const Page& page);
void study_similarity(const Page& page);
void study_importance(const Page& page);
void study_dipole(const Page& page);
void study_pictures(const Page& page);
void study_limits(const Page& page);
void study_thickness(const Page& page);
void study_curvature(const Page& page);

}  // namespace parian::photon

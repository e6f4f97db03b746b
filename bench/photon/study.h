// Studies of the photon engine, for docs/acquisition.md and docs/limits.md: what they share.
#pragma once

#include <array>
#include <string>

#include "acquire/photon_simulation.h"
#include "acquire/photon_trace.h"
#include "bench/common/page.h"
#include "material/bssrdf_table.h"

namespace parian::photon {

struct Study {
  std::string folder, docs;

  Page page(const std::string& name) const { return {name, folder, docs}; }
};

double seconds_now();

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

void study_speed(Study& study);
void study_totals(Study& study);
void study_time(Study& study);
void study_similarity(Study& study);
void study_importance(Study& study);
void study_dipole(Study& study);
void study_pictures(Study& study);
void study_limits(Study& study);
void study_thickness(Study& study);
void study_curvature(Study& study);

}  // namespace parian::photon

// The SubEdit fit (Song et al. 2009, section 4.3) on the reduced system: table -> profile map.
#pragma once

#include <string>
#include <vector>

#include "base/document.h"
#include "base/progress.h"
#include "fit/fit_params.h"
#include "material/profile_map.h"
#include "material/slices.h"

namespace parian {

struct FitChannelReport {
  double energy = 0;             // E of the unconstrained solution
  double energy_monotone = 0;    // E after the monotone projection; equals energy without it
  double relative_residual = 0;  // |b - Hp| / |b| at the end
  int iterations = 0;
  int steps = 0;  // passes over a noisy table; 0 for the plain fit
  bool converged = true;
  std::size_t pairs = 0;    // ordered pairs that entered
  std::size_t missing = 0;  // pairs inside the grid that are not measured (each listed value once)
  std::size_t not_positive = 0;  // values <= 0; only the plain fit leaves them out
  std::size_t held_out = 0;
  std::size_t profiles_touched = 0;  // by the monotone projection
};

struct FitReport {
  std::vector<FitChannelReport> channels;
  double seconds_stream = 0;  // reading, logarithms, right-hand side
  double seconds_solve = 0;   // preconditioner and conjugate gradient
  double seconds_monotone = 0;
  std::size_t pixels_filled = 0;
};

struct FitResult {
  ProfileMap map;
  FitReport report;
};

// Fits channel after channel; reads the table once per channel, or once per step (noise_fit.h) when
// it has a noise model.
// Throws Error for bad parameters, bad data and pixels without a measured pair (unless
// fill_unmeasured). The map's provenance is left to the caller, who knows file names and JSON.
FitResult fit_profiles(const SliceSource& table, const FitParams& params,
                       const Progress& progress = {});

Document to_document(const FitReport& report);

}  // namespace parian

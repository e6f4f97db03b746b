// Parameters of the SubEdit fit.
#pragma once

#include <cstdint>
#include <vector>

#include "base/params.h"

namespace parian {

// How much a pair at distance r counts.
enum class PairWeight {
  uniform,            // 1, the 2009 paper
  inverse_quadratic,  // 1 / (1 + r^2), r in pixels, the 2019 paper
  energy,             // mean of R_d at that offset, relative to its maximum, per channel
  noise,              // none by distance: tables with a noise model only
};

struct FitParams {
  int segments = 0;              // n, equal segments; 0: min(24, radius in pixels)
  double radius_mm = 0;          // r_s; 0: the table's largest offset
  std::vector<double> knots_mm;  // any knots instead of equal segments
  double lambda = 0.01;          // weight of the curvature rows (Eq. 9)
  PairWeight weight = PairWeight::inverse_quadratic;
  bool monotone = true;
  bool noise_model = true;  // use the table's, where it has one
  double spread = 1.5;      // of ln P about the mean profile, where noise hides it
  double tolerance = 1e-5;  // relative residual of the normal equations
  int max_iterations = 200;
  double hold_out = 0;  // fraction of the pairs kept out of the fit
  std::uint64_t seed = 1;
  bool fill_unmeasured = false;  // pixels without a measured pair take the nearest profile
};

ParamList describe(FitParams& params);

}  // namespace parian

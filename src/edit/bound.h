// Energy: albedos lowered so that no illumination makes more light leave than enters.
#pragma once

#include "base/params.h"
#include "base/progress.h"
#include "edit/edit_state.h"

namespace parian {

struct BoundParams {
  double limit = 1;    // of the row sums rho(x) = int R_d(x, y) dA_y
  int iterations = 4;  // gentle steps before the one that is certain
};
ParamList describe(BoundParams& params);

// Bounded integrals 2 pi C of the profiles do not bound the row sums, since a row sums the profiles
// of different pixels (algorithms, section 10). Gentle steps C <- C min(1, limit / rho) come first;
// then C <- C min(1, limit / rho)^2 is certain: every R_d(x, y) has the factor of x at its full
// power and that of y is at most 1. Where the mask is below 1 the step is taken in part, and
// nothing is certain. Returns the largest row sum before. Reads all pairs once for each step.
double bound_energy(const BoundParams& params, EditState& state, const Mask& mask,
                    const Progress& progress = {});

}  // namespace parian

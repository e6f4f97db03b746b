// The fit as the 2009 paper describes it (section 4.3): one row per pair (Eq. 8), rows for the
// curvature (Eq. 9), plain conjugate gradients on the normal equations from zero, one channel at a
// time. Matrix-free, vectorised, on all threads and in single precision: as fast as its arithmetic
// allows, so that the comparison is about the method.
#pragma once

#include <vector>

#include "fit/reduced_system.h"

namespace parian {

struct ReferenceResult {
  std::vector<float> log_profile;  // [k][y][x]
  int iterations = 0;
  double relative_residual = 0;  // |b - Hp| / |b|, recomputed in double precision at the end
};

// n equal segments over the table's radius.
ReferenceResult fit_subedit_2009(const SliceSource& table, int channel, int segments, double lambda,
                                 double tolerance, int max_iterations);

}  // namespace parian

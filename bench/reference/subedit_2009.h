// The fit as the 2009 paper describes it (section 4.3): one row per ordered pair (Eq. 8), rows for
// the curvature (Eq. 9), plain conjugate gradients on the normal equations from zero, one channel
// at a time, in single precision on all threads. Twice, each as fast as it can be made, so that
// the comparison is about the method.
#pragma once

#include <cstddef>
#include <vector>

#include "fit/reduced_system.h"

namespace parian {

struct ReferenceParams {
  int segments = 24;  // n equal segments over the table's radius
  double lambda = 0.01;
  double tolerance = 1e-5;
  int max_iterations = 20'000;
};

struct ReferenceResult {
  std::vector<float> log_profile;  // [k][y][x]
  int iterations = 0;
  double seconds_assembly = 0;  // until the first iteration
  std::size_t matrix_bytes = 0;
};

// "We solve this large but sparse linear system using the conjugate gradient method": rows are
// assembled once into a sparse matrix of four entries per row (32 bytes). A^T A d is one pass over
// the matrix; rows are sorted so that the entries of d that they meet stay in cache.
ReferenceResult fit_subedit_2009_assembled(const SliceSource& table, int channel,
                                           const ReferenceParams& params);

// The same equations, but no matrix: each iteration makes the rows anew from their geometry, many
// at once in vector registers, which takes less time than reading them.
ReferenceResult fit_subedit_2009_on_the_fly(const SliceSource& table, int channel,
                                            const ReferenceParams& params);

// |b - Hp| / |b| of a result in double precision.
double relative_residual(const SliceSource& table, int channel, const ReferenceParams& params,
                         const ReferenceResult& result);

}  // namespace parian

// Preconditioned conjugate gradients on a reduced system, in single precision: on the difference
// from the mean profile, whose own residual is exact. Tolerances below 1e-6 take rounds of
// iterative refinement in double precision.
#pragma once

#include <vector>

#include "base/aligned.h"
#include "base/progress.h"
#include "fit/hessian.h"

namespace parian {

struct SolveParams {
  double tolerance = 1e-5;  // |b - Hp| / |b|
  int max_iterations = 200;
};

// Below this tolerance solve_reduced needs a Hessian with exact products.
inline constexpr double single_precision_tolerance = 1e-6;

struct SolveReport {
  int iterations = 0;
  double relative_residual = 0;  // by the recurrence of the iteration; recomputed when refined
  double energy = 0;
};

// The profile that minimises E when every pixel has the same.
std::vector<double> fit_mean_profile(const ReducedSystem& system);

// The profile for which that quadratic is sum_i weight_i ((sum_k c_k(|d_i|) p_k)^2 - ...) with the
// linear term `right` per knot.
std::vector<double> solve_profile(const ReducedSystem& system, const std::vector<double>& weight,
                                  const std::vector<double>& right);

// What the solve of another channel leaves to the next one: channels resemble each other.
struct SolveStart {
  AlignedVector<float> deviation;  // x = p - profile; empty before the first solve
  AlignedVector<float> product;    // H x; empty when x has not been solved with this H
};

// Improves p in place, starting from its value. `profile` is a profile near p's mean. A `start`
// with a deviation replaces p's value in single precision, scaled to fit best; it takes up the
// solution's.
SolveReport solve_reduced(const ReducedSystem& system, const Hessian& hessian,
                          const Preconditioner& preconditioner, const SolveParams& params,
                          const std::vector<double>& profile, std::vector<double>& p,
                          const Progress& progress = {}, SolveStart* start = nullptr);

}  // namespace parian

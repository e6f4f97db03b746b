// Preconditioned conjugate gradients on a reduced system, in single precision inside an iterative
// refinement in double precision: any tolerance at the price of single-precision products.
#pragma once

#include <vector>

#include "base/progress.h"
#include "fit/hessian.h"

namespace parian {

struct SolveParams {
  double tolerance = 1e-5;  // |b - Hp| / |b|
  int max_iterations = 200;
  bool start_is_constant = false;  // p is the same at all pixels: its product is cheaper
};

struct SolveReport {
  int iterations = 0;
  double relative_residual = 0;
  double energy = 0;
};

// The constant field that minimises E: the same profile at every pixel.
std::vector<double> make_mean_start(const ReducedSystem& system);

// Improves p in place, starting from its value.
SolveReport solve_reduced(const ReducedSystem& system, const Hessian& hessian,
                          const Preconditioner& preconditioner, const SolveParams& params,
                          std::vector<double>& p, const Progress& progress = {});

}  // namespace parian

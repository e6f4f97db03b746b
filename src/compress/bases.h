// The linear step: base profiles for given indices and weights.
#pragma once

#include "compress/mixture.h"

namespace parian {

// Lowers sum_x |p_x - target_x|^2 in the metric + curvature_weight sum of squared second
// differences, by Gauss-Seidel sweeps over the base profiles, each solved exactly but for being
// non-increasing. Never raises it.
void update_bases(const LocalMetric& metric, const AlignedVector<float>& target,
                  double curvature_weight, int sweeps, Mixture& mixture);

// Minimises 1/2 v^T A v - b^T v over non-increasing v, A tridiagonal plus curvature_weight times
// the squared second differences, from the feasible point v: neighbours that would rise are joined
// until none does. Leaves v where that is not lower.
void solve_non_increasing(const double* diagonal, const double* coupling, double curvature_weight,
                          const double* right_hand_side, std::size_t knots, double* v);

}  // namespace parian

// Weights of single pairs, W_d(x) = sum_q u_q(x) u_q(x + d) phi_q(d). Private to fit.
#pragma once

#include <vector>

#include "fit/reduced_system.h"

namespace parian {

// The terms that ReducedParams ask for; phi of energy weights is filled in by the pass.
std::vector<WeightTerm> make_weight_terms(const ReducedSystem& system, const ReducedParams& params);

// Whether weights differ between pairs of one offset.
bool has_pair_weights(const ReducedSystem& system);

// Whether every term gives the pair (pixel, pixel + offset) the weight 0.
bool is_masked(const ReducedSystem& system, Offset offset, std::size_t pixel);

// Weights of the pairs of offset i in row y: 0 outside the grid and, with a slice, where its value
// is NaN or not positive. `slice` may be null.
void fill_pair_weights(const ReducedSystem& system, const TableHeader& header, std::size_t i, int y,
                       const float* slice, float* weight);

}  // namespace parian

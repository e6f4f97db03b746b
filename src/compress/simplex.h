// The point of a simplex nearest to the origin (Wolfe 1976): mixture weights of a pixel.
#pragma once

#include <cstddef>

namespace parian {

inline constexpr std::size_t max_corners = 8;

// Minimises t^T A t over t >= 0, sum t = 1. A [count][max_corners] is the Gram matrix of the
// corners, symmetric and positive semidefinite up to rounding; equal corners are fine.
void nearest_in_simplex(const double (*gram)[max_corners], std::size_t count, double* weights);

// Moves weights that sum to 1 to the nearest multiples of 1 / levels that do (largest remainders;
// ties go to the first).
void round_weights(double* weights, std::size_t count, int levels);

}  // namespace parian

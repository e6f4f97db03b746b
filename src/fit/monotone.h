// Non-increasing profiles with unchanged albedo, as the design demands of every material.
#pragma once

#include <cstddef>
#include <vector>

#include "fit/reduced_system.h"

namespace parian {

// Projects each rising profile, weighting a knot by how many pairs see it (sum of m c_k^2), and
// shifts it so that the sum of P over a pixel's pairs stays: its albedo as the table samples it.
// (The integral of P r dr would count knots that no pair sees.) Returns how many were touched.
std::size_t project_monotone(const ReducedSystem& system, std::vector<double>& p);

}  // namespace parian

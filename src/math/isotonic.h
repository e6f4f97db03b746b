// Least-squares fits under an order.
#pragma once

#include <vector>

namespace parian {

// Least-squares non-increasing fit to `values` with positive `weights` (pool adjacent violators).
// Returns whether anything changed.
bool make_non_increasing(std::vector<double>& values, const std::vector<double>& weights);

}  // namespace parian

// Means over batches of photons, and their standard errors.
#pragma once

#include <algorithm>
#include <cmath>
#include <iterator>

#include "acquire/photon_simulation.h"

namespace parian::photon {

// Of value(batch).
template <typename Batches, typename Value>
PhotonEstimate estimate(const Batches& batches, const Value& value) {
  double sum = 0, squares = 0;
  for (const auto& batch : batches) {
    const double found = value(batch);
    sum += found, squares += found * found;
  }
  const auto n = static_cast<double>(std::size(batches));
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1))};
}

}  // namespace parian::photon

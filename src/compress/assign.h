// The combinatorial step: indices and weights of all pixels for given base profiles, each pixel for
// itself, as the separable bound of local_model.h allows.
//
// Candidates are screened in one metric common to all pixels, where segments between bases cost a
// few operations each, and decided in the pixel's own metric. A pixel's present mixture is among
// the candidates, so the bound never rises.
#pragma once

#include "compress/mixture.h"

namespace parian {

struct AssignParams {
  int weight_levels = 0;  // weights are multiples of 1 / levels; 0: any
  int width = 0;          // of the grid: neighbours' mixtures are candidates
};

// Minimises sum_x |p_x - target_x|^2 in the metric over indices and weights. Returns that sum.
double assign_mixtures(const LocalMetric& metric, const AlignedVector<float>& target,
                       const AssignParams& params, Mixture& mixture);

// Bases near the target's rows to start from: k-means++ on a sample of the pixels and Lloyd steps,
// in the common metric; every pixel takes its nearest base.
Mixture start_mixture(const LocalMetric& metric, const AlignedVector<float>& target,
                      std::size_t bases, std::uint64_t seed);

}  // namespace parian

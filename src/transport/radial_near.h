// The near term of radial_moments.h.
#pragma once

#include <vector>

#include "math/spline_basis.h"
#include "transport/radial_nodes.h"

namespace parian {

// What it does to each basis function; known beforehand, as it depends on the spacing alone.
struct NearTerm {
  float radius_mm = 0;           // 0: none
  float mean_mm = 0;             // the mean irradiance is taken over samples nearer than this
  std::vector<double> integral;  // I_j = 2 pi int B_j w r dr, mm^2
  std::vector<double> trust;     // of the sum over samples, 0 to 1; the rest goes to the mean
  std::vector<double> most;      // I_j / W_j at most, and its inverse at least
};
NearTerm make_near_term(const SplineBasis& basis, double near_mm, double area_mm2);

// Sums over a target's own side.
struct NearSums {
  AlignedVector<Flux> scattered;  // [function] sum of B_j w flux; the fourth is W_j
  Flux mean{};                    // sum of flux by a weight of its own, and of area
};

// 1 up to half the radius, then smoothly down to 0.
inline float near_weight(float r, float radius_mm) {
  const float u = 2 - 2 * r / radius_mm, v = u < 0 ? 0.0f : u < 1 ? u : 1.0f;
  return v * v * (3 - 2 * v);
}
// What function j gets instead of the plain sum of B_j w flux.
Rgb near_value(const NearTerm& term, std::size_t j, const NearSums& sums);

}  // namespace parian

// How far basis functions vary over a range of distances: the certified bound of radial_moments.h.
#pragma once

#include <utility>
#include <vector>

#include "math/spline_basis.h"
#include "math/vec.h"

namespace parian {

// Each function rises to one peak and falls from it.
struct BasisPeaks {
  SplineBasis basis;
  std::vector<double> place, value;
};
BasisPeaks find_peaks(const SplineBasis& basis);

// ranges[j] = max - min of B_j over [from, to]; 0 beyond the last knot, where functions jump.
void find_ranges(const BasisPeaks& peaks, float from, float to, std::vector<double>& ranges);

// Least and greatest distance from a point to a box.
std::pair<float, float> distance_range(Vec3 point, const Bounds3& box);

}  // namespace parian

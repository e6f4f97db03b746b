#include "transport/radial_bound.h"

#include <algorithm>
#include <cmath>

namespace parian {

BasisPeaks find_peaks(const SplineBasis& basis) {
  BasisPeaks peaks{basis, std::vector<double>(basis.size(), basis.knots.front()),
                   std::vector<double>(basis.size(), 0.0)};
  constexpr int steps = 256;  // per interval, whose ends are among them
  for (std::size_t k = 0; k < basis.intervals(); ++k)
    for (int i = 0; i <= steps; ++i) {
      const double x = basis.knots[k] + (basis.knots[k + 1] - basis.knots[k]) * i / steps;
      const SplineValues values = eval_basis(basis, x);
      for (std::size_t b = 0; b <= static_cast<std::size_t>(basis.degree); ++b)
        if (values.value[b] > peaks.value[values.first + b]) {
          peaks.place[values.first + b] = x;
          peaks.value[values.first + b] = values.value[b];
        }
    }
  return peaks;
}

void find_ranges(const BasisPeaks& peaks, float from, float to, std::vector<double>& ranges) {
  const SplineBasis& basis = peaks.basis;
  const double end = basis.knots.back();
  std::fill(ranges.begin(), ranges.end(), 0.0);
  const double a = std::max(0.0, static_cast<double>(from)), b = static_cast<double>(to);
  if (a > end) return;
  std::vector<double> low(basis.size(), 0.0), high(basis.size(), 0.0);
  const auto fill = [&](double x, std::vector<double>& values) {
    const SplineValues at = eval_basis(basis, x);
    for (std::size_t i = 0; i <= static_cast<std::size_t>(basis.degree); ++i)
      values[at.first + i] = at.value[i];
  };
  fill(a, low);
  fill(std::min(b, end), high);
  for (std::size_t j = 0; j < basis.size(); ++j) {
    double most = std::max(low[j], high[j]), least = std::min(low[j], high[j]);
    if (a <= peaks.place[j] && peaks.place[j] <= b) most = peaks.value[j];
    if (b > end) least = 0;
    ranges[j] = most - least;
  }
}

std::pair<float, float> distance_range(Vec3 point, const Bounds3& box) {
  const float at[3] = {point.x, point.y, point.z};
  const float lower[3] = {box.lower.x, box.lower.y, box.lower.z};
  const float upper[3] = {box.upper.x, box.upper.y, box.upper.z};
  float nearest = 0, farthest = 0;
  for (int c = 0; c < 3; ++c) {
    const float outside = std::max({lower[c] - at[c], at[c] - upper[c], 0.0f});
    const float across = std::max(at[c] - lower[c], upper[c] - at[c]);
    nearest += outside * outside;
    farthest += across * across;
  }
  return {std::sqrt(nearest), std::sqrt(farthest)};
}

}  // namespace parian

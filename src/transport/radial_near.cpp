#include "transport/radial_near.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "transport/near_term.h"

namespace parian {
NearTerm make_near_term(const SplineBasis& basis, double near_mm, double area_mm2) {
  NearTerm term;
  term.integral.assign(basis.size(), 0);
  term.trust.assign(basis.size(), 1);
  term.most.assign(basis.size(), 1);
  if (!(near_mm > 0)) return term;
  term.radius_mm = static_cast<float>(near_mm);
  term.mean_mm = static_cast<float>(near_mean_mm(area_mm2));
  std::vector<double> square(basis.size(), 0);
  // Midpoints within each knot interval, so that kinks do no harm.
  constexpr int steps = 64;
  for (std::size_t k = 0; k < basis.intervals(); ++k) {
    const double start = basis.knots[k], end = std::min(basis.knots[k + 1], near_mm);
    if (start >= end) break;
    for (int i = 0; i < steps; ++i) {
      const double r = start + (end - start) * (i + 0.5) / steps,
                   w = static_cast<double>(near_weight(static_cast<float>(r), term.radius_mm));
      const double dA = 2 * std::numbers::pi * r * (end - start) / steps;
      const SplineValues values = eval_basis(basis, r);
      for (std::size_t b = 0; b <= static_cast<std::size_t>(basis.degree); ++b) {
        term.integral[values.first + b] += values.value[b] * w * dA;
        square[values.first + b] += values.value[b] * w * values.value[b] * w * dA;
      }
    }
  }
  for (std::size_t j = 0; j < basis.size(); ++j) {
    if (!(square[j] > 0)) continue;
    // How many samples carry the integral, as near_scale (near_term.h).
    const double n = term.integral[j] * term.integral[j] / (area_mm2 * square[j]);
    term.trust[j] = near_trust(n);
    term.most[j] = 1 + 2 / std::max(n - 1, 0.5);
  }
  return term;
}

Rgb near_value(const NearTerm& term, std::size_t j, const NearSums& sums) {
  const Flux& own = sums.scattered[j];
  const double weight = static_cast<double>(own[3]), area = static_cast<double>(sums.mean[3]);
  double scale = 1;
  if (weight > 0 && term.integral[j] > 0)
    scale = std::clamp(term.integral[j] / weight, 1 / term.most[j], term.most[j]);
  const double by_sum = area > 0 ? term.trust[j] : 1;
  const double by_mean = area > 0 ? (1 - term.trust[j]) * term.integral[j] / area : 0;
  float value[3];
  for (std::size_t c = 0; c < 3; ++c)
    value[c] = static_cast<float>(by_sum * scale * static_cast<double>(own[c]) +
                                  by_mean * static_cast<double>(sums.mean[c]));
  return {value[0], value[1], value[2]};
}

}  // namespace parian

// Piecewise polynomials on non-uniform knots as a basis for curves: hats (degree 1) and quadratic
// B-splines (degree 2), whose m + degree coefficients span what Xu et al. 2007 (section 5) write
// with monomials, without their cancellation. Knots by dynamic programming, coefficients by least
// squares with the equations factored once.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace parian {

// Degree 1: continuous; degree 2: continuous slopes. The functions are >= 0 and sum to 1 on
// [knots.front(), knots.back()]; at most degree + 1 of them are not 0 at any place.
struct SplineBasis {
  int degree = 1;             // 1 or 2
  std::vector<double> knots;  // m + 1 increasing places

  std::size_t intervals() const { return knots.size() - 1; }
  std::size_t size() const { return intervals() + static_cast<std::size_t>(degree); }
};

// The functions that are not 0 at x, clamped to the knots: value[i] of function first + i,
// i <= degree.
struct SplineValues {
  std::size_t first = 0;
  double value[3] = {};
};
SplineValues eval_basis(const SplineBasis& basis, double x);
double eval_spline(const SplineBasis& basis, const std::vector<double>& coefficients, double x);

// int B_j(x) weight(x) dx over each interval by 8 Gauss nodes: exact for polynomial weights up to
// degree 13.
std::vector<double> integrate_basis(const SplineBasis& basis,
                                    const std::function<double(double)>& weight);

// A sampled curve for finding knots: places increase, weights are > 0.
struct SampledCurve {
  std::vector<double> value;
  std::vector<double> weight;
};

// Knots among `places` (both ends among them) whose chords (degree 1: lines through the curves'
// values at the knots) have the least sum of weighted squared errors, over all curves together:
// dynamic programming (Xu et al., section 5), O(intervals places^2).
std::vector<double> find_knots(const std::vector<double>& places,
                               const std::vector<SampledCurve>& curves, int intervals);

// Least squares in the basis: min sum_i w_i (f(x_i) - sum_j c_j B_j(x_i))^2, factored for the given
// places, so that an edit is a back-substitution.
class SplineProjection {
 public:
  // Places lie within the knots, weights are >= 0. Throws Error when they do not determine the
  // coefficients.
  SplineProjection(const SplineBasis& basis, std::vector<double> places,
                   std::vector<double> weights);
  ~SplineProjection();
  SplineProjection(SplineProjection&&) noexcept;
  SplineProjection& operator=(SplineProjection&&) noexcept;

  const std::vector<double>& places() const;
  // From the function's values at the places.
  std::vector<double> fit(const std::vector<double>& values) const;
  std::vector<double> fit(const std::function<double(double)>& function) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// `per_interval` places in each interval, at the middles of its equal parts.
std::vector<double> spread_places(const SplineBasis& basis, int per_interval);

}  // namespace parian

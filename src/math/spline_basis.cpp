#include "math/spline_basis.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"

namespace parian {
namespace {

std::size_t find_interval(const std::vector<double>& knots, double x) {
  const auto upper = std::upper_bound(knots.begin(), knots.end(), x) - knots.begin();
  return static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(upper - 1, 0, std::ssize(knots) - 2));
}

// The knot with the ends repeated: index -1 and m + 1 are the ends again.
double knot_at(const std::vector<double>& knots, std::ptrdiff_t i) {
  return knots[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, std::ssize(knots) - 1))];
}

// Nodes and weights of 8-point Gauss-Legendre quadrature on [-1, 1].
constexpr std::array<double, 4> gauss_node{0.1834346424956498, 0.5255324099163290,
                                           0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> gauss_weight{0.3626837833783620, 0.3137066458778873,
                                             0.2223810344533745, 0.1012285362903763};

}  // namespace

SplineValues eval_basis(const SplineBasis& basis, double x) {
  const auto& knots = basis.knots;
  x = std::clamp(x, knots.front(), knots.back());
  const std::size_t k = find_interval(knots, x);
  const auto i = static_cast<std::ptrdiff_t>(k);
  const double a = knots[k], b = knots[k + 1], t = (x - a) / (b - a);
  SplineValues values;
  values.first = k;
  if (basis.degree == 1) {
    values.value[0] = 1 - t;
    values.value[1] = t;
    return values;
  }
  // Cox and de Boor: the hats of both neighbours' spans, each blended once more.
  const double before = knot_at(knots, i - 1), after = knot_at(knots, i + 2);
  const double left = (b - x) / (b - before), right = (x - a) / (after - a);
  values.value[0] = left * (1 - t);
  values.value[2] = right * t;
  values.value[1] = 1 - values.value[0] - values.value[2];
  return values;
}

double eval_spline(const SplineBasis& basis, const std::vector<double>& coefficients, double x) {
  PARIAN_CHECK_EQ(coefficients.size(), basis.size());
  const SplineValues values = eval_basis(basis, x);
  double sum = 0;
  for (int i = 0; i <= basis.degree; ++i)
    sum += values.value[i] * coefficients[values.first + static_cast<std::size_t>(i)];
  return sum;
}

std::vector<double> integrate_basis(const SplineBasis& basis,
                                    const std::function<double(double)>& weight) {
  std::vector<double> integrals(basis.size(), 0.0);
  const auto add = [&](double x, double w) {
    const SplineValues values = eval_basis(basis, x);
    for (int i = 0; i <= basis.degree; ++i)
      integrals[values.first + static_cast<std::size_t>(i)] += w * weight(x) * values.value[i];
  };
  for (std::size_t k = 0; k < basis.intervals(); ++k) {
    const double half = 0.5 * (basis.knots[k + 1] - basis.knots[k]);
    const double middle = basis.knots[k] + half;
    for (std::size_t n = 0; n < gauss_node.size(); ++n)
      for (double sign : {-1.0, 1.0})
        add(middle + sign * half * gauss_node[n], half * gauss_weight[n]);
  }
  return integrals;
}

namespace {

// Sums from which the squared error of a chord between any two samples follows in O(1).
struct ChordSums {
  std::vector<long double> w, wx, wxx, wf, wxf, wff;
};

ChordSums make_sums(const std::vector<double>& places, const SampledCurve& curve) {
  ChordSums sums;
  for (auto* prefix : {&sums.w, &sums.wx, &sums.wxx, &sums.wf, &sums.wxf, &sums.wff})
    prefix->assign(places.size() + 1, 0.0L);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const long double w = curve.weight[i], x = places[i], f = curve.value[i];
    sums.w[i + 1] = sums.w[i] + w;
    sums.wx[i + 1] = sums.wx[i] + w * x;
    sums.wxx[i + 1] = sums.wxx[i] + w * x * x;
    sums.wf[i + 1] = sums.wf[i] + w * f;
    sums.wxf[i + 1] = sums.wxf[i] + w * x * f;
    sums.wff[i + 1] = sums.wff[i] + w * f * f;
  }
  return sums;
}

// sum over samples i..j of w (f - (p + q x))^2, p + q x the line through both ends.
double chord_error(const std::vector<double>& places, const SampledCurve& curve,
                   const ChordSums& sums, std::size_t i, std::size_t j) {
  const auto range = [&](const std::vector<long double>& prefix) {
    return prefix[j + 1] - prefix[i];
  };
  const long double q = (static_cast<long double>(curve.value[j]) - curve.value[i]) /
                        (static_cast<long double>(places[j]) - places[i]);
  const long double p = curve.value[i] - q * places[i];
  const long double error = range(sums.wff) - 2 * p * range(sums.wf) - 2 * q * range(sums.wxf) +
                            p * p * range(sums.w) + 2 * p * q * range(sums.wx) +
                            q * q * range(sums.wxx);
  return std::max(0.0, static_cast<double>(error));
}

}  // namespace

std::vector<double> find_knots(const std::vector<double>& places,
                               const std::vector<SampledCurve>& curves, int intervals) {
  const std::size_t n = places.size(), m = static_cast<std::size_t>(intervals);
  PARIAN_CHECK(intervals >= 1 && n > m);
  std::vector<ChordSums> sums;
  sums.reserve(curves.size());
  for (const SampledCurve& curve : curves) {
    PARIAN_CHECK_EQ(curve.value.size(), n);
    PARIAN_CHECK_EQ(curve.weight.size(), n);
    sums.push_back(make_sums(places, curve));
  }
  const auto cost = [&](std::size_t i, std::size_t j) {
    double error = 0;
    for (std::size_t c = 0; c < curves.size(); ++c)
      error += chord_error(places, curves[c], sums[c], i, j);
    return error;
  };
  // best[j]: the least error up to sample j with the intervals so far; from[k][j]: where the last
  // of them begins.
  std::vector<double> best(n), next(n);
  std::vector<std::vector<std::size_t>> from(m, std::vector<std::size_t>(n, 0));
  for (std::size_t j = 1; j < n; ++j) best[j] = cost(0, j);
  for (std::size_t k = 1; k < m; ++k) {
    std::fill(next.begin(), next.end(), std::numeric_limits<double>::infinity());
    for (std::size_t j = k + 1; j < n; ++j)
      for (std::size_t i = k; i < j; ++i) {
        const double error = best[i] + cost(i, j);
        if (error < next[j]) {
          next[j] = error;
          from[k][j] = i;
        }
      }
    best.swap(next);
  }
  std::vector<double> knots{places.back()};
  std::size_t j = n - 1;
  for (std::size_t k = m - 1; k > 0; --k) {
    j = from[k][j];
    knots.push_back(places[j]);
  }
  knots.push_back(places.front());
  std::reverse(knots.begin(), knots.end());
  return knots;
}

struct SplineProjection::Impl {
  std::vector<double> places, weights;
  std::vector<SplineValues> values;  // at the places
  std::size_t per_place = 0;
  Eigen::LDLT<Eigen::MatrixXd> factor;  // of B^T W B
};

SplineProjection::SplineProjection(const SplineBasis& basis, std::vector<double> places,
                                   std::vector<double> weights)
    : impl_(std::make_unique<Impl>()) {
  PARIAN_CHECK_EQ(places.size(), weights.size());
  const auto n = static_cast<Eigen::Index>(basis.size());
  impl_->per_place = static_cast<std::size_t>(basis.degree) + 1;
  impl_->values.reserve(places.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t p = 0; p < places.size(); ++p) {
    const SplineValues values = eval_basis(basis, places[p]);
    const auto first = static_cast<Eigen::Index>(values.first);
    for (int i = 0; i <= basis.degree; ++i)
      for (int j = 0; j <= basis.degree; ++j)
        normal(first + i, first + j) += weights[p] * values.value[i] * values.value[j];
    impl_->values.push_back(values);
  }
  impl_->places = std::move(places);
  impl_->weights = std::move(weights);
  impl_->factor.compute(normal);
  const Eigen::VectorXd pivots = impl_->factor.vectorD();
  if (!(pivots.minCoeff() > 1e-13 * pivots.maxCoeff()))
    throw Error({.expected = fmt::format("places that determine all {} coefficients", basis.size()),
                 .found = "too few in some interval"});
}

SplineProjection::~SplineProjection() = default;
SplineProjection::SplineProjection(SplineProjection&&) noexcept = default;
SplineProjection& SplineProjection::operator=(SplineProjection&&) noexcept = default;

const std::vector<double>& SplineProjection::places() const {
  return impl_->places;
}

std::vector<double> SplineProjection::fit(const std::vector<double>& values) const {
  PARIAN_CHECK_EQ(values.size(), impl_->places.size());
  Eigen::VectorXd right = Eigen::VectorXd::Zero(impl_->factor.rows());
  for (std::size_t p = 0; p < values.size(); ++p)
    for (std::size_t i = 0; i < impl_->per_place; ++i)
      right(static_cast<Eigen::Index>(impl_->values[p].first + i)) +=
          impl_->weights[p] * impl_->values[p].value[i] * values[p];
  const Eigen::VectorXd solution = impl_->factor.solve(right);
  return {solution.begin(), solution.end()};
}

std::vector<double> SplineProjection::fit(const std::function<double(double)>& function) const {
  std::vector<double> values;
  values.reserve(impl_->places.size());
  for (double place : impl_->places) values.push_back(function(place));
  return fit(values);
}

std::vector<double> spread_places(const SplineBasis& basis, int per_interval) {
  PARIAN_CHECK_LE(1, per_interval);
  std::vector<double> places;
  places.reserve(basis.intervals() * static_cast<std::size_t>(per_interval));
  for (std::size_t k = 0; k < basis.intervals(); ++k)
    for (int i = 0; i < per_interval; ++i)
      places.push_back(basis.knots[k] +
                       (basis.knots[k + 1] - basis.knots[k]) * ((i + 0.5) / per_interval));
  return places;
}

}  // namespace parian

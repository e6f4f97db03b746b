#include "math/spline_basis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/random.h"
#include "base/test_errors.h"

namespace parian {
namespace {

SplineBasis random_basis(std::uint64_t seed, int degree, int intervals) {
  Rng rng = make_rng(seed);
  SplineBasis basis{degree, {0.3}};
  for (int k = 0; k < intervals; ++k)
    basis.knots.push_back(basis.knots.back() + 0.05 + sample_uniform(rng));
  return basis;
}

TEST(SplineBasis, SumsToOneAndIsNowhereNegative) {
  for (int degree : {1, 2})
    for (int intervals : {1, 2, 7}) {
      const SplineBasis basis = random_basis(1, degree, intervals);
      EXPECT_EQ(basis.size(), static_cast<std::size_t>(intervals + degree));
      for (int i = -5; i <= 205; ++i) {
        const double x = basis.knots.front() + (basis.knots.back() - basis.knots.front()) * i / 200;
        const SplineValues values = eval_basis(basis, x);
        EXPECT_NEAR(values.value[0] + values.value[1] + values.value[2], 1, 1e-14);
        for (double value : values.value) EXPECT_GE(value, -1e-15);
      }
    }
}

TEST(SplineBasis, HasThePromisedSmoothness) {
  const SplineBasis basis = random_basis(2, 2, 6);
  Rng rng = make_rng(3);
  std::vector<double> c(basis.size());
  for (double& value : c) value = sample_normal(rng);
  constexpr double h = 1e-6;
  for (std::size_t k = 1; k + 1 < basis.knots.size(); ++k) {
    const double x = basis.knots[k];
    const double left = (eval_spline(basis, c, x) - eval_spline(basis, c, x - h)) / h;
    const double right = (eval_spline(basis, c, x + h) - eval_spline(basis, c, x)) / h;
    EXPECT_NEAR(left, right, 1e-3);
  }
}

TEST(SplineBasis, ReproducesPolynomialsOfItsDegree) {
  for (int degree : {1, 2}) {
    const SplineBasis basis = random_basis(4, degree, 5);
    const auto f = [&](double x) { return 1.5 - 2 * x + (degree == 2 ? 0.7 * x * x : 0); };
    std::vector<double> places = spread_places(basis, 10);
    const SplineProjection projection(basis, places, std::vector<double>(places.size(), 1.0));
    const std::vector<double> c = projection.fit(f);
    for (double x : places) EXPECT_NEAR(eval_spline(basis, c, x), f(x), 1e-11);
  }
}

TEST(SplineBasis, ProjectionIsTheLeastSquaresFit) {
  const SplineBasis basis = random_basis(5, 2, 4);
  const std::vector<double> places = spread_places(basis, 6);
  std::vector<double> weights, values;
  Rng rng = make_rng(6);
  for (std::size_t i = 0; i < places.size(); ++i) {
    weights.push_back(0.1 + sample_uniform(rng));
    values.push_back(sample_normal(rng));
  }
  const std::vector<double> c = SplineProjection(basis, places, weights).fit(values);
  // The residual is orthogonal to every basis function.
  std::vector<double> product(basis.size(), 0.0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const SplineValues b = eval_basis(basis, places[i]);
    for (std::size_t j = 0; j < 3; ++j)
      product[b.first + j] +=
          weights[i] * b.value[j] * (values[i] - eval_spline(basis, c, places[i]));
  }
  for (double value : product) EXPECT_NEAR(value, 0, 1e-12);
}

TEST(SplineBasis, IntegralsAreExact) {
  const SplineBasis basis{1, {0, 1, 3}};
  const std::vector<double> plain = integrate_basis(basis, [](double) { return 1.0; });
  EXPECT_NEAR(plain[0], 0.5, 1e-14);
  EXPECT_NEAR(plain[1], 1.5, 1e-14);
  EXPECT_NEAR(plain[2], 1.0, 1e-14);
  const std::vector<double> radial = integrate_basis(basis, [](double r) { return r; });
  EXPECT_NEAR(radial[0] + radial[1] + radial[2], 4.5, 1e-13);  // they sum to 1
}

std::vector<double> uniform_places(double a, double b, int count) {
  std::vector<double> places;
  places.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) places.push_back(a + (b - a) * i / (count - 1));
  return places;
}

SampledCurve sample(const std::vector<double>& places, const std::function<double(double)>& f) {
  SampledCurve curve;
  for (double x : places) curve.value.push_back(f(x));
  curve.weight.assign(places.size(), 1.0);
  return curve;
}

double chords_error(const std::vector<double>& places, const SampledCurve& curve,
                    const std::vector<double>& knots) {
  const SplineBasis basis{1, knots};
  double error = 0;
  std::vector<double> at_knots;
  for (double knot : knots)
    for (std::size_t i = 0; i < places.size(); ++i)
      if (places[i] == knot) at_knots.push_back(curve.value[i]);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double e = curve.value[i] - eval_spline(basis, at_knots, places[i]);
    error += curve.weight[i] * e * e;
  }
  return error;
}

TEST(FindKnots, AgreesWithExhaustiveSearch) {
  const std::vector<double> places = uniform_places(0, 3, 13);
  const SampledCurve curve = sample(places, [](double x) { return std::exp(-2 * x) + 0.1 * x; });
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < 12; ++i)
    for (std::size_t j = i + 1; j < 12; ++j)
      best = std::min(best,
                      chords_error(places, curve, {places[0], places[i], places[j], places[12]}));
  EXPECT_NEAR(chords_error(places, curve, find_knots(places, {curve}, 3)), best, 1e-12);
}

TEST(FindKnots, ErrorFollowsTheAsymptoticLaw) {
  // Algorithms, section 5: squared error (int |F''|^(2/5))^5 / (120 m^4), here for e^-r on [0, 10]:
  // RMS 4.26e-3 and 1.06e-3 for 8 and 16 intervals; dynamic programming reaches 4.37e-3, 1.07e-3.
  const std::vector<double> places = uniform_places(0, 10, 1001);
  const SampledCurve curve = sample(places, [](double x) { return std::exp(-x); });
  double last = 1;
  for (const auto& [m, expected] : {std::pair(8, 4.37e-3), std::pair(16, 1.07e-3)}) {
    const std::vector<double> knots = find_knots(places, {curve}, m);
    EXPECT_EQ(knots.size(), static_cast<std::size_t>(m) + 1);
    const double rms = std::sqrt(chords_error(places, curve, knots) / 1001);
    EXPECT_NEAR(rms / expected, 1, 0.03);
    EXPECT_LT(rms, last);
    last = rms;
  }
  const SampledCurve line = sample(places, [](double x) { return 2 - x; });
  EXPECT_NEAR(chords_error(places, line, find_knots(places, {line}, 1)), 0, 1e-20);
}

TEST(SplineProjection, SaysWhenPlacesAreTooFew) {
  const SplineBasis basis{1, {0, 1, 2, 3}};
  EXPECT_EQ(error_of([&] {
              SplineProjection(basis, {0.2, 0.4, 2.2}, {1, 1, 1});
            }),
            "expected places that determine all 4 coefficients, found too few in some "
            "interval");
}

}  // namespace
}  // namespace parian

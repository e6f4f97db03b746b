#include "transport/curve_basis.h"

#include <gtest/gtest.h>

#include <cmath>

#include "material/dipole.h"

namespace parian {
namespace {

constexpr double eta = 1.3, reach = 20;

std::vector<DipoleCoefficients> make_media() {
  std::vector<DipoleCoefficients> media;
  for (const double sigma_s : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0})
    for (const double ratio : {0.002, 0.01, 0.05}) media.push_back({ratio * sigma_s, sigma_s});
  return media;
}

struct Errors {
  double absolute = 0;  // int |R' - R| dA / int R dA, the worst of all
  double total = 0;     // |int R' - R dA| / int R dA
};

Errors measure(const SplineBasis& basis, const SplineProjection& projection) {
  Errors errors;
  constexpr int steps = 4000;
  for (const DipoleCoefficients& medium : make_media()) {
    const auto R_d = [&](double r) { return eval_dipole(medium, eta, r); };
    const std::vector<double> coefficients = projection.fit(R_d);
    double absolute = 0, difference = 0, total = 0;
    for (int i = 0; i < steps; ++i) {
      const double u = (i + 0.5) / steps, r = reach * u * u * u, dA = r * 3 * reach * u * u / steps;
      const double delta = eval_spline(basis, coefficients, r) - R_d(r);
      absolute += std::abs(delta) * dA;
      difference += delta * dA;
      total += R_d(r) * dA;
    }
    errors.absolute = std::max(errors.absolute, absolute / total);
    errors.total = std::max(errors.total, std::abs(difference / total));
  }
  return errors;
}

Errors measure(const CurveBasisParams& params) {
  const SplineBasis basis = make_reflectance_basis(reach, eta, params);
  return measure(basis, make_reflectance_projection(basis, params.knots));
}

// Over sigma_s from 0.2 to 10 and sigma_a / sigma_s from 0.002 to 0.05, at equal storage.
TEST(CurveBasis, BalancedKnotsServeAllCoefficients) {
  const Errors published = measure({.knots = KnotChoice::published});
  EXPECT_GT(published.absolute, 0.5);
  EXPECT_GT(published.total, 0.05);
  const Errors linear = measure(CurveBasisParams{});
  EXPECT_LT(linear.absolute, 0.06);
  EXPECT_LT(linear.total, 5e-4);
  EXPECT_LT(measure({.degree = 2}).absolute, 0.03);
  EXPECT_LT(measure({.intervals = 32}).absolute, 0.02);
}

TEST(CurveBasis, ErrorsFallWithTheIntervals) {
  double last = 1;
  for (const int intervals : {8, 16, 32, 64}) {
    const double error = measure({.intervals = intervals}).absolute;
    EXPECT_LT(error, 0.6 * last) << intervals;
    last = error;
  }
}

TEST(CurveBasis, AttenuationIsFollowed) {
  const SplineBasis basis = make_attenuation_basis(reach);
  const SplineProjection projection = make_attenuation_projection(basis, KnotChoice::balanced);
  for (const double sigma_t : {0.2, 0.5, 1.0, 3.0, 10.0}) {
    const auto E = [&](double s) { return std::exp(-sigma_t * s); };
    const std::vector<double> coefficients = projection.fit(E);
    double absolute = 0, total = 0;
    for (int i = 0; i < 4000; ++i) {
      const double s = reach * (i + 0.5) / 4000;
      absolute += std::abs(eval_spline(basis, coefficients, s) - E(s));
      total += E(s);
    }
    EXPECT_LT(absolute / total, 0.05) << sigma_t;
  }
}

TEST(CurveBasis, KnotsSpanTheReach) {
  for (const KnotChoice knots : {KnotChoice::balanced, KnotChoice::published}) {
    const SplineBasis basis = make_reflectance_basis(60, eta, {.knots = knots});
    EXPECT_EQ(basis.knots.front(), 0);
    EXPECT_EQ(basis.knots.back(), 60);
    EXPECT_EQ(basis.size(), 17u);
  }
}

}  // namespace
}  // namespace parian

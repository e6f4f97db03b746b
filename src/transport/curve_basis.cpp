#include "transport/curve_basis.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/check.h"
#include "material/dipole.h"

namespace parian {
namespace {

using Curve = std::function<double(double)>;

// Xu et al., section 5: the representative coefficients, and the attenuations that go with them.
constexpr DipoleCoefficients media[] = {{0.001, 0.2}, {0.02, 2}, {0.2, 10}};
constexpr double extinctions[] = {0.2, 2, 10};

// Beyond what lies this far below a curve's mean the error's weight grows no more.
constexpr double floor_of_mean = 1e-4;
constexpr int published_places = 1000, balanced_places = 300;
constexpr int places_per_interval = 20, published_places_per_interval = 10;

// Denser towards 0, where curves are steep: x = reach u^3.
std::vector<double> spread_cubically(double reach) {
  std::vector<double> places;
  places.reserve(balanced_places + 1);
  for (int i = 0; i <= balanced_places; ++i)
    places.push_back(reach * std::pow(static_cast<double>(i) / balanced_places, 3));
  return places;
}

// What a place stands for: half the way to both neighbours, times r for R_d.
std::vector<double> measure_of(const std::vector<double>& places, bool radial) {
  std::vector<double> measure;
  measure.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double before = places[i == 0 ? 0 : i - 1],
                 after = places[std::min(i + 1, places.size() - 1)];
    const double length = (after - before) / 2;
    measure.push_back(radial ? std::max(places[i], after / 4) * length : length);
  }
  return measure;
}

SampledCurve balance(const Curve& curve, const std::vector<double>& places,
                     const std::vector<double>& measure, bool radial) {
  SampledCurve sampled;
  double total = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    sampled.value.push_back(curve(places[i]));
    total += sampled.value[i] * measure[i];
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    sampled.value[i] /= total;
    // Some way out a curve that falls like its mean over the disc or the path of that size.
    const double x = places[i] + 0.1;
    const double least = floor_of_mean / (radial ? x * x : x);
    sampled.weight.push_back(measure[i] / (sampled.value[i] + least));
  }
  return sampled;
}

std::vector<double> find_balanced_knots(double reach, const std::vector<Curve>& curves, bool radial,
                                        int intervals) {
  const std::vector<double> places = spread_cubically(reach), measure = measure_of(places, radial);
  std::vector<SampledCurve> sampled;
  sampled.reserve(curves.size());
  for (const Curve& curve : curves) sampled.push_back(balance(curve, places, measure, radial));
  return find_knots(places, sampled, intervals);
}

std::vector<double> find_published_knots(double reach, const std::vector<Curve>& curves,
                                         int intervals) {
  std::vector<double> places;
  SampledCurve mean;
  for (int i = 0; i <= published_places; ++i) {
    places.push_back(reach * i / published_places);
    double sum = 0;
    for (const Curve& curve : curves) sum += curve(places.back());
    mean.value.push_back(sum / static_cast<double>(curves.size()));
    mean.weight.push_back(1);
  }
  return find_knots(places, {mean}, intervals);
}

SplineBasis make_basis(double reach, const std::vector<Curve>& curves, bool radial,
                       const CurveBasisParams& params_) {
  CurveBasisParams params = params_;
  check(describe(params));
  PARIAN_CHECK(reach > 0 && std::isfinite(reach));
  return {.degree = params.degree,
          .knots = params.knots == KnotChoice::published
                       ? find_published_knots(reach, curves, params.intervals)
                       : find_balanced_knots(reach, curves, radial, params.intervals)};
}

SplineProjection make_projection(const SplineBasis& basis, KnotChoice knots, bool radial) {
  const bool published = knots == KnotChoice::published;
  const int count = published ? published_places_per_interval : places_per_interval;
  std::vector<double> places = spread_places(basis, count), weights;
  weights.reserve(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const std::size_t interval = i / static_cast<std::size_t>(count);
    const double length = (basis.knots[interval + 1] - basis.knots[interval]) / count;
    weights.push_back(published ? 1 : radial ? places[i] * length : length);
  }
  return {basis, std::move(places), std::move(weights)};
}

}  // namespace

ParamList describe(CurveBasisParams& params) {
  return {{.name = "intervals",
           .help = "of the piecewise polynomials",
           .target = &params.intervals,
           .min = 1,
           .max = 64},
          {.name = "degree",
           .help = "1: linear, 2: quadratic",
           .target = &params.degree,
           .min = 1,
           .max = 2},
          {.name = "knots",
           .help = "balanced over the range of coefficients, or as Xu et al. 2007 chose them",
           .target = make_choice(params.knots, {"balanced", "published"})}};
}

SplineBasis make_reflectance_basis(double reach_mm, double eta, const CurveBasisParams& params) {
  std::vector<Curve> curves;
  for (const DipoleCoefficients& medium : media)
    curves.emplace_back([medium, eta](double r) { return eval_dipole(medium, eta, r); });
  return make_basis(reach_mm, curves, true, params);
}

SplineBasis make_attenuation_basis(double reach_mm, const CurveBasisParams& params) {
  std::vector<Curve> curves;
  for (const double sigma_t : extinctions)
    curves.emplace_back([sigma_t](double s) { return std::exp(-sigma_t * s); });
  return make_basis(reach_mm, curves, false, params);
}

SplineProjection make_reflectance_projection(const SplineBasis& basis, KnotChoice knots) {
  return make_projection(basis, knots, true);
}
SplineProjection make_attenuation_projection(const SplineBasis& basis, KnotChoice knots) {
  return make_projection(basis, knots, false);
}

}  // namespace parian

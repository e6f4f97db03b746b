// Fig. 1 and 2 of Xu et al. 2007: how well R_d and E are approximated.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "bench/homogeneous/study.h"
#include "bench/homogeneous/wavelets.h"
#include "judge/plot.h"
#include "material/dipole.h"
#include "transport/curve_basis.h"

namespace parian {
namespace {

using Curve = std::function<double(double)>;
constexpr double eta = 1.3, reach = 20;
constexpr int samples = 1024;  // of wavelets: a power of two

struct Errors {
  double rms = 0;       // over [0, reach], as the paper's Fig. 2
  double relative = 0;  // int |f - f'| dA / int f dA
};

Errors measure(const Curve& exact, const Curve& approximate, bool radial) {
  double square = 0, absolute = 0, total = 0;
  constexpr int steps = 8000;
  for (int i = 0; i < steps; ++i) {
    const double x = reach * (i + 0.5) / steps;
    square += std::pow(exact(x) - approximate(x), 2) / steps;
    const double u = (i + 0.5) / steps, y = reach * u * u * u;
    const double dA = (radial ? y : 1) * 3 * reach * u * u / steps;
    absolute += std::abs(exact(y) - approximate(y)) * dA;
    total += exact(y) * dA;
  }
  return {std::sqrt(square), absolute / total};
}

// A basis with its projection; making them takes longer than using them.
struct Splines {
  SplineBasis basis;
  SplineProjection projection;
  bool radial;
};
Splines make_splines(bool radial, const CurveBasisParams& params) {
  SplineBasis basis =
      radial ? make_reflectance_basis(reach, eta, params) : make_attenuation_basis(reach, params);
  SplineProjection projection = radial ? make_reflectance_projection(basis, params.knots)
                                       : make_attenuation_projection(basis, params.knots);
  return {std::move(basis), std::move(projection), radial};
}
Errors measure_splines(const Curve& curve, const Splines& splines) {
  const std::vector<double> c = splines.projection.fit(curve);
  return measure(
      curve, [&](double x) { return eval_spline(splines.basis, c, x); }, splines.radial);
}

// The `count` coarsest coefficients, as precomputed transport would have to keep a fixed set. The
// row is mirrored, so that its ends meet: twice the values, and twice the coefficients.
Errors measure_wavelets(const Curve& curve, Wavelet wavelet, int count) {
  std::vector<double> values(2 * samples);
  for (int i = 0; i < samples; ++i)
    values[static_cast<std::size_t>(i)] = values[static_cast<std::size_t>(2 * samples - 1 - i)] =
        curve(reach * (i + 0.5) / samples);
  const std::vector<double> kept =
      keep_coarse(values, wavelet, static_cast<std::size_t>(2 * count));
  return measure(
      curve,
      [&](double x) {
        return kept[static_cast<std::size_t>(std::clamp(x / reach * samples, 0.0, samples - 1.0))];
      },
      true);
}

std::string number(double value) {
  return fmt::format("{:.2g}", value);
}
std::string percent(double value) {
  return fmt::format("{:.2g} %", 100 * value);
}

void compare_kinds(const Page& page) {
  const DipoleCoefficients medium{0.1, 2};
  const Curve R_d = [&](double r) { return eval_dipole(medium, eta, r); };
  MarkdownTable table;
  table.header = {"basis", "coefficients", "RMS error", "int \\|ΔR_d\\| dA / int R_d dA"};
  const auto add = [&](const std::string& name, std::size_t count, const Errors& errors) {
    table.rows.push_back(
        {name, fmt::format("{}", count), number(errors.rms), percent(errors.relative)});
  };
  add("Haar", 64, measure_wavelets(R_d, Wavelet::haar, 64));
  add("Daubechies 4", 64, measure_wavelets(R_d, Wavelet::daubechies_4, 64));
  add("Daubechies 4", 128, measure_wavelets(R_d, Wavelet::daubechies_4, 128));
  for (const KnotChoice knots : {KnotChoice::published, KnotChoice::balanced})
    for (const int degree : {1, 2}) {
      const std::string name =
          fmt::format("{}, {} knots", degree == 1 ? "linear" : "quadratic",
                      knots == KnotChoice::published ? "published" : "balanced");
      add(name, static_cast<std::size_t>(16 + degree),
          measure_splines(R_d, make_splines(true, {16, degree, knots})));
    }
  write_table(page, "kinds",
              "R_d of σ_s = 2, σ_a = 0.1 over 20 mm. Splines have 16 intervals: 17 or 18 numbers "
              "in place of the 32 or 48 coefficients of monomials that the paper counts.",
              table);
}

void compare_counts(const Page& page) {
  MarkdownTable table;
  table.header = {"intervals", "published: worst R_d", "balanced: worst R_d",
                  "quadratic", "published: worst E",   "balanced: worst E"};
  const auto worst = [&](bool radial, const CurveBasisParams& params) {
    const Splines splines = make_splines(radial, params);
    double error = 0;
    for (const double sigma_s : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0})
      for (const double ratio : {0.002, 0.01, 0.05}) {
        const DipoleCoefficients medium{ratio * sigma_s, sigma_s};
        const Curve curve =
            radial ? Curve([&](double r) { return eval_dipole(medium, eta, r); })
                   : Curve([&](double s) { return std::exp(-(medium.sigma_a + sigma_s) * s); });
        error = std::max(error, measure_splines(curve, splines).relative);
      }
    return percent(error);
  };
  for (const int intervals : {4, 8, 16, 32})
    table.rows.push_back({fmt::format("{}", intervals),
                          worst(true, {intervals, 1, KnotChoice::published}),
                          worst(true, {intervals, 1, KnotChoice::balanced}),
                          worst(true, {intervals, 2, KnotChoice::balanced}),
                          worst(false, {intervals, 1, KnotChoice::published}),
                          worst(false, {intervals, 1, KnotChoice::balanced})});
  write_table(page, "counts",
              "The worst int |Δf| dA / int f dA over σ_s from 0.2 to 10 and σ_a / σ_s from 0.002 "
              "to 0.05.",
              table);
}

// Fig. 2.
void plot_counts(const Page& page, bool radial) {
  Plot plot;
  plot.title = radial ? "RMS error of R_d" : "RMS error of E";
  plot.x_label = "coefficients";
  plot.y_label = "RMS error";
  plot.log_y = true;
  constexpr double sigmas[] = {0.2, 2, 10};
  constexpr std::array<float, 3> colors[] = {
      {0.1f, 0.3f, 0.8f}, {0.05f, 0.5f, 0.1f}, {0.8f, 0.1f, 0.05f}};
  for (const int degree : {1, 2}) {
    std::vector<PlotSeries> series(3);
    for (const int intervals : {2, 4, 6, 8, 12, 16, 24, 32}) {
      const Splines splines = make_splines(radial, {intervals, degree, KnotChoice::published});
      for (std::size_t i = 0; i < 3; ++i) {
        const DipoleCoefficients medium{0.01 * sigmas[i], sigmas[i]};
        const Curve curve =
            radial ? Curve([=](double r) { return eval_dipole(medium, eta, r); })
                   : Curve([=](double s) { return std::exp(-1.01 * medium.sigma_s_prime * s); });
        series[i].x.push_back(intervals + degree);
        series[i].y.push_back(measure_splines(curve, splines).rms);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      series[i].label =
          fmt::format("sigma_s {:.1f}, {}", sigmas[i], degree == 1 ? "linear" : "quadratic");
      series[i].color = colors[i];
      series[i].size = degree == 1 ? 2 : 1;
      plot.series.push_back(std::move(series[i]));
    }
  }
  write_picture(page, radial ? "counts-R_d" : "counts-E", draw_plot(plot));
}

}  // namespace

void study_bases(const Page& page) {
  compare_kinds(page);
  compare_counts(page);
  for (const bool radial : {true, false}) plot_counts(page, radial);
}

}  // namespace parian

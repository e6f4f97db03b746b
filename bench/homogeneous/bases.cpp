// Fig. 1 and 2 of Xu et al. 2007: how well R_d and E are approximated.
#include <fmt/format.h>

#include <algorithm>
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

Errors measure_splines(const Curve& curve, bool radial, const CurveBasisParams& params) {
  const SplineBasis basis =
      radial ? make_R_d_basis(reach, eta, params) : make_E_basis(reach, params);
  const SplineProjection projection =
      radial ? make_R_d_projection(basis, params.knots) : make_E_projection(basis, params.knots);
  const std::vector<double> c = projection.fit(curve);
  return measure(
      curve, [&](double x) { return eval_spline(basis, c, x); }, radial);
}

// The `count` coarsest coefficients, as precomputed transport would have to keep a fixed set.
Errors measure_wavelets(const Curve& curve, Wavelet wavelet, int count) {
  std::vector<double> values(samples);
  for (int i = 0; i < samples; ++i)
    values[static_cast<std::size_t>(i)] = curve(reach * (i + 0.5) / samples);
  const std::vector<double> kept = keep_coarse(values, wavelet, static_cast<std::size_t>(count));
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
          measure_splines(R_d, true, {16, degree, knots}));
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
    double error = 0;
    for (const double sigma_s : {0.2, 0.5, 1.0, 2.0, 5.0, 10.0})
      for (const double ratio : {0.002, 0.01, 0.05}) {
        const DipoleCoefficients medium{ratio * sigma_s, sigma_s};
        const Curve curve =
            radial ? Curve([&](double r) { return eval_dipole(medium, eta, r); })
                   : Curve([&](double s) { return std::exp(-(medium.sigma_a + sigma_s) * s); });
        error = std::max(error, measure_splines(curve, radial, params).relative);
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
void plot_counts(const Page& page) {
  for (const bool radial : {true, false}) {
    Plot plot;
    plot.title = radial ? "RMS error of R_d" : "RMS error of E";
    plot.x_label = "coefficients";
    plot.y_label = "RMS error";
    plot.log_y = true;
    for (const double sigma_s : {0.2, 2.0, 10.0})
      for (const int degree : {1, 2}) {
        const DipoleCoefficients medium{0.01 * sigma_s, sigma_s};
        const Curve curve = radial ? Curve([=](double r) { return eval_dipole(medium, eta, r); })
                                   : Curve([=](double s) { return std::exp(-1.01 * sigma_s * s); });
        PlotSeries series;
        series.color = sigma_s < 1   ? std::array{0.1f, 0.3f, 0.8f}
                       : sigma_s < 5 ? std::array{0.05f, 0.5f, 0.1f}
                                     : std::array{0.8f, 0.1f, 0.05f};
        series.size = degree == 1 ? 2 : 1;
        series.label =
            fmt::format("sigma_s {:.1f}, {}", sigma_s, degree == 1 ? "linear" : "quadratic");
        for (const int intervals : {2, 4, 6, 8, 12, 16, 24, 32}) {
          series.x.push_back(intervals + degree);
          series.y.push_back(
              measure_splines(curve, radial, {intervals, degree, KnotChoice::published}).rms);
        }
        plot.series.push_back(std::move(series));
      }
    write_picture(page, radial ? "counts-R_d" : "counts-E", draw_plot(plot));
  }
}

}  // namespace

void study_bases(const Page& page) {
  compare_kinds(page);
  compare_counts(page);
  plot_counts(page);
}

}  // namespace parian

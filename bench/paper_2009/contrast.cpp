// How far the product of radial profiles carries: a chessboard of two materials that differ in
// sigma_a or in sigma_s' by a growing ratio.
#include <fmt/format.h>

#include <cmath>

#include "bench/paper_2009/study.h"
#include "judge/plot.h"

namespace parian::paper_2009 {
namespace {

constexpr double sigma_a = 0.03, sigma_s_prime = 2;
enum class Varied { absorption, scattering };

Document describe_board(Varied varied, double ratio) {
  const auto make_material = [&](const char* name, double factor) {
    const double a = sigma_a * (varied == Varied::absorption ? factor : 1);
    const double s = sigma_s_prime * (varied == Varied::scattering ? factor : 1);
    return Document::Object{{"name", name}, {"sigma_a", a}, {"sigma_s_prime", s}};
  };
  // The geometric mean stays.
  return Document::Object{{"name", "contrast"},
                          {"materials", Document::Array{make_material("low", 1 / std::sqrt(ratio)),
                                                        make_material("high", std::sqrt(ratio))}},
                          {"layout", Document::Object{{"kind", "chessboard"}, {"tile_mm", 3}}},
                          {"pitch_mm", 0.25},
                          {"size", Document::Array{96, 96}},
                          {"radius_px", 16},
                          {"channels", 1},
                          {"eta", 1.5}};
}

}  // namespace

void study_contrast(Study& study) {
  MarkdownTable table{{"varied", "ratio", "relative error min / mean / max", "mean albedo error",
                       "max albedo error", "log RMS"},
                      {}};
  Plot plot{.title = "errors against the contrast of a chessboard",
            .x_label = "ratio of the two materials' coefficients",
            .y_label = "mean error",
            .log_x = true,
            .log_y = true};
  for (const Varied varied : {Varied::absorption, Varied::scattering}) {
    const bool absorbs = varied == Varied::absorption;
    const char* const name = absorbs ? "sigma_a" : "sigma_s'";
    const std::array<float, 3> color =
        absorbs ? std::array{0.75f, 0.16f, 0.01f} : std::array{0.02f, 0.09f, 0.65f};
    PlotSeries relative{.label = fmt::format("relative error, {}", name), .color = color};
    PlotSeries albedo{
        .label = fmt::format("albedo error, {}", name), .color = color, .points = true, .size = 7};
    for (const double ratio : {1.0, 1.5, 2.0, 4.0, 8.0, 16.0, 32.0}) {
      const CompareReport errors =
          fit_and_judge(simulate(describe_board(varied, ratio)), {}).errors;
      const MinMeanMax& l2 = errors.relative_error;
      table.rows.push_back({relative.x.empty() ? name : "", fmt::format("{}", ratio),
                            fmt::format("{:.4f} / {:.4f} / {:.4f}", l2.min, l2.mean, l2.max),
                            fmt::format("{:.5f}", errors.albedo_error_mean),
                            fmt::format("{:.5f}", errors.albedo_error_max),
                            fmt::format("{:.4f}", errors.log_rms)});
      for (PlotSeries* line : {&relative, &albedo}) line->x.push_back(ratio);
      relative.y.push_back(l2.mean);
      albedo.y.push_back(errors.albedo_error_mean);
    }
    plot.series.push_back(std::move(relative));
    plot.series.push_back(std::move(albedo));
  }
  write_table(study, "contrast",
              fmt::format("A simulated chessboard of 96 x 96 pixels of 0.25 mm, squares of 3 mm, "
                          "radius 16 px, about sigma_a = {} and sigma_s' = {} 1/mm (geometric mean "
                          "of the two materials).",
                          sigma_a, sigma_s_prime),
              table);
  write_picture(study, "contrast", draw_plot(plot));
}

}  // namespace parian::paper_2009

// Error against the number of segments n, and against the weight lambda of the regulariser.
#include <fmt/format.h>

#include <array>
#include <utility>

#include "bench/common/pictures.h"
#include "bench/paper_2009/study.h"
#include "io/hdf5/table_file.h"
#include "judge/plot.h"

namespace parian::paper_2009 {
namespace {

constexpr double held_out = 0.05;

struct Series {
  const char* name;
  std::array<float, 3> color, light;
};
constexpr Series series[] = {
    {"chessboard, 96 x 96 px", {0.02f, 0.09f, 0.65f}, {0.45f, 0.55f, 0.95f}},
    {"artificial stone", {0.75f, 0.16f, 0.01f}, {0.95f, 0.6f, 0.4f}},
    {"stone-72x64.h5", {0.01f, 0.3f, 0.06f}, {0.4f, 0.75f, 0.45f}}};

BssrdfTable load_series(Study& study, int index) {
  if (index == 1) return get_sample(study, "artificial-stone");
  if (index == 2)
    return read_table(*open_table(std::string(PARIAN_SOURCE_DIR) + "/data/stone-72x64.h5"));
  Document corner = load_sample("chessboard");
  set(corner, "size", Document::Array{96, 96});
  return simulate(corner);
}

// One setting, fitted three times.
struct Fits {
  Judged all, unprojected, held_out;
};

Fits fit_thrice(const BssrdfTable& table, FitParams params) {
  Fits fits;
  fits.all = fit_and_judge(table, params);
  params.monotone = false;
  fits.unprojected = fit_and_judge(table, params);
  params.monotone = true;
  params.hold_out = held_out;
  fits.held_out = fit_and_judge(table, params);
  return fits;
}

const std::vector<std::string> error_columns{
    "relative error", "not projected",      "held out",   "albedo error",
    "not projected",  "profiles projected", "iterations", "fit, s"};
std::vector<std::string> error_cells(const Fits& fits) {
  const Judged& all = fits.all;
  return {fmt::format("{:.4f}", all.errors.relative_error.mean),
          fmt::format("{:.4f}", fits.unprojected.errors.relative_error.mean),
          fmt::format("{:.4f}", fits.held_out.errors.held_out->relative_error.mean),
          fmt::format("{:.4f}", all.errors.albedo_error_mean),
          fmt::format("{:.4f}", fits.unprojected.errors.albedo_error_mean),
          fmt::format("{:.2f} %", 100 * all.touched),
          fmt::format("{}", all.fit.report.channels[1].iterations),
          fmt::format("{:.2f}", all.seconds)};
}

struct Curves {
  PlotSeries all, unprojected, held;
};

void append(std::vector<std::string>& row, std::vector<std::string> cells) {
  for (std::string& cell : cells) row.push_back(std::move(cell));
}

void add_segments(MarkdownTable& out, Curves& curves, const BssrdfTable& table, const char* name) {
  for (const int n : {6, 8, 12, 16, 20, 24, 32, 40, 48}) {
    FitParams params;
    params.segments = n;
    const Fits fits = fit_thrice(table, params);
    std::vector<std::string> row{curves.all.x.empty() ? name : "", fmt::format("{}", n)};
    append(row, error_cells(fits));
    out.rows.push_back(std::move(row));
    for (PlotSeries* line : {&curves.all, &curves.unprojected, &curves.held}) line->x.push_back(n);
    curves.all.y.push_back(fits.all.errors.relative_error.mean);
    curves.unprojected.y.push_back(fits.unprojected.errors.relative_error.mean);
    curves.held.y.push_back(fits.held_out.errors.held_out->relative_error.mean);
  }
}

void study_lambda(Study& study) {
  MarkdownTable table{{"n", "lambda"}, {}};
  append(table.header, error_columns);
  const BssrdfTable& stone = get_sample(study, "artificial-stone");
  for (const int n : {17, 24}) {
    std::string first = fmt::format("{}", n);
    for (const double lambda : {0.0, 0.01, 0.1, 0.3, 1.0, 3.0}) {
      FitParams params;
      params.segments = n;
      params.lambda = lambda;
      std::vector<std::string> row{std::exchange(first, ""), fmt::format("{}", lambda)};
      append(row, error_cells(fit_thrice(stone, params)));
      table.rows.push_back(std::move(row));
    }
  }
  write_table(study, "lambda", "Artificial stone (simulated), radius 17 px, against lambda.",
              table);
}

}  // namespace

void study_segments(Study& study) {
  MarkdownTable table{{"sample", "n"}, {}};
  append(table.header, error_columns);
  Plot plot{.x_label = "number of segments n",
            .y_label = "mean relative error",
            .log_y = true,
            .width = 720,
            .height = 480};
  std::vector<LegendEntry> legend;
  for (int i = 0; i < 3; ++i) {
    Curves curves{.all = {.color = series[i].color},
                  .unprojected = {.color = series[i].light, .size = 1.5},
                  .held = {.color = series[i].color, .points = true, .size = 7}};
    legend.push_back({series[i].name, series[i].color});
    add_segments(table, curves, load_series(study, i), series[i].name);
    for (PlotSeries* line : {&curves.unprojected, &curves.all, &curves.held})
      plot.series.push_back(std::move(*line));
  }
  write_table(study, "segments",
              "Against the number of segments n (all simulated); radius 24, 17 and 14 px.", table);
  write_picture(study, "segments",
                arrange({{draw_legend(legend, plot.width)}, {draw_plot(plot)}}, 0));
  study_lambda(study);
}

}  // namespace parian::paper_2009

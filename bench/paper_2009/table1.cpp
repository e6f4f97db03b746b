// Table 1: sizes, times and errors beside the published ones.
#include <fmt/format.h>

#include "bench/paper_2009/study.h"

namespace parian::paper_2009 {
namespace {

// Table 1 of the paper; onyx is of the 2019 paper, which gives the map's size alone.
struct Published {
  const char* sample;
  const char* minutes;
  const char* table_mb;
  const char* map_mb;
  const char* errors;
};
constexpr Published rows[] = {
    {"chessboard", "25.3", "674", "13.5", "0.009 / 0.067 / 0.169"},
    {"blue-wax", "10.3", "286", "5.6", "0.004 / 0.031 / 0.095"},
    {"artificial-stone", "5.7", "163", "3.2", "0.003 / 0.029 / 0.098"},
    {"jade", "34.0", "947", "18.6", "0.008 / 0.062 / 0.158"},
    {"yellow-wax", "6.0", "169", "3.3", "0.004 / 0.023 / 0.075"},
    {"onyx", "-", "-", "11.4", "-"},
};

std::string format_mib(double bytes) {
  return fmt::format("{:.1f}", bytes / (1024 * 1024));
}

double map_bytes(const ProfileMap& map, std::size_t knots) {
  return 4.0 * map.channels * static_cast<double>(map.pixels() * knots);
}

std::vector<std::string> size_row(const Published& published, const BssrdfTable& table,
                                  const Judged& paper) {
  const ProfileMap& map = paper.fit.map;
  return {published.sample,
          fmt::format("{} x {}", map.width, map.height),
          fmt::format("{:.0f}", radius_px(table.header)),
          format_mib(4.0 * static_cast<double>(table.reflectance.size())),
          published.table_mb,
          format_mib(map_bytes(map, map.knots_mm.size())),
          format_mib(map_bytes(map, map.knots_mm.size() - 1)),
          published.map_mb,
          fmt::format("{:.2f}", paper.seconds),
          published.minutes};
}

std::vector<std::string> error_row(const std::string& sample, const std::string& weight,
                                   const Judged& judged, const std::string& published) {
  const MinMeanMax& l2 = judged.errors.relative_error;
  return {sample,
          weight,
          fmt::format("{}", judged.fit.map.knots_mm.size() - 1),
          fmt::format("{:.2f}", judged.seconds),
          fmt::format("{:.3f} / {:.3f} / {:.3f}", l2.min, l2.mean, l2.max),
          fmt::format("{:.3f}", judged.errors.relative_error_l1.mean),
          fmt::format("{:.4f}", judged.errors.albedo_error_mean),
          fmt::format("{:.3f}", judged.errors.log_rms),
          fmt::format("{:.1f}", judged.errors.psnr_db.line),
          published};
}

}  // namespace

void study_table1(Study& study) {
  MarkdownTable sizes{{"sample", "pixels", "radius, px", "table, MiB", "2009: table",
                       "map, n + 1 knots", "map, n knots", "2009: map", "fit, s", "2009: fit, min"},
                      {}};
  MarkdownTable errors{
      {"sample", "fit", "n", "fit, s", "relative error min / mean / max", "mean in L1",
       "mean albedo error", "log RMS", "PSNR under a line, dB", "2009: relative error"},
      {}};
  for (const Published& published : rows) {
    const BssrdfTable& table = get_sample(study, published.sample);
    const Judged paper = fit_and_judge(table, paper_params());
    const Judged defaults = fit_and_judge(table, {});
    sizes.rows.push_back(size_row(published, table, paper));
    errors.rows.push_back(error_row(published.sample, "as in 2009", paper, published.errors));
    errors.rows.push_back(error_row("", "defaults", defaults, ""));
  }
  write_table(study, "table1-sizes",
              "Sizes in MiB and times: our simulated samples beside the published measured ones; "
              "n = 24, settings of 2009.",
              sizes);
  write_table(
      study, "table1-errors",
      "Errors on our simulated samples; the published ones are of measured samples and cannot "
      "be compared with them one to one.",
      errors);
}

}  // namespace parian::paper_2009

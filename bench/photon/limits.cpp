// Where the product of two profiles and the plane fail: photon tables of the two volumes of Fig. 5
// of the 2009 paper, their fits, and slabs of finite thickness.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <functional>

#include "bench/common/pictures.h"
#include "bench/photon/study.h"
#include "fit/fit.h"
#include "io/json/json.h"
#include "judge/compare.h"
#include "material/material.h"

namespace parian::photon {
namespace {

constexpr int border = 32;  // pixels: where the second material begins, or the wall
constexpr int magnification = 5;

struct Case {
  std::string name;
  BssrdfTable table;
  PhotonReport photons;
  ProfileMap map;
  CompareReport errors;
};

Case make_case(const std::string& name) {
  std::fprintf(stderr, "simulating %s\n", name.c_str());
  const Sample sample =
      read_sample(load_document(PARIAN_SOURCE_DIR "/data/samples/" + name + ".json"), {});
  const Run run = run_photons(sample, {.photons = 8192});
  const auto photons = make_photon_source(*run.simulation);
  Case made{name, read_table(*photons), run.report, {}, {}};
  const auto source = make_slices(made.table);
  FitParams params;
  params.weight = PairWeight::energy;
  made.map = fit_profiles(*source, params).map;
  const Material material = made.map;
  made.errors = compare(*source, *make_slices(material, made.table.header));
  return made;
}

// Sums of data and model over the pairs of a kind at 1.5 to 2.25 mm.
using PairKind = std::function<bool(int from, int to)>;
std::vector<std::string> compare_pairs(const Case& each, const std::string& name,
                                       const PairKind& is_of) {
  const TableHeader& header = each.table.header;
  double data = 0, model = 0, pairs = 0;
  for (const Offset d : header.offsets) {
    if (length_px(d) < 6 || length_px(d) > 9) continue;
    const PixelRange range = pairs_in_grid(header, d);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        if (!is_of(x, x + d.dx)) continue;
        data += table_value(each.table, 0, x, y, d);
        model += model_value(each.map, 0, x, y, d);
        pairs += 1;
      }
  }
  return {each.name + ": " + name, fmt::format("{:.2e}", data / pairs),
          fmt::format("{:.2e}", model / pairs), fmt::format("{:.3g}", model / data)};
}

void add_rows(const Case& a, const Case& b, MarkdownTable& table) {
  const auto left = [](int near, int far) {
    return [=](int i, int k) { return std::min(i, k) >= near && std::max(i, k) < far; };
  };
  table.rows.push_back(
      compare_pairs(a, "both in the light half, 3 mm from the border", left(0, 20)));
  table.rows.push_back(
      compare_pairs(a, "both in the dark half, 3 mm from the border", left(44, 64)));
  const auto across = [](int i, int k) {
    return std::min(i, k) < border && std::max(i, k) > border;
  };
  table.rows.push_back(compare_pairs(a, "across the border", across));
  table.rows.push_back(compare_pairs(b, "on one side, 3 mm from the wall", left(0, 20)));
  table.rows.push_back(compare_pairs(b, "on one side, both within 1 mm of the wall", left(28, 32)));
  table.rows.push_back(compare_pairs(b, "across the wall", across));
}

// R_d(x, x + d) along a row: data, model and the logarithm of their ratio.
Image draw_row(const Case& each) {
  const TableHeader& header = each.table.header;
  const int reach = static_cast<int>(radius_px(header)), width = header.width;
  Image data = make_image(width, 2 * reach + 1, 1), model = data, ratio = data;
  for (int x = 0; x < width; ++x)
    for (int d = -reach; d <= reach; ++d) {
      // Mean over the rows of the sample, which differ by noise alone.
      double measured = 0, modelled = 0;
      for (int y = 0; y < header.height; ++y) {
        const bool inside = x + d >= 0 && x + d < width;
        measured += inside ? table_value(each.table, 0, x, y, {d, 0}) : std::nan("");
        modelled += inside ? model_value(each.map, 0, x, y, {d, 0}) : std::nan("");
      }
      at(data, x, reach - d, 0) = static_cast<float>(measured / header.height);
      at(model, x, reach - d, 0) = static_cast<float>(modelled / header.height);
      at(ratio, x, reach - d, 0) = static_cast<float>(std::log(modelled / measured));
    }
  const double edge = (reach + 0.5) * header.pixel_pitch_mm, end = width * header.pixel_pitch_mm;
  const ColorScale scale = log_scale(1, 5, "[1/mm^2]");
  const ColorScale errors = diverging_scale(std::log(10.0), "ln(model / data)");
  const auto panel = [&](const Image& values, const ColorScale& colors, const char* title,
                         bool last) {
    return draw_panel({colorize(values, colors, magnification), title, last ? "x [mm]" : "",
                       "d [mm]", 0, end, edge, -edge});
  };
  const Image bar = draw_color_bar(scale, data.height * magnification);
  return arrange(
      {{panel(data, scale, "photons: R_d(x, x + d)", false), bar},
       {panel(model, scale, "model: sqrt(P_x(|d|) P_x+d(|d|))", false), bar},
       {panel(ratio, errors, "error", true), draw_color_bar(errors, data.height * magnification)}},
      4);
}

// R_d between one pixel and those around it.
Image draw_around(const Case& each, int x, int y) {
  const TableHeader& header = each.table.header;
  const int reach = static_cast<int>(radius_px(header)), side = 2 * reach + 1;
  Image data = make_image(side, side, 1, NAN), model = data;
  for (const Offset d : header.offsets)
    for (const Offset o : {d, Offset{-d.dx, -d.dy}}) {
      if (x + o.dx < 0 || x + o.dx >= header.width || y + o.dy < 0 || y + o.dy >= header.height)
        continue;
      at(data, reach + o.dx, reach + o.dy, 0) =
          static_cast<float>(table_value(each.table, 0, x, y, o));
      at(model, reach + o.dx, reach + o.dy, 0) =
          static_cast<float>(model_value(each.map, 0, x, y, o));
    }
  const double edge = (reach + 0.5) * header.pixel_pitch_mm;
  const ColorScale scale = log_scale(1, 5, "[1/mm^2]");
  const auto panel = [&](const Image& values, const char* title) {
    return draw_panel({colorize(values, scale, 8), title, "mm", "", -edge, edge, edge, -edge});
  };
  return arrange({{panel(data, "photons"), panel(model, "model"), draw_color_bar(scale, side * 8)}},
                 4);
}

}  // namespace

void study_limits(const Page& page) {
  const Case a = make_case("two-materials"), b = make_case("narrow-blocker");
  MarkdownTable errors{{"sample", "relative error, mean", "largest", "albedo error, mean",
                        "largest", "standard error of the table at the median offset"},
                       {}};
  for (const Case* each : {&a, &b})
    errors.rows.push_back({each->name,
                           fmt::format("{:.1f} %", 100 * each->errors.relative_error.mean),
                           fmt::format("{:.1f} %", 100 * each->errors.relative_error.max),
                           fmt::format("{:.1f} %", 100 * each->errors.albedo_error_mean),
                           fmt::format("{:.1f} %", 100 * each->errors.albedo_error_max),
                           fmt::format("{:.1f} %", 100 * each->photons.median_error)});
  write_table(page, "errors", "Fits with `--weight energy` against the photon tables:", errors);
  MarkdownTable pairs{{"pairs 1.5 to 2.25 mm apart", "R_d of photons", "of the model", "ratio"},
                      {}};
  add_rows(a, b, pairs);
  write_table(page, "pairs", "Means over pairs of a kind, in 1/mm²:", pairs);
  write_picture(page, "two-materials", draw_row(a));
  write_picture(page, "narrow-blocker", draw_row(b));
  write_picture(page, "narrow-blocker-around", draw_around(b, border - 3, 32));
}

void study_thickness(const Page& page) {
  MarkdownTable table{{"thickness [mm]", "thickness [1/σ_s′]", "reflected", "transmitted",
                       "reflected / half-infinite"},
                      {}};
  const double sigma_a = 0.01, sigma_s_prime = 2, eta = 1.3;
  const Totals whole = measure_totals(make_homogeneous(sigma_a, sigma_s_prime, 0, eta),
                                      PhotonEntry::lambertian, 320000);
  for (const double thickness : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0}) {
    const Totals slab = measure_totals(make_homogeneous(sigma_a, sigma_s_prime, 0, eta, thickness),
                                       PhotonEntry::lambertian, 320000);
    table.rows.push_back(
        {fmt::format("{}", thickness), fmt::format("{}", thickness * sigma_s_prime),
         fmt::format("{:.3f}", slab.reflected.value), fmt::format("{:.3f}", slab.transmitted.value),
         fmt::format("{:.2f}", slab.reflected.value / whole.reflected.value)});
  }
  write_table(page, "thickness",
              fmt::format("Slabs with σ_a = {}, σ_s′ = {} per mm, η = {}, light from all sides; "
                          "half-infinite: {:.3f} reflected.",
                          sigma_a, sigma_s_prime, eta, whole.reflected.value),
              table);
}

}  // namespace parian::photon

// The diffusion models beside each other and beside exact totals.
#include <fmt/format.h>

#include <array>
#include <functional>

#include "base/stopwatch.h"
#include "bench/homogeneous/study.h"
#include "judge/plot.h"
#include "material/slab_diffusion.h"
#include "render/render.h"

namespace parian {
namespace {

// Totals of isotropic half-spaces at normal incidence, by the H function and the linear equations
// of a Fresnel boundary, without the specular part and per incident flux.
struct ExactRow {
  double albedo;
  std::array<double, 4> total;
};
constexpr std::array<double, 4> etas{1, 1.3, 1.4, 1.5};
constexpr ExactRow exact_rows[] = {
    {0.5, {.11523, .06241, .05230, .04425}},  {0.8, {.28525, .17824, .15305, .13198}},
    {0.9, {.41495, .28578, .25060, .21992}},  {0.95, {.53554, .40088, .35913, .32112}},
    {0.98, {.67108, .54782, .50378, .46147}}, {0.99, {.75272, .64539, .60359, .56198}},
    {0.999, {.91285, .85675, .83012, .80146}}};

void compare_totals(const Page& page) {
  MarkdownTable table;
  table.header = {"albedo"};
  for (const double eta : etas)
    for (const char* name : {"exact", "classic", "better"})
      table.header.push_back(fmt::format("{}, η = {}", name, eta));
  for (const ExactRow& row : exact_rows) {
    std::vector<std::string> cells{fmt::format("{}", row.albedo)};
    for (std::size_t e = 0; e < etas.size(); ++e) {
      const double specular = (etas[e] - 1) / (etas[e] + 1);
      const double exact = row.total[e] / (1 - specular * specular);
      cells.push_back(fmt::format("{:.4f}", exact));
      for (const auto model : {DiffusionModel::classic, DiffusionModel::better}) {
        const Dipole material{
            .channels = {{1 - row.albedo, row.albedo}}, .eta = etas[e], .model = model};
        const double total = total_of(make_reflectance_curve(material, 0));
        cells.push_back(fmt::format("{:+.1f} %", 100 * (total / exact - 1)));
      }
    }
    table.rows.push_back(cells);
  }
  write_table(page, "totals",
              "Total reflectance per transmitted flux of isotropic half-spaces: exact values at "
              "normal incidence, and how far the models are from them. Normalised diffusion has "
              "the better dipole's totals.",
              table);
}

struct Variant {
  const char* name;
  Dipole material;
  std::array<float, 3> color;
};

std::vector<Variant> make_variants() {
  const std::vector<DipoleCoefficients> wax{{0.01, 1.6}, {0.03, 1.4}, {0.1, 1.2}};
  const auto make = [&](DiffusionModel model, double thickness_mm, std::vector<DipoleLayer> below) {
    return Dipole{.channels = wax,
                  .eta = 1.4,
                  .model = model,
                  .thickness_mm = thickness_mm,
                  .below = std::move(below)};
  };
  return {{"classic", make(DiffusionModel::classic, 0, {}), {0.1f, 0.1f, 0.1f}},
          {"better", make(DiffusionModel::better, 0, {}), {0.8f, 0.1f, 0.05f}},
          {"normalised", make(DiffusionModel::normalized, 0, {}), {0.05f, 0.4f, 0.8f}},
          {"better, a slab of 2 mm", make(DiffusionModel::better, 2, {}), {0.7f, 0.35f, 0.0f}},
          {"better, 2 mm over blood red",
           make(DiffusionModel::better, 2, {{{{0.05, 1}, {1, 1}, {1.2, 1}}, 0}}),
           {0.5f, 0.0f, 0.4f}}};
}

void plot_curves(const Page& page, const std::vector<Variant>& variants) {
  Plot plot;
  plot.title = "R_d of the green channel";
  plot.x_label = "r in mm";
  plot.y_label = "R_d in 1/mm^2";
  plot.log_y = true;
  for (const Variant& variant : variants) {
    const ReflectanceCurve curve = make_reflectance_curve(variant.material, 1);
    PlotSeries series{.label = variant.name, .color = variant.color};
    for (double r = 0.02; r <= 12; r += 0.02) {
      series.x.push_back(r);
      series.y.push_back(eval_curve(curve, r));
    }
    plot.series.push_back(std::move(series));
  }
  write_picture(page, "models-curves", draw_plot(plot));
}

// One curve, with all that it needs.
double measure_ms(const Dipole& material) {
  constexpr int runs = 8;
  const Stopwatch watch;
  double sum = 0;
  for (int i = 0; i < runs; ++i) sum += eval_curve(make_reflectance_curve(material, 1), 1);
  const double seconds = watch.seconds();
  return sum > 0 ? 1e3 * seconds / runs : 0;
}

void show_variants(const Page& page, const std::vector<Variant>& variants) {
  Scene scene = make_dragon_scene(300, 225, {});
  MarkdownTable table;
  table.header = {"model", "total red", "green", "blue", "ms per curve"};
  std::vector<Image> pictures;
  for (const Variant& variant : variants) {
    const Dipole& material = variant.material;
    std::vector<std::string> cells{variant.name};
    for (std::size_t c = 0; c < 3; ++c)
      cells.push_back(fmt::format("{:.3f}", total_of(make_reflectance_curve(material, c))));
    cells.push_back(fmt::format("{:.2g}", measure_ms(material)));
    table.rows.push_back(cells);
    scene.material = Material(material);
    pictures.push_back(render(scene, {}).image);
  }
  write_table(page, "models",
              "Wax of σ_s' = (1.6, 1.4, 1.2), σ_a = (0.01, 0.03, 0.1), η = 1.4 by each model, in "
              "the order of the pictures.",
              table);
  write_picture(page, "models", place_side_by_side(pictures, 0));
}

}  // namespace

void study_models(const Page& page) {
  compare_totals(page);
  const std::vector<Variant> variants = make_variants();
  plot_curves(page, variants);
  show_variants(page, variants);
}

}  // namespace parian

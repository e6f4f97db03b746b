// The classic dipole beside photons: totals, and the profile of a homogeneous half-space.
#include <fmt/format.h>

#include <cmath>

#include "bench/photon/study.h"
#include "judge/plot.h"
#include "material/dipole.h"

namespace parian::photon {
namespace {

// Of light along the normal, with what passes the surface.
double dipole_total(double albedo, double eta) {
  const double passed = 1 - (eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1));
  return passed * dipole_albedo({.sigma_a = 1 - albedo, .sigma_s_prime = albedo}, eta);
}

void write_totals(const Page& page) {
  MarkdownTable table{{"albedo", "η = 1.3", "η = 1.5"}, {}};
  for (const double albedo : {0.5, 0.8, 0.9, 0.95, 0.99, 0.999}) {
    std::vector<std::string> row{fmt::format("{}", albedo)};
    for (const double eta : {1.3, 1.5}) {
      const Totals totals =
          measure_totals(make_homogeneous(1 - albedo, albedo, 0, eta), PhotonEntry::normal, 320000);
      const double ratio = dipole_total(albedo, eta) / totals.reflected.value;
      row.push_back(fmt::format("{:+.1f} % ± {:.1f}", 100 * (ratio - 1),
                                100 * ratio * totals.reflected.error / totals.reflected.value));
    }
    table.rows.push_back(row);
  }
  write_table(page, "dipole",
              "Total diffuse reflectance of the classic dipole against photons, light along the "
              "normal:",
              table);
}

// Mean R_d by distance of a homogeneous sample's photon table, light from all sides.
PlotSeries measure_profile(double albedo, std::array<float, 3> color) {
  const Document material =
      Document::Object{{"name", "all"}, {"sigma_a", 1 - albedo}, {"sigma_s_prime", albedo}};
  const Sample sample =
      read_sample(Document::Object{{"name", "half-space"},
                                   {"materials", Document::Array{material}},
                                   {"layout", Document::Object{{"kind", "uniform"}}},
                                   {"eta", 1.5},
                                   {"channels", 1},
                                   {"pitch_mm", 0.5},
                                   {"size", Document::Array{25, 25}},
                                   {"radius_px", 20}},
                  {});
  const Run run = run_photons(sample, {.photons = 16384});
  const BssrdfTable table = read_table(*make_photon_source(*run.simulation));
  PlotSeries series{fmt::format("photons, albedo {}", albedo), {}, {}, color, true, 4, 1};
  for (std::size_t k = 0; k < table.header.offsets.size(); ++k) {
    const float* slice = slice_of(table, 0, static_cast<int>(k));
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < table.header.pixels(); ++i)
      if (!std::isnan(slice[i])) sum += slice[i], count += 1;
    series.x.push_back(length_px(table.header.offsets[k]) * 0.5);
    series.y.push_back(sum / count);
  }
  return series;
}

PlotSeries dipole_profile(double albedo, std::array<float, 3> color) {
  PlotSeries series{albedo == 0.5 ? "dipole (lines)" : "", {}, {}, color};
  constexpr double passed = 1 - 0.0918;  // of Lambertian light, at a refractive index of 1.5
  for (double r = 0.05; r <= 10; r += 0.05) {
    series.x.push_back(r);
    series.y.push_back(passed *
                       eval_dipole({.sigma_a = 1 - albedo, .sigma_s_prime = albedo}, 1.5, r));
  }
  return series;
}

}  // namespace

void study_dipole(const Page& page) {
  write_totals(page);
  Plot plot;
  plot.title = "half-space, eta 1.5, mean free path 1 mm";
  plot.x_label = "r [mm]";
  plot.y_label = "R_d [1/mm^2]";
  plot.log_y = true;
  const std::array<std::array<float, 3>, 3> colors{
      {{0.02f, 0.15f, 0.6f}, {0.7f, 0.15f, 0.02f}, {0.05f, 0.35f, 0.05f}}};
  std::size_t i = 0;
  for (const double albedo : {0.5, 0.9, 0.99}) {
    plot.series.push_back(dipole_profile(albedo, colors[i]));
    plot.series.push_back(measure_profile(albedo, colors[i]));
    ++i;
  }
  write_picture(page, "dipole", draw_plot(plot));
}

}  // namespace parian::photon

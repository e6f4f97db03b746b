// What noise does to the fit: tables with photon or camera noise, fitted by logarithms and with
// their noise model, against the fit of the same table without noise.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/paper_2009/study.h"
#include "judge/row_sums.h"
#include "material/material.h"
#include "material/properties.h"
#include "material/test_noise.h"

namespace parian::paper_2009 {
namespace {

struct NoiseLevel {
  std::string name;
  double gain = 0, floor = 0;
};

BssrdfTable make_sample(const char* sample) {
  Document description = load_sample(sample);
  set(description, "size", Document::Array{48, 48});
  set(description, "radius_px", 12);
  return simulate(description);
}

// Of a map's pixels: albedo over the table's pairs, mean radius, and ln P at the knots.
struct Figures {
  std::vector<double> albedo, radius;
  std::array<std::vector<double>, 3> log_profile;  // of the thirds of the knots
};
// Beyond the last knot a profile goes on with its last slope, which is noise.
double measure_radius(Profile profile, double last_knot_mm) {
  profile.support_mm = std::min(profile.support_mm, last_knot_mm);
  return measure_properties(profile).mean_radius_mm;
}
Figures measure(const ProfileMap& map, const TableHeader& header) {
  Figures figures;
  TableHeader like = header;
  like.noise_floor.clear();
  like.noise_gain.clear();
  const Image albedo = measure_row_sums(*make_slices(Material(map), like)).albedo;
  figures.albedo.assign(albedo.values.begin(), albedo.values.end());
  for (int c = 0; c < map.channels; ++c)
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x)
        figures.radius.push_back(measure_radius(get_profile(map, c, x, y), map.knots_mm.back()));
  for (std::size_t part = 0; part < 3; ++part)
    for (int c = 0; c < map.channels; ++c) {
      const std::size_t knots = map.knots_mm.size(), from = knots * part / 3;
      const std::size_t to = knots * (part + 1) / 3;
      const float* plane = knot_plane(map, c, 0);
      figures.log_profile[part].insert(figures.log_profile[part].end(), plane + from * map.pixels(),
                                       plane + to * map.pixels());
    }
  return figures;
}

struct Deviation {
  double mean = 0, rms = 0;
};
Deviation relative(const std::vector<double>& a, const std::vector<double>& b) {
  Deviation d;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double e = a[i] / b[i] - 1;
    d.mean += e / static_cast<double>(a.size());
    d.rms += e * e / static_cast<double>(a.size());
  }
  return {d.mean, std::sqrt(d.rms)};
}
Deviation absolute(const std::vector<double>& a, const std::vector<double>& b) {
  Deviation d;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double e = a[i] - b[i];
    d.mean += e / static_cast<double>(a.size());
    d.rms += e * e / static_cast<double>(a.size());
  }
  return {d.mean, std::sqrt(d.rms)};
}

std::string show(const Deviation& d) {
  return d.rms < 100 ? fmt::format("{:+.4f} / {:.4f}", d.mean, d.rms) : "diverges";
}

struct Way {
  const char* name;
  bool noise_model;
};
constexpr std::array ways{Way{"logarithms", false}, Way{"noise model", true}};

double share_not_positive(const BssrdfTable& table) {
  double low = 0, all = 0;
  for (float value : table.reflectance) {
    if (std::isnan(value)) continue;
    low += value <= 0;
    all += 1;
  }
  return low / all;
}

void add_rows(const BssrdfTable& clean, const Figures& truth, const NoiseLevel& level,
              const std::string& sample, MarkdownTable& table) {
  BssrdfTable noisy = clean;
  add_noise(noisy, level.gain, level.floor, 7);
  for (const Way& way : ways) {
    FitParams params;
    params.noise_model = way.noise_model;
    const FitResult fit = fit_profiles(*make_slices(noisy), params);
    const Figures figures = measure(fit.map, clean.header);
    const bool first = &way == ways.data();
    table.rows.push_back({first ? sample : "", first ? level.name : "",
                          first ? fmt::format("{:.1f} %", 100 * share_not_positive(noisy)) : "",
                          way.name, show(relative(figures.albedo, truth.albedo)),
                          show(relative(figures.radius, truth.radius)),
                          show(absolute(figures.log_profile[0], truth.log_profile[0])),
                          show(absolute(figures.log_profile[1], truth.log_profile[1])),
                          show(absolute(figures.log_profile[2], truth.log_profile[2])),
                          fmt::format("{}", fit.report.channels[0].steps)});
  }
}

std::vector<NoiseLevel> make_levels(const BssrdfTable& clean) {
  std::vector<NoiseLevel> levels{{"none (variance 0)", 0, 0}};
  for (const int power : {6, 5, 4, 3})
    levels.push_back(
        {fmt::format("10^{} photons", power), photon_gain(clean, std::pow(10, power)), 0});
  std::vector<double> values;
  for (float value : clean.reflectance)
    if (!std::isnan(value)) values.push_back(static_cast<double>(value));
  std::nth_element(values.begin(), values.begin() + std::ssize(values) / 2, values.end());
  const double median = values[values.size() / 2];
  for (const double part : {0.1, 1.0, 5.0})
    levels.push_back({fmt::format("floor {} x median R", part), 0, part * median});
  return levels;
}

}  // namespace

void study_noise(Study& study) {
  MarkdownTable table{{"sample", "noise", "R <= 0", "fit by", "albedo", "mean radius",
                       "ln P, inner third", "middle third", "outer third", "passes"},
                      {}};
  for (const char* sample : {"artificial-stone", "chessboard-small", "jade"}) {
    const BssrdfTable clean = make_sample(sample);
    const Figures truth = measure(fit_profiles(*make_slices(clean), {}).map, clean.header);
    bool first = true;
    for (const NoiseLevel& level : make_levels(clean)) {
      add_rows(clean, truth, level, first ? sample : "", table);
      first = false;
    }
  }
  write_table(
      study, "noise",
      "Bias / root mean square over the pixels, against the fit of the same table without "
      "noise: relative of albedo and mean radius, absolute of ln P. Simulated samples of "
      "48 x 48 pixels, radius 12 px, three channels. Photons: that enter per pixel; the median "
      "R is that of all pairs.",
      table);
}

}  // namespace parian::paper_2009

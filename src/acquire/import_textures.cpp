#include "acquire/import_textures.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>

#include "acquire/import_path_internal.h"
#include "acquire/provenance.h"
#include "base/error.h"
#include "base/parallel.h"
#include "material/dipole.h"

namespace parian {
namespace {

using std::numbers::pi;

// One pixel's curve, in closed form: R(r), and the part of the albedo inside r.
struct RadialModel {
  TextureModel model = TextureModel::burley;
  double albedo = 0.5;
  double decay = 1;           // Burley: s / l in 1/mm
  DipoleCoefficients medium;  // dipole
  double eta = 1.3;
  double unit_mm = 1;   // over which it changes near the middle
  double reach_mm = 1;  // beyond lies 1e-3 of the albedo or so
};

// Burley 2015: fits of s for diffuse light at the surface, by the mean free path and by the diffuse
// mean free path.
double burley_shape(double albedo, TextureRadius radius) {
  if (radius == TextureRadius::mean_free_path)
    return 1.9 - albedo + 3.5 * (albedo - 0.8) * (albedo - 0.8);
  return 3.5 + 100 * std::pow(albedo - 0.33, 4);
}

RadialModel make_model(const TextureImport& import, double albedo, double radius_mm) {
  RadialModel model{.model = import.model, .albedo = albedo, .eta = import.eta};
  if (import.model == TextureModel::burley) {
    model.decay = burley_shape(albedo, import.radius) / radius_mm;
    model.unit_mm = 1 / model.decay;
    model.reach_mm = 20 / model.decay;
    return model;
  }
  const double alpha = invert_dipole_albedo(albedo, import.eta);
  const double ratio = std::sqrt(3 * (1 - alpha));  // l sigma_tr
  const double l = import.radius == TextureRadius::mean_free_path ? radius_mm : radius_mm * ratio;
  model.medium = {.sigma_a = (1 - alpha) / l, .sigma_s_prime = alpha / l};
  model.unit_mm = l;
  model.reach_mm = std::min(40.0, 3 + 9 / ratio) * l;
  return model;
}

double eval(const RadialModel& model, double r) {
  if (model.model == TextureModel::dipole) return eval_dipole(model.medium, model.eta, r);
  return model.albedo * model.decay / (8 * pi * r) *
         (std::exp(-model.decay * r) + std::exp(-model.decay * r / 3));
}

// 2 pi int_0^r R r dr. A pole at depth z: int z (sigma_tr + 1/d) e^(-sigma_tr d) / d dd
// = e^(-sigma_tr z) - z e^(-sigma_tr d) / d.
double albedo_inside(const RadialModel& model, double r) {
  if (model.model == TextureModel::burley) {
    const double x = model.decay * r;
    return model.albedo * (-0.25 * std::expm1(-x) - 0.75 * std::expm1(-x / 3));
  }
  const double sigma_t = model.medium.sigma_a + model.medium.sigma_s_prime;
  const double sigma_tr = std::sqrt(3 * model.medium.sigma_a * sigma_t);
  const double z_real = 1 / sigma_t;
  const double z_image = z_real * (1 + 4.0 / 3.0 * dipole_boundary_factor(model.eta));
  const auto pole = [&](double z) {
    const double d = std::hypot(r, z);
    return std::exp(-sigma_tr * z) - z / d * std::exp(-sigma_tr * d);
  };
  return model.medium.sigma_s_prime / sigma_t / 2 * (pole(z_real) + pole(z_image));
}

double read_radius(const TextureImport& import, int x, int y, int c) {
  const double smallest = import.pixel_pitch_mm / 4;
  const double radius = at(import.radius_mm, x, y, std::min(c, import.radius_mm.channels - 1));
  return std::max(smallest, radius);
}
double read_albedo(const TextureImport& import, int x, int y, int c) {
  const double albedo = at(import.albedo, x, y, std::min(c, import.albedo.channels - 1));
  return std::clamp(albedo, min_texture_albedo, max_texture_albedo);
}

std::size_t count_limited(const TextureImport& import, int channels) {
  std::size_t count = 0;
  for (int y = 0; y < import.albedo.height; ++y)
    for (int x = 0; x < import.albedo.width; ++x)
      for (int c = 0; c < channels; ++c) {
        const float albedo = at(import.albedo, x, y, std::min(c, import.albedo.channels - 1));
        const float radius = at(import.radius_mm, x, y, std::min(c, import.radius_mm.channels - 1));
        if (albedo < static_cast<float>(min_texture_albedo) ||
            albedo > static_cast<float>(max_texture_albedo) ||
            radius < static_cast<float>(import.pixel_pitch_mm / 4))
          ++count;
      }
  return count;
}

// r_k = a sinh(k h): even near the middle, where the narrowest profile changes, then in ratios.
std::vector<double> choose_knots(double unit_mm, double reach_mm, int segments) {
  const double a = unit_mm / 4;
  const double h = std::asinh(reach_mm / a) / segments;
  std::vector<double> knots(static_cast<std::size_t>(segments) + 1);
  for (std::size_t k = 0; k < knots.size(); ++k)
    knots[k] = a * std::sinh(static_cast<double>(k) * h);
  return knots;
}

// ln P(0) with which the first segment holds `integral` = int P r dr. It rises with ln P(0).
double solve_first_knot(double r1, double y1, double integral) {
  double low = y1, high = y1 + 60;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (segment_integral(0, r1, middle, y1) < integral ? low : high) = middle;
  }
  return (low + high) / 2;
}

std::vector<double> make_log_profile(const RadialModel& model, const std::vector<double>& knots) {
  constexpr double smallest = 1e-37;
  std::vector<double> y(knots.size());
  for (std::size_t k = 1; k < knots.size(); ++k)
    y[k] = std::log(std::max(smallest, eval(model, knots[k])));
  y[0] = solve_first_knot(knots[1], y[1], albedo_inside(model, knots[1]) / (2 * pi));
  const double shift = std::log(model.albedo / diffuse_albedo(make_profile(knots, y)));
  for (double& value : y) value += shift;
  return y;
}

double scale_of(const Document& document) {
  const Document* scale = find(document, "scale_mm");
  return scale != nullptr ? as_number(*scale, 1e-6, 1e6) : 1;
}

void check_range(const Image& image, const std::string& name, float max) {
  for (std::size_t i = 0; i < image.values.size(); ++i)
    if (!(image.values[i] >= 0 && image.values[i] <= max)) {
      const std::size_t pixel = i / static_cast<std::size_t>(image.channels);
      const auto width = static_cast<std::size_t>(image.width);
      throw Error({name, fmt::format("pixel ({}, {})", pixel % width, pixel / width),
                   max == 1.0f ? "a value in [0, 1]" : "a value of at least 0",
                   fmt::format("{}", image.values[i])});
    }
}

}  // namespace

double invert_dipole_albedo(double albedo, double eta) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    const double found = dipole_albedo({.sigma_a = 1 - middle, .sigma_s_prime = middle}, eta);
    (found < albedo ? low : high) = middle;
  }
  return (low + high) / 2;
}

TextureImport read_texture_import(const Document& document, const ImageLoader& load_image,
                                  const ImageLoader& load_data) {
  check_keys(document,
             {"$schema", "kind", "description", "albedo", "mean_free_path",
              "diffuse_mean_free_path", "scale_mm", "pitch_mm", "model", "eta", "segments"});
  TextureImport import;
  import.pixel_pitch_mm = as_number(get(document, "pitch_mm"), 1e-6, 1e6);
  if (const Document* eta = find(document, "eta")) import.eta = as_number(*eta, 1, 4);
  if (const Document* segments = find(document, "segments"))
    import.segments = as_int(*segments, 2, 256);
  if (const Document* model = find(document, "model")) {
    const std::string& name = as_string(*model);
    if (name != "burley" && name != "dipole")
      throw_at(*model, "'burley' or 'dipole'", fmt::format("'{}'", name));
    import.model = name == "dipole" ? TextureModel::dipole : TextureModel::burley;
  }
  const Document* path = find(document, "mean_free_path");
  const Document* diffuse = find(document, "diffuse_mean_free_path");
  if ((path == nullptr) == (diffuse == nullptr))
    throw_at(document, "one of the keys 'mean_free_path' and 'diffuse_mean_free_path'",
             path != nullptr ? "both" : "neither");
  if (diffuse != nullptr) import.radius = TextureRadius::diffuse_mean_free_path;
  const std::string albedo_name = path_beside(document, as_string(get(document, "albedo")));
  import.albedo = load_image(albedo_name);
  check_range(import.albedo, albedo_name, 1);
  const Document& radius = diffuse != nullptr ? *diffuse : *path;
  const auto scale_mm = static_cast<float>(scale_of(document));
  if (std::holds_alternative<double>(radius.value)) {
    import.radius_mm = make_image(import.albedo.width, import.albedo.height, 1,
                                  static_cast<float>(as_number(radius, 1e-6, 1e6)) * scale_mm);
    return import;
  }
  const std::string radius_name = path_beside(document, as_string(radius));
  import.radius_mm = scale(load_data(radius_name), scale_mm);
  if (import.radius_mm.width != import.albedo.width ||
      import.radius_mm.height != import.albedo.height)
    throw Error({radius_name, "size",
                 fmt::format("{} x {} pixels, as '{}' has", import.albedo.width,
                             import.albedo.height, albedo_name),
                 fmt::format("{} x {}", import.radius_mm.width, import.radius_mm.height)});
  check_range(import.radius_mm, radius_name, std::numeric_limits<float>::max());
  return import;
}

TextureMap make_texture_map(const TextureImport& import) {
  const int width = import.albedo.width, height = import.albedo.height;
  const int channels = std::max(import.albedo.channels, import.radius_mm.channels);
  double unit = std::numeric_limits<double>::infinity(), reach = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c) {
        const RadialModel model =
            make_model(import, read_albedo(import, x, y, c), read_radius(import, x, y, c));
        unit = std::min(unit, model.unit_mm);
        reach = std::max(reach, model.reach_mm);
      }
  TextureMap made{.map = make_profile_map(width, height, channels, import.pixel_pitch_mm,
                                          choose_knots(unit, reach, import.segments)),
                  .limited = count_limited(import, channels)};
  ProfileMap& map = made.map;
  map.boundary = Boundary::included;
  map.eta = import.eta;
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < channels; ++c) {
        const std::vector<double> log_profile = make_log_profile(
            make_model(import, read_albedo(import, x, y, c), read_radius(import, x, y, c)),
            map.knots_mm);
        const std::size_t pixel =
            row * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
        for (std::size_t k = 0; k < log_profile.size(); ++k)
          knot_plane(map, c, static_cast<int>(k))[pixel] = static_cast<float>(log_profile[k]);
      }
  });
  return made;
}

}  // namespace parian

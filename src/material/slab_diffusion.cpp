#include "material/slab_diffusion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/error.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;

// tanh(s h) / s
double tanh_over(double s, double h) {
  const double x = s * h;
  return x < 1e-6 ? h * (1 - x * x / 3) : std::tanh(x) / s;
}

// Admittance D phi' / phi at the near side of a layer from that at its far side.
double admit(double D, double s, double h, double far) {
  const double t = tanh_over(s, h);
  return (far + D * s * s * t) / (1 + far * t / D);
}

// phi at the far side over phi at the near one.
double attenuate(double D, double s, double h, double far) {
  const double x = s * h, decay = std::exp(-x), square = decay * decay;
  const double sinh_over = x < 1e-6 ? h : -std::expm1(-2 * x) / (2 * s);  // e^-x sinh(x) / s
  return decay / (0.5 * (1 + square) + far * sinh_over / D);
}

// Towards a side: the admittance there, seen from the source, and what is left of phi.
struct Side {
  double admittance = 0;  // at the source
  double outer = 0;       // at the surface; 0 without one
  double fluence = 0;     // phi at the surface over phi at the source
};

// `layers` from the surface to the source, the last as thick as there is of it.
Side look(const std::vector<std::pair<const DiffusionMedium*, double>>& layers, double q) {
  Side side;
  side.fluence = 1;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const DiffusionMedium& medium = *layers[i].first;
    const double s = std::hypot(medium.sigma_tr, q), h = layers[i].second;
    if (i == 0 && h == 0) {  // without end
      side = {medium.D * s, 0, 0};
      continue;
    }
    if (i == 0) side.admittance = side.outer = medium.D / tanh_over(s, medium.extrapolation_mm);
    side.fluence *= attenuate(medium.D, s, h, side.admittance);
    side.admittance = admit(medium.D, s, h, side.admittance);
  }
  return side;
}

struct Sides {
  std::vector<std::pair<const DiffusionMedium*, double>> above, below;
};

Sides split(const SlabStack& stack) {
  Sides sides;
  const std::size_t source = stack.source_layer;
  for (std::size_t i = 0; i < source; ++i)
    sides.above.emplace_back(&stack.layers[i].medium, stack.layers[i].thickness_mm);
  sides.above.emplace_back(&stack.layers[source].medium, stack.source_in_layer_mm);
  for (std::size_t i = stack.layers.size(); i-- > source;) {
    const SlabLayer& layer = stack.layers[i];
    const double start = i == source ? stack.source_in_layer_mm : 0;
    sides.below.emplace_back(&layer.medium,
                             layer.thickness_mm == 0 ? 0 : layer.thickness_mm - start);
  }
  return sides;
}

SlabSpectrum eval_sides(const SlabStack& stack, const Sides& sides, double q) {
  const DiffusionMedium& source = stack.layers[stack.source_layer].medium;
  const Side up = look(sides.above, q), down = look(sides.below, q);
  const double phi = source.alpha_prime / (up.admittance + down.admittance);
  const auto leave = [&](const DiffusionMedium& medium, const Side& side) {
    return phi * side.fluence * (medium.C_phi + medium.C_E * side.outer);
  };
  return {leave(stack.layers.front().medium, up), leave(stack.layers.back().medium, down)};
}

// 8-point Gauss-Legendre on [-1, 1].
constexpr std::array<double, 4> gauss_node{0.1834346424956498, 0.5255324099163290,
                                           0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> gauss_weight{0.3626837833783620, 0.3137066458778873,
                                             0.2223810344533745, 0.1012285362903763};

// 1/(2 pi) int f(q) J_0(q r) q dq: panels no wider than half a wave of J_0, narrow where q is small
// beside 1 / scale, until f has faded.
template <typename Spectrum>
double invert(const Spectrum& spectrum, double r, double scale_mm) {
  double sum = 0, size = 0, q = 0;
  for (int faded = 0; faded < 3;) {
    double width = std::max(0.25 / scale_mm, 0.25 * q);
    if (r > 0) width = std::min(width, pi / r);
    double panel = 0, largest = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      const double x = i < 4 ? gauss_node[i] : -gauss_node[i - 4];
      const double at = q + 0.5 * width * (1 + x);
      const double value = spectrum(at) * at * 0.5 * width * gauss_weight[i % 4];
      panel += value * ::j0(at * r);
      largest = std::max(largest, std::abs(value));
    }
    sum += panel;
    size += largest;
    q += width;
    faded = largest < 1e-16 * size ? faded + 1 : 0;
  }
  return sum / (2 * pi);
}

template <typename Spectrum>
TabulatedCurve tabulate(const Spectrum& spectrum, double unit_mm, double scale_mm) {
  TabulatedCurve curve{.unit_mm = unit_mm, .step = 0.06};
  curve.total = spectrum(0.0);
  // Beyond, values drown in the rounding of their transform.
  constexpr double least = 1e-9;
  constexpr std::size_t most = 200;
  double first = 0;
  for (std::size_t i = 0; i < most; ++i) {
    const double r = unit_mm * std::sinh(static_cast<double>(i) * curve.step);
    const double value = invert(spectrum, r, scale_mm);
    if (i == 0) first = value;
    if (!(value > least * first)) break;
    curve.log_value.push_back(std::log(value));
  }
  const auto& y = curve.log_value;
  const std::size_t n = y.size();
  if (n < 4) {  // nothing comes through
    curve.log_value.clear();
    return curve;
  }
  curve.slope.resize(n);
  for (std::size_t i = 2; i + 2 < n; ++i)
    curve.slope[i] = (y[i - 2] - 8 * y[i - 1] + 8 * y[i + 1] - y[i + 2]) / 12;
  curve.slope[0] = 0;  // R_d is even in r
  curve.slope[1] = 0.5 * (y[2] - y[0]);
  curve.slope[n - 2] = 0.5 * (y[n - 1] - y[n - 3]);
  curve.slope[n - 1] = 0.5 * (3 * y[n - 1] - 4 * y[n - 2] + y[n - 3]);
  const double t = static_cast<double>(n - 1) * curve.step;
  curve.tail_slope = curve.slope[n - 1] / curve.step / (unit_mm * std::cosh(t));
  return curve;
}

double depth_of(const SlabStack& stack) {
  double depth = 0;
  for (const SlabLayer& layer : stack.layers) depth += layer.thickness_mm;
  return depth;
}

// What the spectrum changes over: everything that lies above the last interface.
double scale_of(const SlabStack& stack) {
  double scale = depth_of(stack);
  for (const SlabLayer& layer : stack.layers)
    scale += 2 * layer.medium.extrapolation_mm + layer.medium.mean_free_path_mm;
  return scale;
}

double source_depth(const SlabStack& stack) {
  double depth = stack.source_in_layer_mm;
  for (std::size_t i = 0; i < stack.source_layer; ++i) depth += stack.layers[i].thickness_mm;
  return depth;
}

// One transport mean free path down from the lit side.
void place_source(SlabStack& stack) {
  double left = 1;  // of the optical depth
  for (std::size_t i = 0; i < stack.layers.size(); ++i) {
    const SlabLayer& layer = stack.layers[i];
    const double optical = layer.thickness_mm / layer.medium.mean_free_path_mm;
    if (layer.thickness_mm == 0 || optical > left) {
      stack.source_layer = i;
      stack.source_in_layer_mm = left * layer.medium.mean_free_path_mm;
      return;
    }
    left -= optical;
  }
  throw Error({.place = "thickness_mm",
               .expected = "more than one transport mean free path 1 / (sigma_a + sigma_s') in all",
               .found = fmt::format("{:.3g} of them", 1 - left)});
}

}  // namespace

SlabStack make_slab_stack(const Dipole& material, std::size_t channel) {
  if (material.model == DiffusionModel::normalized)
    throw Error({.place = "model",
                 .expected = "'classic' or 'better' beside 'thickness_mm'",
                 .found = "'normalized', which has half-spaces only"});
  SlabStack stack;
  const auto add = [&](const std::vector<DipoleCoefficients>& channels, double thickness_mm) {
    PARIAN_CHECK(channel < channels.size());
    stack.layers.push_back(
        {make_diffusion_medium(channels[channel], material.eta, material.model), thickness_mm});
  };
  add(material.channels, material.thickness_mm);
  for (const DipoleLayer& layer : material.below) {
    PARIAN_CHECK(stack.layers.back().thickness_mm > 0);  // only the last has no end
    add(layer.channels, layer.thickness_mm);
  }
  place_source(stack);
  return stack;
}

SlabSpectrum eval_spectrum(const SlabStack& stack, double q) {
  return eval_sides(stack, split(stack), q);
}

TabulatedCurve tabulate_reflectance(const SlabStack& stack) {
  const Sides sides = split(stack);
  return tabulate([&](double q) { return eval_sides(stack, sides, q).reflectance; },
                  source_depth(stack), scale_of(stack));
}

TabulatedCurve tabulate_transmittance(const SlabStack& stack) {
  const Sides sides = split(stack);
  if (stack.layers.back().thickness_mm == 0) return {};
  return tabulate([&](double q) { return eval_sides(stack, sides, q).transmittance; },
                  depth_of(stack) - source_depth(stack), scale_of(stack));
}

double eval_tabulated(const TabulatedCurve& curve, double r_mm) {
  if (curve.log_value.empty()) return 0;
  const double place = std::asinh(r_mm / curve.unit_mm) / curve.step;
  const std::size_t last = curve.log_value.size() - 1;
  if (place >= static_cast<double>(last)) {
    const double end = curve.unit_mm * std::sinh(static_cast<double>(last) * curve.step);
    return std::exp(curve.log_value[last] + curve.tail_slope * (r_mm - end));
  }
  const auto i = static_cast<std::size_t>(place);
  const double t = place - static_cast<double>(i), u = 1 - t;
  const double a = curve.log_value[i], b = curve.log_value[i + 1];
  // Hermite.
  return std::exp(u * u * (1 + 2 * t) * a + t * t * (1 + 2 * u) * b +
                  t * u * (u * curve.slope[i] - t * curve.slope[i + 1]));
}

}  // namespace parian

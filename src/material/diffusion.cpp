#include "material/diffusion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "material/slab_diffusion.h"

namespace parian {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double tail_part = 1e-3;
// Rings of r = e^t for sums over a curve.
constexpr double log_step = 0.01, log_reach = 16;

// Unpolarised, from a medium of relative index eta inside, mu its cosine there and t outside.
double reflect(double eta, double mu, double t) {
  const double parallel = (mu - eta * t) / (mu + eta * t);
  const double perpendicular = (eta * mu - t) / (eta * mu + t);
  return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

PoleSum make_poles(const DiffusionMedium& medium) {
  const double flux = 0.5 * medium.alpha_prime * medium.C_E;
  const double density = medium.alpha_prime * medium.C_phi / (2 * medium.D);
  const double z = medium.mean_free_path_mm;
  return {.sigma_tr = medium.sigma_tr,
          .real = {z, flux, density},
          .image = {z + 2 * medium.extrapolation_mm, flux, -density}};
}

// (1 - e^(-x)) / x
double fall(double x) {
  return x < 1e-12 ? 1 : -std::expm1(-x) / x;
}

double eval_normalized(double total, double decay, double r) {
  return total * decay / (8 * pi * r) * (std::exp(-decay * r) + std::exp(-decay * r / 3));
}

NormalizedDiffusion make_normalized(double total, double mean_free_path_mm) {
  // The fit for diffuse light at the surface and the mean free path.
  const double s = 1.9 - total + 3.5 * (total - 0.8) * (total - 0.8);
  NormalizedDiffusion curve{
      .total = total, .decay_per_mm = s / mean_free_path_mm, .centre_mm = 0.01 * mean_free_path_mm};
  const double x = curve.decay_per_mm * curve.centre_mm;
  const double inside = -0.25 * std::expm1(-x) - 0.75 * std::expm1(-x / 3);
  curve.centre = total * inside / (pi * curve.centre_mm * curve.centre_mm);
  return curve;
}

double eval(const PoleSum& sum, double r) {
  const auto eval_pole = [&](const PoleSum::Pole& pole) {
    const double d = std::hypot(r, pole.z_mm);
    return (pole.flux * pole.z_mm * (sum.sigma_tr + 1 / d) / (d * d) + pole.density / d) *
           std::exp(-sum.sigma_tr * d);
  };
  return (eval_pole(sum.real) + eval_pole(sum.image)) / (2 * pi);
}

double eval(const NormalizedDiffusion& curve, double r) {
  return r < curve.centre_mm ? curve.centre : eval_normalized(curve.total, curve.decay_per_mm, r);
}

double eval(const TabulatedCurve& curve, double r) {
  return eval_tabulated(curve, r);
}

double total(const PoleSum& sum) {
  const auto total_pole = [&](const PoleSum::Pole& pole) {
    const double x = sum.sigma_tr * pole.z_mm;
    // int e^(-s d) / d r dr = e^(-s z) / s; as the densities cancel, 1 / s may be taken off.
    return pole.flux * std::exp(-x) - pole.density * pole.z_mm * fall(x);
  };
  return total_pole(sum.real) + total_pole(sum.image);
}
double total(const NormalizedDiffusion& curve) {
  return curve.total;
}
double total(const TabulatedCurve& curve) {
  return curve.total;
}

double eval_ring(const ReflectanceCurve& curve, double t) {
  const double r = std::exp(t);
  return 2 * pi * r * r * log_step * eval_curve(curve, r);
}

}  // namespace

FresnelMoments fresnel_moments(double eta) {
  // By the cosine outside where all light gets in, and by that inside where all gets out: nothing
  // has a kink then, and Simpson's rule converges.
  constexpr int steps = 512;
  FresnelMoments moments;
  const double critical = eta > 1 ? std::sqrt(1 - 1 / (eta * eta)) : 0;
  moments.first = 0.5 * critical * critical;
  moments.second = critical * critical * critical / 3;
  for (int i = 0; i <= steps; ++i) {
    const double x = static_cast<double>(i) / steps;
    const double weight = (i == 0 || i == steps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) / (3.0 * steps);
    const double mu = eta > 1 ? std::sqrt(1 - (1 - x * x) / (eta * eta)) : x;
    const double t = eta > 1 ? x : std::sqrt(1 - eta * eta * (1 - x * x));
    const double dmu_mu = eta > 1 ? x / (eta * eta) : x;  // mu dmu
    if (eta == 1 || (mu == 0 && t == 0)) continue;
    const double F = reflect(eta, mu, t);
    moments.first += weight * F * dmu_mu;
    moments.second += weight * F * dmu_mu * mu;
  }
  return moments;
}

DiffusionMedium make_diffusion_medium(const DipoleCoefficients& medium, double eta,
                                      DiffusionModel model) {
  DiffusionMedium made;
  const double sigma_t_prime = medium.sigma_a + medium.sigma_s_prime;
  made.mean_free_path_mm = 1 / sigma_t_prime;
  made.alpha_prime = medium.sigma_s_prime / sigma_t_prime;
  if (model == DiffusionModel::classic) {
    made.D = 1 / (3 * sigma_t_prime);
    made.extrapolation_mm = 2 * dipole_boundary_factor(eta) * made.D;
  } else {
    const FresnelMoments moments = fresnel_moments(eta);
    made.D = (2 * medium.sigma_a + medium.sigma_s_prime) / (3 * sigma_t_prime * sigma_t_prime);
    made.extrapolation_mm = 2 * (1 + 3 * moments.second) / (1 - 2 * moments.first) * made.D;
    made.C_phi = 0.25 * (1 - 2 * moments.first);
    made.C_E = 0.5 * (1 - 3 * moments.second);
  }
  made.sigma_tr = std::sqrt(medium.sigma_a / made.D);
  return made;
}

ReflectanceCurve make_reflectance_curve(const Dipole& material, std::size_t channel) {
  PARIAN_CHECK(channel < material.channels.size());
  const DipoleCoefficients& top = material.channels[channel];
  const CurveGain& gain = material.reflectance_gain;
  if (material.thickness_mm > 0 || !material.below.empty())
    return {tabulate_reflectance(make_slab_stack(material, channel)), gain};
  if (!(top.sigma_s_prime > 0)) return {PoleSum{}, gain};
  if (material.model != DiffusionModel::normalized)
    return {make_poles(make_diffusion_medium(top, material.eta, material.model)), gain};
  const DiffusionMedium better = make_diffusion_medium(top, material.eta, DiffusionModel::better);
  return {make_normalized(total(make_poles(better)), better.mean_free_path_mm), gain};
}

double eval_curve(const ReflectanceCurve& curve, double r_mm) {
  return eval_gain(curve.gain, r_mm) *
         std::visit([&](const auto& made) { return eval(made, r_mm); }, curve.model);
}

double total_of(const ReflectanceCurve& curve) {
  if (curve.gain.empty())
    return std::visit([](const auto& made) { return total(made); }, curve.model);
  double sum = 0;
  for (double t = -log_reach; t < log_reach; t += log_step) sum += eval_ring(curve, t);
  return sum;
}

double support_of(const ReflectanceCurve& curve) {
  // Inwards, until the rings hold the part that may be left out.
  const double enough = tail_part * total_of(curve);
  if (!(enough > 0)) return 0;
  double tail = 0, t = log_reach;
  for (; t > -log_reach && tail < enough; t -= log_step) tail += eval_ring(curve, t);
  return std::exp(t);
}

}  // namespace parian

#include "material/dipole.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace parian {

double fresnel_diffuse_reflectance(double eta) {
  if (eta >= 1) return -1.440 / (eta * eta) + 0.710 / eta + 0.668 + 0.0636 * eta;
  return -0.4399 + 0.7099 / eta - 0.3319 / (eta * eta) + 0.0636 / (eta * eta * eta);
}

double dipole_boundary_factor(double eta) {
  const double F_dr = fresnel_diffuse_reflectance(eta);
  return (1 + F_dr) / (1 - F_dr);
}

double eval_gain(const CurveGain& gain, double mm) {
  if (gain.empty()) return 1;
  const auto after = std::find_if(gain.begin(), gain.end(),
                                  [mm](const CurvePoint& point) { return point.mm > mm; });
  if (after == gain.begin()) return gain.front().factor;
  if (after == gain.end()) return gain.back().factor;
  const CurvePoint &a = *(after - 1), &b = *after;
  return a.factor + (mm - a.mm) / (b.mm - a.mm) * (b.factor - a.factor);
}

// Xu et al. 2007, Eq. 4 and Table 1; z_v is the height of the virtual source, positive.
double eval_dipole(const DipoleCoefficients& medium, double eta, double r_mm) {
  if (!(medium.sigma_s_prime > 0)) return 0;
  const double sigma_t_prime = medium.sigma_a + medium.sigma_s_prime;
  const double alpha_prime = medium.sigma_s_prime / sigma_t_prime;
  const double sigma_tr = std::sqrt(3 * medium.sigma_a * sigma_t_prime);
  const double z_r = 1 / sigma_t_prime;
  const double z_v = z_r * (1 + 4.0 / 3.0 * dipole_boundary_factor(eta));
  const auto source = [&](double z) {
    const double d = std::hypot(r_mm, z);
    return z * (sigma_tr + 1 / d) * std::exp(-sigma_tr * d) / (d * d);
  };
  return alpha_prime / (4 * std::numbers::pi) * (source(z_r) + source(z_v));
}

double dipole_albedo(const DipoleCoefficients& medium, double eta) {
  if (!(medium.sigma_s_prime > 0)) return 0;
  const double sigma_t_prime = medium.sigma_a + medium.sigma_s_prime;
  const double alpha_prime = medium.sigma_s_prime / sigma_t_prime;
  // s = sqrt(3 (1 - alpha')), without the cancellation of 1 - alpha'.
  const double s = std::sqrt(3 * medium.sigma_a / sigma_t_prime);
  return alpha_prime / 2 * (1 + std::exp(-4.0 / 3.0 * dipole_boundary_factor(eta) * s)) *
         std::exp(-s);
}

}  // namespace parian

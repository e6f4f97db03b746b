// R_d(r) of homogeneous materials by every model that Dipole::model and its layers name. A curve is
// made once per change of the coefficients and then evaluated at any r.
//
// All are per transmitted flux, Boundary::excluded: with no absorption the totals of reflectance
// and transmittance add up to 1.
#pragma once

#include <cstddef>
#include <variant>
#include <vector>

#include "material/dipole.h"

namespace parian {

// First and second moments of the Fresnel reflectance seen from inside: int_0^1 F mu^k dmu.
struct FresnelMoments {
  double first = 0;   // C_1; 2 C_1 is the diffuse reflectance that the polynomial approximates
  double second = 0;  // C_2
};
FresnelMoments fresnel_moments(double eta);

// D, boundary and exitance of a medium in one of the diffusion models.
struct DiffusionMedium {
  double D = 0;                  // mm; fluence diffuses with D laplace(phi) = sigma_a phi
  double sigma_tr = 0;           // 1/mm, sqrt(sigma_a / D)
  double mean_free_path_mm = 0;  // 1 / sigma_t', the depth of the source
  double alpha_prime = 0;
  double extrapolation_mm = 0;  // z_b = 2 A D: phi vanishes so far outside
  double C_phi = 0, C_E = 1;    // R_d = alpha' (C_phi phi + C_E E) at the surface
};
DiffusionMedium make_diffusion_medium(const DipoleCoefficients& medium, double eta,
                                      DiffusionModel model);

// Half-spaces: R_d(r) = sum over sources of (flux z (sigma_tr + 1 / d) / d^2 + density / d)
// e^(-sigma_tr d) / (2 pi), d^2 = r^2 + z^2. The densities add up to 0.
struct PoleSum {
  struct Pole {
    double z_mm = 0, flux = 0, density = 0;
  };
  double sigma_tr = 0;
  Pole real, image;
};

// Burley 2015: total s / (8 pi l r) (e^(-s r / l) + e^(-s r / 3 l)), which is infinite at r = 0:
// the mean over the disc of 0.01 l stands for it there, so that the total holds.
struct NormalizedDiffusion {
  double total = 0;
  double decay_per_mm = 0;  // s / l
  double centre_mm = 0;     // 0.01 l
  double centre = 0;        // the mean over it
};

// ln R_d at asinh(r / unit_mm) = i step, cubic between, exponential beyond. To 1e-5 where R_d is
// above 1e-8 of its largest value.
struct TabulatedCurve {
  double unit_mm = 1, step = 1;
  std::vector<double> log_value;
  std::vector<double> slope;  // d ln R / d(asinh / step)
  double total = 0;
  double tail_slope = 0;  // d ln R / dr beyond, 1/mm
};

struct ReflectanceCurve {
  std::variant<PoleSum, NormalizedDiffusion, TabulatedCurve> model;
  CurveGain gain = {};
};

// Channel c of the material. Throws Error where a stack is thinner than one transport mean free
// path, or normalised diffusion is asked for a stack.
ReflectanceCurve make_reflectance_curve(const Dipole& material, std::size_t channel);
// Per area, in 1/mm^2.
double eval_curve(const ReflectanceCurve& curve, double r_mm);
// 2 pi int R_d r dr; to 1e-4 where the curve was edited.
double total_of(const ReflectanceCurve& curve);
// Beyond it lies 1e-3 of the total: R_d falls slowly where little is absorbed, and cut at 1e-4 of
// R_d(0) it would lose 3 % and more.
double support_of(const ReflectanceCurve& curve);

}  // namespace parian

// Homogeneous materials, and the classic dipole (Jensen et al. 2001), per transmitted flux: Fresnel
// transmission at entry and exit is not in it (Boundary::excluded). Other models: diffusion.h.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace parian {

// One channel's coefficients in 1/mm.
struct DipoleCoefficients {
  double sigma_a = 0.01;
  double sigma_s_prime = 1;  // (1 - g) sigma_s
  double g = 0;              // mean cosine of scattering angles, in (-1, 1): single scattering only
  friend bool operator==(const DipoleCoefficients&, const DipoleCoefficients&) = default;
};

enum class DiffusionModel {
  classic,     // Jensen et al. 2001
  better,      // d'Eon 2012: Grosjean's D, exact Fresnel moments, exitance by C_phi and C_E
  normalized,  // Burley 2015, with the better dipole's total; half-spaces only
};

// A slab under others.
struct DipoleLayer {
  std::vector<DipoleCoefficients> channels;  // as many as the material above
  double thickness_mm = 0;                   // 0: without end, only as the last
  friend bool operator==(const DipoleLayer&, const DipoleLayer&) = default;
};

// A curve that was edited by hand: factors at increasing lengths, linear between, constant beyond.
struct CurvePoint {
  double mm = 0, factor = 1;
  friend bool operator==(const CurvePoint&, const CurvePoint&) = default;
};
using CurveGain = std::vector<CurvePoint>;  // empty: 1 everywhere
double eval_gain(const CurveGain& gain, double mm);

// A homogeneous half-space or a slab, or a stack of slabs of one refractive index, lit from above.
struct Dipole {
  std::vector<DipoleCoefficients> channels;  // 1, or 3: linear Rec. 709
  double eta = 1.3;
  bool single_scattering = false;  // light that scatters once counts beside R_d (Xu et al., Eq. 5)
  DiffusionModel model = DiffusionModel::classic;
  double thickness_mm = 0;  // 0: without end
  std::vector<DipoleLayer> below = {};
  CurveGain reflectance_gain = {};  // of R_d over r, all channels
  CurveGain attenuation_gain = {};  // of E = e^(-sigma_t s) over s (Xu et al., Eq. 6)
  friend bool operator==(const Dipole&, const Dipole&) = default;
};

// sigma_s = sigma_s' / (1 - g)
inline double sigma_s_of(const DipoleCoefficients& medium) {
  return medium.sigma_s_prime / (1 - medium.g);
}

// Average diffuse Fresnel reflectance, the polynomial of Egan and Hilgeman as in Jensen et al.
double fresnel_diffuse_reflectance(double eta);
// A = (1 + F_dr) / (1 - F_dr)
double dipole_boundary_factor(double eta);
// R_d(r) in 1/mm^2; r in mm.
double eval_dipole(const DipoleCoefficients& medium, double eta, double r_mm);
// 2 pi int R_d r dr = (alpha'/2) (1 + e^{-4/3 A s}) e^{-s}, s = sqrt(3 (1 - alpha')).
double dipole_albedo(const DipoleCoefficients& medium, double eta);

// Measured homogeneous materials shipped with Parian (docs/samples.md names the sources).
struct NamedMaterial {
  std::string name;
  std::string source;
  std::array<DipoleCoefficients, 3> channels;
  double eta = 1.3;
};
const std::vector<NamedMaterial>& named_materials();
// Throws Error naming the nearest known name.
const NamedMaterial& find_named_material(std::string_view name);

}  // namespace parian

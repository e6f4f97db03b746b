// What live editing of a homogeneous material keeps of an object under its lights (Xu et al. 2007):
// for every place x_o on the surface, usually the vertices, and for every light
//
//   T_j(x_o) = int B_j(|x_o - x_i|) I(x_i) dA                          (Eq. 10)
//   S_j(x_o) = int int G(w_i') B_j(s_i' + s) F_t L ds dw,  G = (1, w_i')  (Eq. 15)
//
// from which the radiance follows for any coefficients, curves and colours of lights:
//
//   L(x_o, w_o) = F_t(w_o) ( 1/pi sum_j c_j T_j + sigma_s H(w_o') . sum_j e_j S_j )   (Eq. 9, 14)
//
// H = (1, -3 g w_o') / 4 pi with w pointing away from the surface: light that goes straight on has
// w_i' = -w_o'.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "base/aligned.h"
#include "material/dipole.h"
#include "math/spline_basis.h"
#include "math/vec.h"
#include "transport/curve_basis.h"

namespace parian {

// Places that kernels treat side by side.
inline constexpr std::size_t transport_lanes = 8;

// Values of all places as half floats, [block of places][function][component][lane]; component is
// the channel of T, or [4][channel] of S. A value is its half times scale[function]. Idle lanes of
// the last block are 0.
struct PackedTransport {
  std::size_t places = 0;
  std::size_t functions = 0;
  std::size_t components = 0;
  std::vector<float> scale;
  AlignedVector<std::uint16_t> half;
};
// From value[place][function][component], all finite. To half an ulp: 2^-11 of a value, or 2^-24 of
// its function's largest where that is more.
PackedTransport pack_transport(const std::vector<float>& value, std::size_t functions,
                               std::size_t components);
float unpack(const PackedTransport& packed, std::size_t place, std::size_t function,
             std::size_t component);

struct LightTransport {
  std::string name;
  PackedTransport multiple;  // 3 components; 0 functions: left out
  PackedTransport single;    // 12 components; likewise
};

struct HomogeneousTransport {
  double eta = 1.3;
  KnotChoice knots = KnotChoice::balanced;
  SplineBasis multiple_basis;
  SplineBasis single_basis;
  std::size_t places = 0;
  std::vector<LightTransport> lights;
};

// The coefficients of an update.
struct TransportCoefficients {
  std::vector<float> multiple;     // [function][channel]: c_j / pi
  std::vector<float> single;       // [function][channel]: sigma_s e_j / 4 pi
  std::array<float, 3> three_g{};  // 3 g, g clamped to [-1/3, 1/3]
};

// Projects curves onto the bases: equations are factored once, an edit is a back-substitution.
class TransportProjection {
 public:
  explicit TransportProjection(const HomogeneousTransport& transport);
  // R_d of the material's model (with one channel: the same for all), E of its sigma_t. Single
  // scattering counts where the transport has it and the material asks for it.
  TransportCoefficients fit(const Dipole& material) const;
  // Any curve in place of R_d of a channel.
  void set_reflectance(TransportCoefficients& coefficients, std::size_t channel,
                       const std::function<double(double)>& R_d) const;
  // Any curve in place of E, with sigma_s and g.
  void set_attenuation(TransportCoefficients& coefficients, std::size_t channel, double sigma_s,
                       double g, const std::function<double(double)>& E) const;

 private:
  SplineProjection multiple_, single_;
  std::size_t multiple_size_, single_size_;
};

// What the view makes of each place.
struct TransportView {
  std::vector<float> value;  // [block][4][lane]: F_t(w_o), and w_o' refracted, pointing outwards
};
// Towards an eye; places that face away get F_t as at grazing incidence, 0. Without Fresnel F_t
// counts as 1: for renderers that have one of their own.
TransportView make_transport_view(const std::vector<Vec3>& positions,
                                  const std::vector<Vec3>& normals, Vec3 eye, double eta,
                                  bool has_fresnel = true);

// Radiance at all places: scale[light] multiplies each light's transport. `radiance` gets
// [place]. The same bits for any number of threads and any kind of processor.
void eval_transport(const HomogeneousTransport& transport,
                    const TransportCoefficients& coefficients, const std::vector<Rgb>& scale,
                    const TransportView& view, std::vector<Rgb>& radiance);

// Bytes that an evaluation reads.
std::size_t transport_bytes(const HomogeneousTransport& transport);

}  // namespace parian

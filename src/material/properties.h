// The three properties of a scattering profile (SubEdit, section 5.1) and mixtures of them:
//
//   P(r) = C / alpha^2 S(r / alpha)                                                       (Eq. 10)
//
// C = int P r dr is the albedo (the diffuse albedo is 2 pi C), alpha the range at which P falls to
// support_threshold of its maximum, S the normalised shape, int S u du = 1. C and the normalisation
// run over the profile's support, which may reach beyond alpha: all of the profile counts.
#pragma once

#include "material/profile_map.h"

namespace parian {

enum class RangeKind {
  measured,      // the profile falls so far within its knots
  extrapolated,  // beyond the last knot, on the tail's slope
  limited,       // not even at support_limit times the last knot: that radius
};

struct ProfileProperties {
  double albedo = 0;          // 2 pi C
  double range_mm = 0;        // alpha
  double mean_radius_mm = 0;  // int P r^2 dr / int P r dr: robust where alpha is extrapolated
  RangeKind range_kind = RangeKind::measured;
};

// alpha = inf {rho : P(r) < support_threshold max P for all r >= rho}.
double profile_range(const Profile& profile, RangeKind* kind = nullptr);
ProfileProperties measure_properties(const Profile& profile);

// S as a profile over u = r / alpha: range 1 and integral 1 to rounding, but where the range of the
// original is `limited`.
Profile profile_shape(const Profile& profile);

// The profile of a given albedo 2 pi C and range whose shape is that of `shape`, which need not be
// normalised. Exact: measured again, albedo and range are those asked for to rounding.
Profile compose_profile(const Profile& shape, double albedo, double range_mm);

// How much of b's properties a mixture takes, each in [0, 1].
struct PropertyWeights {
  double albedo = 0;
  double range = 0;
  double shape = 0;
  friend bool operator==(const PropertyWeights&, const PropertyWeights&) = default;
};

// Albedo, range and shape mixed linearly, each on its own (SubEdit, section 7.1: kappa' = w kappa_b
// + (1 - w) kappa_a). Non-increasing where a and b are; all weights 0 give a and all 1 give b, bit
// for bit. The knots lie between those of a and b in units of the range when both have as many, and
// are the union of both otherwise.
Profile blend_profiles(const Profile& a, const Profile& b, const PropertyWeights& weights);

}  // namespace parian

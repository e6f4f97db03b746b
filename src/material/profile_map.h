// A fitted heterogeneous material: one radial scattering profile per pixel and channel
// (SubEdit, Song et al. 2009, Eq. 3 to 5).
//
//   R_d(x_i, x_o) = sqrt(P_xi(r) P_xo(r)),  r = |x_i - x_o|,  ln P piecewise linear over knots
//
// An edited profile is P'(r) = gain / dilation^2 P(r / dilation). Beyond the last knot ln P goes on
// with the last slope, at least min_tail_decay, to the profile's support.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "material/slices.h"

namespace parian {

// Pairs that were kept out of the fit, so that a comparison can judge the model on them. Whether a
// pair is held out is a hash of its unordered pixel pair and the seed: no list is needed. (0,0)
// never is.
struct HoldOut {
  double fraction = 0;
  std::uint64_t seed = 1;
};
bool is_held_out(const HoldOut& hold_out, int x, int y, Offset offset);

struct ProfileMap {
  int width = 0;
  int height = 0;
  int channels = 3;
  double pixel_pitch_mm = 1;
  Boundary boundary = Boundary::excluded;
  double eta = 1.3;
  std::vector<double> knots_mm;    // increasing from 0
  std::vector<float> log_profile;  // [channel][knot][y][x], ln of 1/mm^2
  std::vector<float> gain;         // [channel][y][x], empty = 1
  std::vector<float> dilation;     // [channel][y][x], empty = 1
  HoldOut hold_out;                // of the fit that made it; fraction 0: none
  std::string provenance;          // JSON text, may be empty

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

// Relative to the knot range: the last slope is at most -min_tail_decay / knots_mm.back().
inline constexpr double min_tail_decay = 1.0;
// A profile ends where it falls to this part of its maximum, or at 4 times the last knot.
inline constexpr double support_threshold = 1e-4;
inline constexpr double support_limit = 4.0;

// Throws Error with `name` as its file when sizes disagree or a value is not finite.
void check(const ProfileMap& map, const std::string& name);

// All profiles equal to exp(log_profile).
ProfileMap make_profile_map(int width, int height, int channels, double pixel_pitch_mm,
                            std::vector<double> knots_mm, float log_profile = 0);

inline float* knot_plane(ProfileMap& map, int channel, int knot) {
  const std::size_t index =
      static_cast<std::size_t>(channel) * map.knots_mm.size() + static_cast<std::size_t>(knot);
  return map.log_profile.data() + index * map.pixels();
}
inline const float* knot_plane(const ProfileMap& map, int channel, int knot) {
  return knot_plane(const_cast<ProfileMap&>(map), channel, knot);
}

// One profile, with gain and dilation applied: values at the (dilated) knots.
struct Profile {
  std::vector<double> knots_mm;
  std::vector<double> log_value;
  double support_mm = 0;
};
// From values at undilated knots.
Profile make_profile(const std::vector<double>& knots_mm, std::vector<double> log_value,
                     double gain = 1, double dilation = 1);
Profile get_profile(const ProfileMap& map, int channel, int x, int y);
// Slope of ln P beyond the last knot, in 1/mm: the last segment's, at most the minimum decay.
double tail_slope(const std::vector<double>& knots_mm, const std::vector<double>& log_value);

// ln P(r) of Eq. 5, -infinity beyond the support.
double eval_log_profile(const Profile& profile, double r_mm);
// Radius at which it falls to support_threshold of its maximum, at most 4 r_n.
double profile_support(const std::vector<double>& knots_mm, const std::vector<double>& log_value);
// C = integral of P r dr over the support (the paper's albedo); the diffuse albedo is 2 pi C.
double profile_integral(const Profile& profile);
inline double diffuse_albedo(const Profile& profile) {
  return 6.283185307179586 * profile_integral(profile);
}

// Integral of exp(y) r dr over [r0, r0 + h] with y linear from y0 to y1 (algorithms: closed form,
// series for small |y1 - y0|).
double segment_integral(double r0, double h, double y0, double y1);

// R_d at offset d for all pixels, as SliceSource::read_slice wants it (NaN outside the grid).
void eval_slice(const ProfileMap& map, int channel, Offset offset, float* slice);

}  // namespace parian

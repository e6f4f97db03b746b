// A compressed heterogeneous material: K base materials per pixel (K-BMPP, Yatagawa et al. 2019,
// section 3.2). The profile of a pixel is a mixture of K out of M base profiles in logarithms:
//
//   ln P_x(r) = sum_k t_xk ln P_b(x,k)(r),  t >= 0, sum_k t_xk = 1   (Eq. 4)
//
// Base profiles are per channel; indices and weights are shared by the channels. Everything else
// (R_d, tail, support, gain, dilation) is as for a profile map, of which a blend is a short form.
#pragma once

#include <cstdint>

#include "material/profile_map.h"

namespace parian {

inline constexpr int max_bases_per_pixel = 8;
inline constexpr int max_bases = 65535;

// The lattice on which all values of a blend lie, so that a packed file keeps them exactly. It does
// not depend on the values: snapping twice changes nothing.
struct BlendGrid {
  double profile_step = 0;  // ln P is a multiple of it; 0: any float
  int weight_levels = 0;    // weights are multiples of 1 / weight_levels, 1 to 65535; 0: any float
  friend bool operator==(const BlendGrid&, const BlendGrid&) = default;
};

struct ProfileBlend {
  int width = 0;
  int height = 0;
  int channels = 3;
  int per_pixel = 2;  // K
  double pixel_pitch_mm = 1;
  Boundary boundary = Boundary::excluded;
  double eta = 1.3;
  std::vector<double> knots_mm;         // increasing from 0
  std::vector<float> base_log_profile;  // [base][channel][knot], ln of 1/mm^2; non-increasing
  std::vector<std::uint16_t> index;     // [k][y][x], k < K; the same base may occur twice
  std::vector<float> weight;            // [k][y][x], k < K - 1; the last is 1 minus their sum
  std::vector<float> gain;              // [channel][y][x], empty = 1
  std::vector<float> dilation;          // [channel][y][x], empty = 1
  BlendGrid grid;
  HoldOut hold_out;        // of the fit behind it
  std::string provenance;  // JSON text, may be empty

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t bases() const {  // M
    const std::size_t row = static_cast<std::size_t>(channels) * knots_mm.size();
    return row == 0 ? 0 : base_log_profile.size() / row;
  }
};

// Throws Error with `name` as its file when sizes disagree, an index is >= M, a weight is negative,
// a pixel's weights sum to more than 1 (by more than rounding), a base profile rises or a value is
// not finite or off the grid.
void check(const ProfileBlend& blend, const std::string& name);

inline const float* base_profile(const ProfileBlend& blend, std::size_t base, int channel) {
  return blend.base_log_profile.data() +
         (base * static_cast<std::size_t>(blend.channels) + static_cast<std::size_t>(channel)) *
             blend.knots_mm.size();
}

// The K weights of a pixel, the last one made up: never below 0.
void get_weights(const ProfileBlend& blend, std::size_t pixel, float* weights);

// Eq. 4, with gain and dilation applied: as get_profile of a map.
Profile get_profile(const ProfileBlend& blend, int channel, int x, int y);

// R_d at offset d for all pixels: as eval_slice of a map, without expanding more than a plane.
void eval_slice(const ProfileBlend& blend, int channel, Offset offset, float* slice);

// Every pixel's profile written out.
ProfileMap make_profile_map(const ProfileBlend& blend);

// Moves all values to the grid: base profiles to the nearest multiple that keeps them
// non-increasing, a pixel's weights to the nearest lattice point of the simplex.
void snap_to_grid(ProfileBlend& blend, const BlendGrid& grid);

// Bytes of the paper's encoding without header, checksums, gain and dilation:
// 4 C M S + N (K b + 4 (K - 1)), b = 1 for M <= 256, else 2.
std::size_t paper_bytes(const ProfileBlend& blend);

}  // namespace parian

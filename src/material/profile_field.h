// What renderers see of a material: radial profiles over the sample's plane on knots that are
// common to all its points, whatever the model behind them. Always three channels: a grey material
// counts for red, green and blue.
//
//   R_d(x_i, x_o) = exp(h_i(r) + h_o(r)) for r < both supports, else 0;  h = 1/2 ln P
//
// h is linear between knots. For a profile map without dilations that is the model itself; dilated
// maps and dipoles are resampled on finer knots (make_profile_field states the error).
#pragma once

#include <functional>
#include <vector>

#include "material/material.h"

namespace parian {

struct ProfileField {
  int width = 1;  // of the sample's grid; 1 x 1: homogeneous
  int height = 1;
  double pixel_pitch_mm = 1;
  Boundary boundary = Boundary::excluded;
  double eta = 1.3;
  std::vector<float> knots_mm;  // increasing from 0, at least 2; the last is >= every support
  float max_support_mm = 0;
  bool monotone = true;  // no profile rises anywhere: what brackets need
  // At (x, y) in pixels, pixel centres at integers, clamped to the grid: bilinear in ln P. Writes
  // half_log[knot][channel] and support_mm[channel]. half_log goes on beyond the support: cut
  // there. Thread-safe.
  std::function<void(double x, double y, float* half_log, float* support_mm)> eval;

  std::size_t knots() const { return knots_mm.size(); }
  // Floats of one row of half_log.
  std::size_t row() const { return 3 * knots_mm.size(); }
};

// Copies what it needs. Against the model's own ln P within the support it is exact to float
// rounding for undilated maps, within 1e-3 for dipoles, and for dilated maps within 1 % of the
// steepest slope times the support.
ProfileField make_profile_field(const Material& material);

}  // namespace parian

// Material painting (SubEdit, section 7.1): albedo, range and shape mixed with those of a picked
// profile or, pixel by pixel, of another map:
//
//   kappa' = w kappa_s + (1 - w) kappa_d,   kappa = C, alpha or S(u)
#pragma once

#include <array>

#include "base/params.h"
#include "edit/edit_state.h"

namespace parian {

// How much of each property is taken where the mask is 1.
struct BlendAmounts {
  double albedo = 1;
  double range = 1;
  double shape = 1;
};
ParamList describe(BlendAmounts& amounts);

// Pixel (x, y) takes from the source's pixel source_pixel[y][x]; empty: all from its pixel 0. The
// source has as many channels, or one, and knots of the same number and relative places
// (match_knots).
void apply(const BlendAmounts& amounts, const EditState& source,
           const std::vector<std::uint32_t>& source_pixel, EditState& state, const Mask& mask,
           EditReport& report);

// The state with other knots: the same number of them as `knots_mm` at the same relative places, up
// to the dilation. Nothing is lost where the relative places already agree; elsewhere profiles are
// sampled at the new knots.
EditState match_knots(const EditState& state, const std::vector<double>& knots_mm);

}  // namespace parian

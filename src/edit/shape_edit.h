// Edits of the normalised shape: factors and offsets along u = r / alpha, then made non-increasing
// and normalised again (SubEdit, section 5.2). Albedo and range stay.
#pragma once

#include <array>

#include "base/document.h"
#include "edit/edit_state.h"

namespace parian {

// S'(u) = scale(u) S0 (S(u) / S0)^falloff + offset(u), S0 = S(0). scale and offset are linear
// between points (u, value), constant beyond the first and last; offset ends at u = 1.
struct ShapeEdit {
  double falloff = 1;
  std::vector<std::array<double, 2>> scale;   // u increasing; none: 1
  std::vector<std::array<double, 2>> offset;  // none: 0
};
inline constexpr std::size_t max_curve_points = 64;
ParamList describe(ShapeEdit& edit);  // the plain numbers: not the curves
// Throws Error for points that do not increase, are too many, or have values out of range.
void check(const ShapeEdit& edit);

// The parameters are interpolated from "no change" by the mask. Curves are sampled at 4096 places.
void apply(const ShapeEdit& edit, EditState& state, const Mask& mask);

// The least-squares non-increasing profile in ln P (pool adjacent violators, weights r dr), with
// albedo and range kept, wherever the mask is above 0 and the profile rises. Returns how many did.
std::size_t make_monotone(EditState& state, const Mask& mask);

}  // namespace parian

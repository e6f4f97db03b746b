// Scale and offset of albedo and range, and recolouring (SubEdit, section 5.2: the parameters that
// strokes interpolate).
#pragma once

#include "base/params.h"
#include "edit/edit_state.h"
#include "edit/recolor.h"

namespace parian {

// C' = scale C + offset for the albedo 2 pi C, likewise for the range; then the colour. One value
// for all channels or one for each.
struct Adjust {
  std::vector<double> albedo_scale{1};
  std::vector<double> albedo_offset{0};
  std::vector<double> range_scale{1};
  std::vector<double> range_offset_mm{0};
  Recolor color;  // of maps with three channels
};
ParamList describe(Adjust& adjust);

// The parameters are interpolated from "no change" by the mask, so a mask of 0 changes nothing, bit
// for bit.
void apply(const Adjust& adjust, EditState& state, const Mask& mask, EditReport& report);

// Several strokes with parameters of their own: those of stroke s count by weight[s][y][x] (at most
// 1 in all; the rest is no change). `masks` and `adjusts` go together.
void apply(const std::vector<Adjust>& adjusts, EditState& state, const std::vector<Mask>& masks,
           EditReport& report);

}  // namespace parian

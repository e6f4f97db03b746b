// Errors in R_d itself, as they are reported, against a target that has profiles of its own: the
// fitted map stands for the table, which is not read again.
//
//   F(p) = sum_x [ relative_x e_x^2 + albedo_x a_x^2 ]
//   e_x^2 = sum_y (R'_xy - R_xy)^2 / sum_y R_xy^2       relative error of pixel x
//   a_x^2 = |rho'_x - rho_x|^2 / |rho_x|^2,  rho_x = sum_y R_xy: albedo error
//
// over all channels and the pairs (x, y) at the given offsets, R_xy = sqrt(P_x(r) P_y(r)).
//
// What the map R* misses of the table R enters to first order, from one pass over the table: rho is
// the table's, and to (R' - R*)^2 comes 2 (R' - R*)(R* - R), linear in ln P around the map. So a
// blend may get closer to the table than the map is.
#pragma once

#include <vector>

#include "compress/local_model.h"
#include "material/profile_map.h"

namespace parian {

struct PixelWeights {
  std::vector<float> relative, albedo;  // [y][x]
};

// `offsets`: a half plane with (0,0), within the last knot. The target's gain and dilation must be
// empty. `table`, which may be null, is read once; pairs that it lacks count as the target's.
// Copies what it needs.
BlendObjective make_pair_objective(const ProfileMap& target, const std::vector<Offset>& offsets,
                                   const PixelWeights& weights, const SliceSource* table = nullptr,
                                   const Progress& progress = {});

}  // namespace parian

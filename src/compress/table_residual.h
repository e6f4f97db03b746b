// What a fitted map misses of its table, summed over each pixel's pairs in one pass.
#pragma once

#include <vector>

#include "material/profile_map.h"

namespace parian {

struct TableResidual {
  std::vector<float> albedo;   // [channel][y][x]: sum_y R - R*
  std::vector<float> squared;  // [y][x]: sum_y (R* - R)^2 over all channels
  // [channel][knot][y][x]: d/d ln P_x of sum_y (w_x + w_y) (R* - R) ln R*, times 2
  std::vector<float> linear;
};

// Of a table with a noise model, sums over pairs take all values as they are: noise has mean 0. In
// `linear` each R* - R is multiplied by what of it is expected not to be noise.
//
// `weight` w [y][x]. Pairs within the last knot count where they are measured, each in both
// directions, (0,0) once; a table that lists both directions counts each at half.
TableResidual measure_residual(const SliceSource& table, const ProfileMap& map,
                               const std::vector<float>& weight, const Progress& progress = {});

}  // namespace parian

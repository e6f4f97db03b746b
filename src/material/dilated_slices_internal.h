// Slices of maps with dilations: what each pixel's profile needs is found once, so that a slice
// costs little more than without.
#pragma once

#include <vector>

#include "material/profile_map.h"

namespace parian {

// Of all values [channel][y][x]: u = r inverse_dilation is the radius among the map's own knots.
struct DilatedMap {
  const ProfileMap* map = nullptr;
  std::vector<float> inverse_dilation;
  std::vector<float> shift;       // ln(gain / dilation^2)
  std::vector<float> support;     // in u
  std::vector<float> tail_slope;  // d ln P / du beyond the last knot
  std::vector<float> knots;
  std::vector<int> segment_of_bin;  // of bins of equal width, each with at most few knots
  float bins_per_mm = 0;
};

// Refers to the map.
DilatedMap make_dilated_map(const ProfileMap& map);

// ln P_x(r) of a channel for all pixels.
void eval_log_plane(const DilatedMap& map, int channel, double r_mm, float* out);

}  // namespace parian

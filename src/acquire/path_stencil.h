// The mean of a field along the straight path between two pixels, as a fixed stencil: for one
// offset d the sample points x + t d have the same fractional positions for every pixel x.
#pragma once

#include <vector>

#include "material/slices.h"

namespace parian {

// weight (f(x + near) + f(x + far)), with near + far = d. A pair reads the same from both ends, so
// the sum over pairs in this order has the same bits when the ends are exchanged.
struct PathPair {
  Offset near;
  Offset far;
  double weight = 0;
};

// Trapezoid rule over equal steps of at most half a pixel, of the field bilinear between pixel
// centres. Weights sum to 1/2. Points between two pixels of the grid read pixels of the grid only.
std::vector<PathPair> make_path_stencil(Offset offset);

}  // namespace parian

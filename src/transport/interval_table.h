// Lookup of basis functions at distances, for inner loops: polynomials of each interval, found
// through bins of equal width.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "math/spline_basis.h"

namespace parian {

// Functions k .. k + degree are not 0 in interval k; there function k + i is
// c[i][0] + t (c[i][1] + t c[i][2]), t from 0 to 1 over the interval.
struct IntervalTable {
  int degree = 1;
  std::size_t functions = 0;
  float reach = 0;  // the last knot
  float bins_per_mm = 0;
  std::vector<int> interval_of_bin;  // of the bin's start; at most one knot lies inside a bin
  std::vector<float> start, end, inverse_length;  // [interval]
  std::vector<std::array<std::array<float, 3>, 3>> c;
};
// Throws Error for more than 2^16 bins: knots closer than reach / 2^16.
IntervalTable make_interval_table(const SplineBasis& basis);

}  // namespace parian

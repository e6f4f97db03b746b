// Row sums of R_d: the albedo image, and the energy bound. Of a symmetric R_d, row sums of at most
// 1 bound the operator norm (Schur's test): no illumination makes more light leave than enters.
// Profiles whose own integrals 2 pi C are at most 1 do not guarantee it, as a row sums the profiles
// of different pixels.
#pragma once

#include "base/progress.h"
#include "image/image.h"
#include "material/slices.h"

namespace parian {

struct RowSums {
  Image albedo;    // rho(x) = sum over measured pairs of R_d(x, y) times the pixel area
  double max = 0;  // the largest rho, and where
  int x = 0, y = 0, channel = 0;
  std::size_t above_one = 0;  // values of rho above 1 by more than rounding
};

RowSums measure_row_sums(const SliceSource& table, const Progress& progress = {});

}  // namespace parian

// Edit propagation between all pairs of pixels (AppProp, An and Pellacini 2008), by a low-rank
// approximation of the similarities:
//
//   E(e) = sum_ij w_j z_ij (e_i - g_j)^2 + lambda sum_ij z_ij (e_i - e_j)^2
//   z_ij = exp(-|f_i - f_j|^2 / sigma) exp(-|x_i - x_j|^2 / sigma_s^2)
//
// Its minimum is (D - 2 lambda Z) e = Z (w g), D = diag(Z w + 2 lambda Z 1).
#pragma once

#include <cstdint>
#include <vector>

#include "base/params.h"
#include "edit/features.h"
#include "edit/propagate.h"

namespace parian {

struct AllPairsParams {
  int columns = 200;       // m: random pixels whose similarities to all are computed
  double sigma = 0.2;      // range of appearance; 1 is the mean over random pairs
  double sigma_space = 0;  // range in the image relative to its diagonal; 0: anywhere
  double lambda = 0;       // 0: sum of w / pixels, at which both terms weigh alike
  std::uint64_t seed = 1;
};
ParamList describe(AllPairsParams& params);

// Indicators of all strokes, which sum to 1 wherever similarities reach; elsewhere 0. Z ~ U A^-1
// U^T from m columns (Nystrom) may have negative entries, so that values leave [0, 1]: they are
// clamped and counted. The residual is that of the low-rank system; iterations are 0. Errors as of
// propagate. Memory: 8 m bytes per pixel.
Propagation propagate_all_pairs(const Features& features, const std::vector<StrokePixel>& pixels,
                                int strokes, const AllPairsParams& params = {});

}  // namespace parian

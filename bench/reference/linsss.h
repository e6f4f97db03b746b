// LinSSS (Yatagawa 2020): Gaussians of fixed widths, weighted per pixel and channel,
//
//   R(x_i, x_o) = sum_h 1/2 (W_h(x_i) + W_h(x_o)) G_h(|x_i - x_o|),  W >= 0.
#pragma once

#include <cstdint>

#include "base/aligned.h"
#include "bench/reference/rival.h"
#include "material/bssrdf_table.h"

namespace parian {

struct LinsssParams {
  std::size_t gaussians = 8;
  int iterations = 30;     // of accelerated projected gradients on all pixels at once
  std::uint64_t seed = 1;  // of the pixels that the widths are chosen on
};

struct LinsssChannel {
  std::vector<double> sigma_px;  // ascending, equally spaced in the logarithm
  AlignedVector<float> weight;   // [gaussian][y][x]; G_h(0) = 1
  // Sum over measured pairs of (1/e_x + 1/e_y) (R - R~)^2, e the sum of squares of all channels'
  // values at a pixel: summed over channels, it is that over pixels of the squared relative error.
  // Before the first and after each iteration.
  std::vector<double> objective;
};

std::vector<LinsssChannel> fit_linsss(const BssrdfTable& table, const LinsssParams& params);

// As many Gaussians, 8 at most, as 4 C N bytes each allow.
Rival compress_linsss(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed = 1);

}  // namespace parian

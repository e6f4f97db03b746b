// Row kernels of the plane filters.
#pragma once

#include <cstddef>

namespace parian {

// Pixels that the bilateral kernel treats at once.
constexpr int bilateral_chunk = 32;

// out = weights[0] row + Σ_k weights[k] (row[x-k] + row[x+k]), k = 1..radius.
void convolve_row(const float* row, const float* weights, int radius, int width, float* out);
// out += weight (a + b)
void add_rows_weighted(const float* a, const float* b, float weight, int width, float* out);
// out = in + amount (in - smooth); out may be in.
void sharpen_row(const float* in, const float* smooth, float amount, int width, float* out);

// Taps of one row of the window. Values lie plane after plane, `stride` apart, guides first.
struct BilateralRow {
  const float* centre;  // of the first pixel of the chunk
  const float* row;     // the same x in the row of the window
  std::ptrdiff_t stride;
  int guides, planes;
  const int* offsets;        // along x, one for each tap
  const float* log_weights;  // base 2
  int taps;
};
// sums[0] += Σ_taps w, sums[1+p] += Σ_taps w (f_p(x + offset) - f_p(x)) for every pixel of the
// chunk, where log2 w = log_weight - |g(x + offset) - g(x)|². `work` and `sums` hold planes + 1
// rows of bilateral_chunk numbers.
void add_bilateral_row(const BilateralRow& taps, float* work, float* sums);

}  // namespace parian

#include "math/fft.h"

#include "base/check.h"
#include "math/fft_variants.h"

namespace parian {
namespace {

// Smallest 2^a 3^b 5^c >= n: the radices that pocketfft is fastest with.
int fast_size(int n) {
  for (int size = n;; ++size) {
    int rest = size;
    for (int radix : {2, 3, 5})
      while (rest % radix == 0) rest /= radix;
    if (rest == 1) return size;
  }
}

[[maybe_unused]] bool use_avx2() {
#ifdef PARIAN_FFT_HAS_AVX2
  static const bool supported = __builtin_cpu_supports("avx2") != 0;
  return supported;
#else
  return false;
#endif
}

#ifdef PARIAN_FFT_HAS_AVX2
#define PARIAN_FFT_CALL(function, ...) \
  (use_avx2() ? fft_avx2::function(__VA_ARGS__) : fft_baseline::function(__VA_ARGS__))
#else
#define PARIAN_FFT_CALL(function, ...) fft_baseline::function(__VA_ARGS__)
#endif

}  // namespace

FftGrid make_fft_grid(int width, int height, int reach_x, int reach_y) {
  PARIAN_CHECK_LE(1, width);
  PARIAN_CHECK_LE(1, height);
  return {width, height, fast_size(width + reach_x), fast_size(height + reach_y)};
}

void forward_fft(const FftGrid& grid, const float* plane, float* spectrum) {
  PARIAN_FFT_CALL(forward_float, grid, plane, grid.width, grid.height, spectrum);
}
void forward_fft(const FftGrid& grid, const double* plane, double* spectrum) {
  PARIAN_FFT_CALL(forward_double, grid, plane, grid.width, grid.height, spectrum);
}
void inverse_fft(const FftGrid& grid, float* spectrum, float* plane) {
  PARIAN_FFT_CALL(inverse_float, grid, spectrum, plane);
}
void inverse_fft(const FftGrid& grid, double* spectrum, double* plane) {
  PARIAN_FFT_CALL(inverse_double, grid, spectrum, plane);
}
void forward_fft_padded(const FftGrid& grid, const float* padded, float* spectrum) {
  PARIAN_FFT_CALL(forward_float, grid, padded, grid.padded_width, grid.padded_height, spectrum);
}
void forward_fft_padded(const FftGrid& grid, const double* padded, double* spectrum) {
  PARIAN_FFT_CALL(forward_double, grid, padded, grid.padded_width, grid.padded_height, spectrum);
}

}  // namespace parian

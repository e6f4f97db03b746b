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

void fill_parseval_weights(const FftGrid& grid, float* weights) {
  constexpr std::size_t lanes = spectrum_lanes<float>;
  const auto rows = static_cast<std::size_t>(grid.padded_height);
  const std::size_t block = lanes * static_cast<std::size_t>(grid.padded_width);
  const float one = 1.0f / static_cast<float>(grid.padded_pixels());
  for (std::size_t i = 0; i < grid.frequencies<float>(); ++i) {
    const std::size_t f = i / block * lanes + i % lanes;  // along y
    const bool alone = f == 0 || 2 * f == rows;
    weights[i] = 2 * f > rows ? 0 : alone ? one : 2 * one;
  }
}

}  // namespace parian

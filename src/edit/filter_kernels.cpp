#include "edit/filter_kernels.h"

#include <bit>
#include <cstdint>

#include "base/hot.h"

namespace parian {

PARIAN_HOT void convolve_row(const float* row, const float* weights, int radius, int width,
                             float* PARIAN_RESTRICT out) {
  for (int x = 0; x < width; ++x) out[x] = weights[0] * row[x];
  for (int k = 1; k <= radius; ++k) {
    const float weight = weights[k];
    const float *left = row - k, *right = row + k;
    for (int x = 0; x < width; ++x) out[x] += weight * (left[x] + right[x]);
  }
}

PARIAN_HOT void add_rows_weighted(const float* a, const float* b, float weight, int width,
                                  float* PARIAN_RESTRICT out) {
  for (int x = 0; x < width; ++x) out[x] += weight * (a[x] + b[x]);
}

PARIAN_HOT void sharpen_row(const float* in, const float* smooth, float amount, int width,
                            float* out) {
  for (int x = 0; x < width; ++x) out[x] = in[x] + amount * (in[x] - smooth[x]);
}

// The weight is 2^k 2^f with |f| <= 1/2; Taylor to f^6 leaves 1.2e-7 relative. Below 2^-126 it
// stays there.
PARIAN_HOT void add_bilateral_row(const BilateralRow& taps, float* PARIAN_RESTRICT work,
                                  float* PARIAN_RESTRICT sums) {
  constexpr int chunk = bilateral_chunk;
  constexpr float round = 12582912.0f;  // 1.5 * 2^23: adding it rounds to an integer
  const int guides = taps.guides, planes = taps.planes;
  const std::ptrdiff_t stride = taps.stride;
  for (int i = 0; i < (planes + 1) * chunk; ++i) work[i] = 0;
  for (int t = 0; t < taps.taps; ++t) {
    const float log_weight = taps.log_weights[t];
    const float* a = taps.centre;
    const float* b = taps.row + taps.offsets[t];
    float w[chunk];
    for (int i = 0; i < chunk; ++i) w[i] = log_weight;
    for (int g = 0; g < guides; ++g, a += stride, b += stride)
      for (int i = 0; i < chunk; ++i) {
        const float d = b[i] - a[i];
        w[i] -= d * d;
      }
    for (int i = 0; i < chunk; ++i) {
      const float x = w[i] < -126.0f ? -126.0f : w[i];
      const float shifted = x + round;
      const float f = x - (shifted - round);
      const float p =
          1 + f * (0.69314718f +
                   f * (0.24022651f +
                        f * (0.05550411f +
                             f * (9.6181291e-3f + f * (1.3333558e-3f + f * 1.5403530e-4f)))));
      const std::uint32_t power = std::bit_cast<std::uint32_t>(shifted) << 23u;
      w[i] = std::bit_cast<float>(std::bit_cast<std::uint32_t>(p) + power);
    }
    for (int i = 0; i < chunk; ++i) work[i] += w[i];
    float* PARIAN_RESTRICT sum = work;
    for (int p = 0; p < planes; ++p, a += stride, b += stride) {
      sum += chunk;
      for (int i = 0; i < chunk; ++i) sum[i] += w[i] * (b[i] - a[i]);
    }
  }
  for (int i = 0; i < (planes + 1) * chunk; ++i) sums[i] += work[i];
}

}  // namespace parian

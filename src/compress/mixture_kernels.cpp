#include "compress/mixture_kernels.h"

#include <cstring>

#include "base/hot.h"

// Vectors are passed between functions that are always inlined: no calling convention is touched.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace parian {
namespace {

using Lanes = float __attribute__((vector_size(32)));

[[gnu::always_inline]] inline Lanes load(const float* from) {
  Lanes value;
  std::memcpy(&value, from, sizeof(Lanes));
  return value;
}
[[gnu::always_inline]] inline void store(const Lanes& value, float* to) {
  std::memcpy(to, &value, sizeof(Lanes));
}
[[gnu::always_inline]] inline float sum(const Lanes& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}
[[gnu::always_inline]] inline Lanes smaller(const Lanes& a, const Lanes& b) {
  return a < b ? a : b;
}
[[gnu::always_inline]] inline Lanes larger(const Lanes& a, const Lanes& b) {
  return a > b ? a : b;
}

constexpr std::size_t longest_row = 8;  // corners

}  // namespace

PARIAN_HOT void mix_row(const float* bases, std::size_t stride, const std::uint16_t* index,
                        const float* weight, std::size_t count, float* PARIAN_RESTRICT out) {
  for (std::size_t i = 0; i < stride; i += 8) {
    Lanes value = weight[0] * load(bases + index[0] * stride + i);
    for (std::size_t k = 1; k < count; ++k)
      value += weight[k] * load(bases + index[k] * stride + i);
    store(value, out + i);
  }
}

// v^T D v' = sum_i d_i v_i v'_i + o_i (v_i v'_{i+1} + v_{i+1} v'_i); o is 0 at the row's end, so
// that what follows it, one vector of zeros, does not count.
PARIAN_HOT void eval_corners(const float* bases, std::size_t stride, const std::uint16_t* index,
                             std::size_t count, const float* PARIAN_RESTRICT target,
                             const float* PARIAN_RESTRICT diagonal,
                             const float* PARIAN_RESTRICT coupling, float* PARIAN_RESTRICT corners,
                             float* PARIAN_RESTRICT gram) {
  const std::size_t row = stride + 8;
  for (std::size_t k = 0; k < count; ++k) {
    const float* base = bases + index[k] * stride;
    for (std::size_t i = 0; i < stride; i += 8)
      store(load(base + i) - load(target + i), corners + k * row + i);
    store(Lanes{}, corners + k * row + stride);
  }
  for (std::size_t k = 0; k < count; ++k) {
    const float* a = corners + k * row;
    Lanes sums[longest_row] = {};
    for (std::size_t i = 0; i < stride; i += 8) {
      const Lanes o = load(coupling + i), next = load(a + i + 1);
      const Lanes da = load(diagonal + i) * load(a + i) + o * next, oa = o * load(a + i);
      for (std::size_t l = 0; l <= k; ++l) {
        const float* b = corners + l * row + i;
        sums[l] += da * load(b) + oa * load(b + 1);
      }
    }
    for (std::size_t l = 0; l <= k; ++l) gram[k * count + l] = gram[l * count + k] = sum(sums[l]);
  }
}

PARIAN_HOT float eval_mixed_corners(const float* PARIAN_RESTRICT corners, std::size_t stride,
                                    const float* weight, std::size_t count,
                                    const float* PARIAN_RESTRICT diagonal,
                                    const float* PARIAN_RESTRICT coupling) {
  const std::size_t row = stride + 8;
  Lanes total = {};
  for (std::size_t i = 0; i < stride; i += 8) {
    Lanes v = weight[0] * load(corners + i), next = weight[0] * load(corners + i + 1);
    for (std::size_t k = 1; k < count; ++k) {
      v += weight[k] * load(corners + k * row + i);
      next += weight[k] * load(corners + k * row + i + 1);
    }
    total += v * (load(diagonal + i) * v + 2 * (load(coupling + i) * next));
  }
  return sum(total);
}

PARIAN_HOT void add_metric_product(const float* PARIAN_RESTRICT diagonal,
                                   const float* PARIAN_RESTRICT coupling,
                                   const float* PARIAN_RESTRICT v, float scale,
                                   float* PARIAN_RESTRICT out, std::size_t stride) {
  for (std::size_t i = 0; i < stride; ++i) out[i] += scale * (diagonal[i] * v[i]);
  for (std::size_t i = 0; i + 1 < stride; ++i) {
    out[i] += scale * (coupling[i] * v[i + 1]);
    out[i + 1] += scale * (coupling[i] * v[i]);
  }
}

PARIAN_HOT void add_row(const float* PARIAN_RESTRICT b, float scale, float* PARIAN_RESTRICT a,
                        std::size_t stride) {
  for (std::size_t i = 0; i < stride; ++i) a[i] += scale * b[i];
}

PARIAN_HOT void project_row(const float* PARIAN_RESTRICT matrix, std::size_t rows,
                            std::size_t count, const float* PARIAN_RESTRICT w,
                            float* PARIAN_RESTRICT out) {
  for (std::size_t j = 0; j < count; j += 32) {
    Lanes sums[4] = {};
    for (std::size_t k = 0; k < rows; ++k) {
      const float* from = matrix + k * count + j;
      sums[0] += w[k] * load(from);
      sums[1] += w[k] * load(from + 8);
      sums[2] += w[k] * load(from + 16);
      sums[3] += w[k] * load(from + 24);
    }
    std::memcpy(out + j, sums, sizeof(sums));
  }
}

PARIAN_HOT void screen_segments(const float* PARIAN_RESTRICT inner,
                                const float* PARIAN_RESTRICT norm,
                                const float* PARIAN_RESTRICT distance, float alpha, float mm,
                                float* PARIAN_RESTRICT out, std::size_t count) {
  const Lanes zero = {}, one = zero + 1.0f;
  for (std::size_t j = 0; j < count; j += 8) {
    const Lanes length = larger(mm + load(norm + j) - 2 * load(inner + j), zero + 1e-20f);
    const Lanes beta = load(distance + j);
    // At m + t (V_j - m) the square is (1 - t) alpha + t beta - t (1 - t) length.
    const Lanes t = smaller(larger(0.5f + (alpha - beta) / (2 * length), zero), one);
    store((1 - t) * alpha + t * beta - t * (1 - t) * length, out + j);
  }
}

}  // namespace parian

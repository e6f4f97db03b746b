#include "bench/reference/kbmpp_2019_kernels.h"

#include <algorithm>
#include <cstring>

#include "base/hot.h"

namespace parian::kbmpp {
namespace {

using Lanes = float __attribute__((vector_size(32)));
using Quad = float __attribute__((vector_size(16)));

// By reference: registers wider than the baseline's have no calling convention.
template <typename Vector>
[[gnu::always_inline]] inline void load(const float* from, Vector& value) {
  std::memcpy(&value, from, sizeof(Vector));
}

template <typename Vector>
[[gnu::always_inline]] inline void add_to(float* to, const Vector& value) {
  Vector sum;
  load(to, sum);
  sum += value;
  std::memcpy(to, &sum, sizeof(Vector));
}

[[gnu::always_inline]] inline float sum_of(const Quad& v) {
  return (v[0] + v[1]) + (v[2] + v[3]);
}

// One register of add_residuals.
[[gnu::always_inline]] inline void add_eight(const float* q, const float* partner, const float* y,
                                             float* at, float* at_partner, Lanes& squares) {
  const Lanes zero = {};
  Lanes own, other, target;
  load(q, own);
  load(partner, other);
  load(y, target);
  const Lanes raw = own + other - target;
  const Lanes e = target == target ? raw : zero;  // NOLINT(misc-redundant-expression): NaN
  add_to(at, e);
  add_to(at_partner, e);
  squares += e * e;
}

constexpr std::size_t chunk = 4096;  // squares summed in single precision

}  // namespace

PARIAN_HOT void interpolate(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                            float low, float high, std::size_t count, float* PARIAN_RESTRICT out) {
  for (std::size_t i = 0; i < count; ++i) out[i] = low * a[i] + high * b[i];
}

PARIAN_HOT double add_residuals(const float* q, const float* y, std::ptrdiff_t shift,
                                std::size_t begin, std::size_t end, float* at, float* at_partner) {
  double total = 0;
  const float* partner = q + shift;
  float* to = at_partner + shift;
  std::size_t i = begin;
  while (i + 16 <= end) {
    const std::size_t stop = std::min(end, i + chunk);
    Lanes squares[2] = {};
    for (; i + 16 <= stop; i += 16) {
      add_eight(q + i, partner + i, y + i, at + i, to + i, squares[0]);
      add_eight(q + i + 8, partner + i + 8, y + i + 8, at + i + 8, to + i + 8, squares[1]);
    }
    const Lanes sum = squares[0] + squares[1];
    for (int lane = 0; lane < 8; ++lane) total += static_cast<double>(sum[lane]);
  }
  for (; i < end; ++i) {
    if (!(y[i] == y[i])) continue;
    const float e = q[i] + partner[i] - y[i];
    at[i] += e;
    to[i] += e;
    total += static_cast<double>(e * e);
  }
  return total;
}

void add_counts(const float* y, std::ptrdiff_t shift, std::size_t begin, std::size_t end, float* at,
                float* at_partner) {
  float* to = at_partner + shift;
  for (std::size_t i = begin; i < end; ++i) {
    const float one = y[i] == y[i] ? 1.0f : 0.0f;
    at[i] += one;
    to[i] += one;
  }
}

PARIAN_HOT void spread(float* PARIAN_RESTRICT a, float* PARIAN_RESTRICT b, float low, float high,
                       std::size_t count, float* PARIAN_RESTRICT to_low,
                       float* PARIAN_RESTRICT to_high) {
  for (std::size_t i = 0; i < count; ++i) {
    const float s = a[i] + b[i];
    to_low[i] += low * s;
    to_high[i] += high * s;
    a[i] = 0;
    b[i] = 0;
  }
}

PARIAN_HOT void mix_rows(const float* PARIAN_RESTRICT bases, const std::uint16_t* index,
                         const float* weight, std::size_t count, std::size_t per_pixel,
                         std::size_t row, float* PARIAN_RESTRICT rows) {
  for (std::size_t i = 0; i < count; ++i) {
    float* PARIAN_RESTRICT out = rows + i * row;
    const float* first = bases + index[i * per_pixel] * row;
    const float t = weight[i * per_pixel];
    for (std::size_t j = 0; j < row; ++j) out[j] = t * first[j];
    for (std::size_t k = 1; k < per_pixel; ++k) {
      const float* base = bases + index[i * per_pixel + k] * row;
      const float tk = weight[i * per_pixel + k];
      for (std::size_t j = 0; j < row; ++j) out[j] += tk * base[j];
    }
  }
}

PARIAN_HOT void project_rows(const float* bases, const std::uint16_t* index, const float* weight,
                             const float* rows, std::size_t count, std::size_t per_pixel,
                             std::size_t row, float* PARIAN_RESTRICT to_bases,
                             float* PARIAN_RESTRICT to_weight) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < per_pixel; ++k) {
      const std::size_t at = i * per_pixel + k;
      const float* base = bases + index[at] * row;
      const float* g = rows + i * row;
      float* to = to_bases + index[at] * row;
      const float t = weight[at];
      Quad dot = {};
      for (std::size_t j = 0; j < row; j += 4) {
        Quad value, other;
        load(g + j, value);
        load(base + j, other);
        dot += value * other;
        add_to(to + j, value * t);
      }
      to_weight[at] = sum_of(dot);
    }
}

PARIAN_HOT float eval_change(const float* delta, const float* gradient, const float* diagonal,
                             const float* off, std::size_t row) {
  Quad sum = {};
  Quad value;
  load(delta, value);
  for (std::size_t j = 0; j < row; j += 4) {
    Quad next = {}, slope, curvature, coupling;
    if (j + 4 < row) load(delta + j + 4, next);
    load(gradient + j, slope);
    load(diagonal + j, curvature);
    load(off + j, coupling);
    sum += value * (slope + 0.5f * curvature * value + coupling * next);
    value = next;
  }
  return sum_of(sum);
}

void add_curvature(const float* delta, const float* diagonal, const float* off, std::size_t row,
                   float* gradient) {
  for (std::size_t j = 0; j < row; ++j) gradient[j] += diagonal[j] * delta[j];
  for (std::size_t j = 0; j + 4 < row; ++j) {
    gradient[j] += off[j] * delta[j + 4];
    gradient[j + 4] += off[j] * delta[j];
  }
}

}  // namespace parian::kbmpp

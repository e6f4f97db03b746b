#include "fit/solve_kernels.h"

#include "base/hot.h"

namespace parian {
namespace {

// Fixed partial sums: the same bits for every instruction set.
constexpr std::size_t lanes = 8;

double total(const double* partial) {
  double sum = 0;
  for (std::size_t j = 0; j < lanes; ++j) sum += partial[j];
  return sum;
}

}  // namespace

PARIAN_HOT double dot_block(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                            std::size_t count) {
  double partial[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    for (std::size_t j = 0; j < lanes; ++j)
      partial[j] += static_cast<double>(a[i + j]) * static_cast<double>(b[i + j]);
  for (; i < count; ++i) partial[0] += static_cast<double>(a[i]) * static_cast<double>(b[i]);
  return total(partial);
}
PARIAN_HOT void step_sums_block(const float* PARIAN_RESTRICT d, const float* PARIAN_RESTRICT hd,
                                const float* PARIAN_RESTRICT r, StepSums* PARIAN_RESTRICT sums,
                                std::size_t count) {
  double a[lanes] = {}, b[lanes] = {}, c[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t j = 0; j < lanes; ++j) {
      const auto h = static_cast<double>(hd[i + j]);
      a[j] += static_cast<double>(d[i + j]) * h;
      b[j] += static_cast<double>(r[i + j]) * h;
      c[j] += h * h;
    }
  }
  for (; i < count; ++i) {
    const auto h = static_cast<double>(hd[i]);
    a[0] += static_cast<double>(d[i]) * h;
    b[0] += static_cast<double>(r[i]) * h;
    c[0] += h * h;
  }
  for (std::size_t j = 0; j < lanes; ++j) {
    sums->d_hd += a[j];
    sums->r_hd += b[j];
    sums->hd_hd += c[j];
  }
}
PARIAN_HOT double step_block(float alpha, const float* PARIAN_RESTRICT d,
                             const float* PARIAN_RESTRICT hd, float* PARIAN_RESTRICT x,
                             float* PARIAN_RESTRICT r, std::size_t count) {
  double partial[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t j = 0; j < lanes; ++j) {
      x[i + j] += alpha * d[i + j];
      r[i + j] -= alpha * hd[i + j];
      partial[j] += static_cast<double>(r[i + j]) * static_cast<double>(r[i + j]);
    }
  }
  for (; i < count; ++i) {
    x[i] += alpha * d[i];
    r[i] -= alpha * hd[i];
    partial[0] += static_cast<double>(r[i]) * static_cast<double>(r[i]);
  }
  return total(partial);
}
PARIAN_HOT void direction_block(float beta, const float* PARIAN_RESTRICT z,
                                float* PARIAN_RESTRICT d, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) d[i] = z[i] + beta * d[i];
}

PARIAN_HOT double subtract_block(double m, const double* PARIAN_RESTRICT b,
                                 double* PARIAN_RESTRICT g, std::size_t count) {
  double partial[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t j = 0; j < lanes; ++j) {
      partial[j] += m * (0.5 * g[i + j] - b[i + j]);
      g[i + j] -= b[i + j];
    }
  }
  for (; i < count; ++i) {
    partial[0] += m * (0.5 * g[i] - b[i]);
    g[i] -= b[i];
  }
  return total(partial);
}
PARIAN_HOT double dot_mixed_block(const double* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                                  std::size_t count) {
  double partial[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes)
    for (std::size_t j = 0; j < lanes; ++j) partial[j] += a[i + j] * static_cast<double>(b[i + j]);
  for (; i < count; ++i) partial[0] += a[i] * static_cast<double>(b[i]);
  return total(partial);
}
PARIAN_HOT void start_block(float factor, const double* PARIAN_RESTRICT g,
                            const float* PARIAN_RESTRICT hx, float* PARIAN_RESTRICT x,
                            float* PARIAN_RESTRICT r, std::size_t count) {
  if (factor == 0) {
    for (std::size_t i = 0; i < count; ++i) x[i] = 0;
    for (std::size_t i = 0; i < count; ++i) r[i] = static_cast<float>(-g[i]);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    x[i] *= factor;
    r[i] = static_cast<float>(-g[i] - static_cast<double>(factor * hx[i]));
  }
}
PARIAN_HOT double finish_block(double m, const double* PARIAN_RESTRICT g,
                               const float* PARIAN_RESTRICT x, const float* PARIAN_RESTRICT r,
                               float* PARIAN_RESTRICT hx, double* PARIAN_RESTRICT p,
                               std::size_t count) {
  double partial[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t j = 0; j < lanes; ++j) {
      const auto value = static_cast<double>(x[i + j]), rest = static_cast<double>(r[i + j]);
      partial[j] += value * (g[i + j] - rest);
      hx[i + j] = static_cast<float>(-g[i + j] - rest);
      p[i + j] = m + value;
    }
  }
  for (; i < count; ++i) {
    const auto value = static_cast<double>(x[i]), rest = static_cast<double>(r[i]);
    partial[0] += value * (g[i] - rest);
    hx[i] = static_cast<float>(-g[i] - rest);
    p[i] = m + value;
  }
  return total(partial);
}

PARIAN_HOT void sums_block(const double* values, std::size_t count, double* sum, double* squares) {
  double a[lanes] = {}, b[lanes] = {};
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    for (std::size_t j = 0; j < lanes; ++j) {
      a[j] += values[i + j];
      b[j] += values[i + j] * values[i + j];
    }
  }
  for (; i < count; ++i) {
    a[0] += values[i];
    b[0] += values[i] * values[i];
  }
  *sum = *squares = 0;
  for (std::size_t j = 0; j < lanes; ++j) {
    *sum += a[j];
    *squares += b[j];
  }
}

}  // namespace parian

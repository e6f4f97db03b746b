#include "fit/stream_kernels.h"

#include <cstdint>
#include <cstring>
#include <limits>

#include "base/hot.h"
#include "math/fast_log.h"

namespace parian {
namespace {

using Floats [[gnu::vector_size(4 * lane_count)]] = float;
using Ints [[gnu::vector_size(4 * lane_count)]] = std::int32_t;
using Doubles [[gnu::vector_size(4 * lane_count)]] = double;  // half of the lanes

// y = 2 ln R or 0 of one strip, 0 from `count` on. Each loop is one that compilers vectorise; their
// union is not.
[[gnu::always_inline]] inline void double_logs_of_strip(const float* PARIAN_RESTRICT r,
                                                        float* PARIAN_RESTRICT y, int count,
                                                        Doubles* PARIAN_RESTRICT sums,
                                                        Ints* PARIAN_RESTRICT known) {
  Ints place = {0, 1, 2, 3, 4, 5, 6, 7};
  alignas(64) float logs[log_strip];
  alignas(64) double squares[log_strip];
  for (std::size_t i = 0; i < log_strip; ++i) logs[i] = fast_log(r[i]);
  for (std::size_t i = 0; i < log_strip; i += lane_count) {
    Floats value;
    std::memcpy(&value, logs + i, sizeof(value));
    const Ints valid = reinterpret_cast<Ints>(value >= -1e30f) &  // neither NaN nor -infinity
                       reinterpret_cast<Ints>(place < count);     // -1 for true
    place += static_cast<int>(lane_count);
    value = reinterpret_cast<Floats>(reinterpret_cast<Ints>(value + value) & valid);
    std::memcpy(logs + i, &value, sizeof(value));
    std::memcpy(y + i, &value, sizeof(value));
    *known -= valid;
  }
  for (std::size_t i = 0; i < log_strip; ++i)
    squares[i] = static_cast<double>(logs[i]) * static_cast<double>(logs[i]);
  for (std::size_t i = 0; i < log_strip; i += lane_count / 2) {
    Doubles square;
    std::memcpy(&square, squares + i, sizeof(square));
    sums[i / (lane_count / 2) % 2] += square;
  }
}

}  // namespace

PARIAN_HOT void double_logs(const float* PARIAN_RESTRICT r, float* PARIAN_RESTRICT y,
                            std::size_t count, double* PARIAN_RESTRICT lanes, int* known) {
  Doubles squares[2] = {};
  Ints seen{};
  for (std::size_t i = 0; i < count; i += log_strip)
    double_logs_of_strip(r + i, y + i, static_cast<int>(count - i), squares, &seen);
  for (std::size_t j = 0; j < lane_count; ++j) {
    lanes[j] += squares[j / (lane_count / 2)][j % (lane_count / 2)];
    *known += seen[j];
  }
}

// low += sum_j a_j (s_j + t_j), high += sum_j b_j (s_j + t_j) for four offsets.
PARIAN_HOT void accumulate_row(double* PARIAN_RESTRICT low, double* PARIAN_RESTRICT high,
                               const float* const* sources, const double* a, const double* b,
                               std::size_t count) {
  const float *PARIAN_RESTRICT s0 = sources[0], *PARIAN_RESTRICT t0 = sources[1];
  const float *PARIAN_RESTRICT s1 = sources[2], *PARIAN_RESTRICT t1 = sources[3];
  const float *PARIAN_RESTRICT s2 = sources[4], *PARIAN_RESTRICT t2 = sources[5];
  const float *PARIAN_RESTRICT s3 = sources[6], *PARIAN_RESTRICT t3 = sources[7];
  const double a0 = a[0], a1 = a[1], a2 = a[2], a3 = a[3], b0 = b[0], b1 = b[1], b2 = b[2],
               b3 = b[3];
  for (std::size_t i = 0; i < count; ++i) {
    const auto y0 = static_cast<double>(s0[i] + t0[i]), y1 = static_cast<double>(s1[i] + t1[i]);
    const auto y2 = static_cast<double>(s2[i] + t2[i]), y3 = static_cast<double>(s3[i] + t3[i]);
    low[i] += (a0 * y0 + a1 * y1) + (a2 * y2 + a3 * y3);
    high[i] += (b0 * y0 + b1 * y1) + (b2 * y2 + b3 * y3);
  }
}

PARIAN_HOT double sum_known(const float* values, std::size_t count) {
  double lanes[lane_count] = {};
  std::size_t i = 0;
  for (; i + lane_count <= count; i += lane_count)
    for (std::size_t j = 0; j < lane_count; ++j)
      lanes[j] += values[i + j] > 0 ? static_cast<double>(values[i + j]) : 0.0;
  for (; i < count; ++i) lanes[0] += values[i] > 0 ? static_cast<double>(values[i]) : 0.0;
  double sum = 0;
  for (double lane : lanes) sum += lane;
  return sum;
}

}  // namespace parian

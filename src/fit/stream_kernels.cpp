#include "fit/stream_kernels.h"

#include <limits>

#include "base/hot.h"
#include "math/fast_log.h"

namespace parian {

// y = 2 ln R where R is known, else 0. Adds to the sum of squares and counts known values.
PARIAN_HOT void double_logs(const float* PARIAN_RESTRICT r, float* PARIAN_RESTRICT y,
                            std::size_t count, double* PARIAN_RESTRICT lanes, int* known) {
  // Two loops: compilers vectorise each, but not their union.
  for (std::size_t i = 0; i < count; ++i) y[i] = fast_log(r[i]);
  int seen = 0;
  std::size_t i = 0;
  for (; i + lane_count <= count; i += lane_count) {
    for (std::size_t j = 0; j < lane_count; ++j) {
      const bool valid = y[i + j] >= -1e30f;  // neither NaN nor -infinity
      const float value = valid ? 2 * y[i + j] : 0.0f;
      y[i + j] = value;
      lanes[j] += static_cast<double>(value) * static_cast<double>(value);
      seen += valid ? 1 : 0;
    }
  }
  for (; i < count; ++i) {
    const bool valid = y[i] >= -1e30f;
    y[i] = valid ? 2 * y[i] : 0.0f;
    lanes[0] += static_cast<double>(y[i]) * static_cast<double>(y[i]);
    seen += valid ? 1 : 0;
  }
  *known += seen;
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

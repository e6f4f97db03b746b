#include "edit/poisson_kernels.h"

#include <algorithm>
#include <cmath>

#include "base/hot.h"

namespace parian {

PARIAN_HOT void sweep_laplacian(const float* self, const float* scale, const float* b,
                                const float* x, const float* up, const float* down, float omega,
                                float keep, int count, float* PARIAN_RESTRICT out) {
  for (int i = 0; i < count; ++i) {
    const float sum = (x[i - 1] + x[i + 1]) + (up[i] + down[i]);
    out[i] = keep * x[i] + omega * scale[i] * (b[i] - self[i] * x[i] + sum);
  }
}

PARIAN_HOT void sweep_stencil(const StencilRows& a, const float* scale, const float* b,
                              const float* x, const float* up, const float* down, float omega,
                              float keep, int count, float* PARIAN_RESTRICT out) {
  const float *self = a.self, *right = a.right, *below = a.down, *down_right = a.down_right,
              *down_left = a.down_left;
  const float *above = a.up_down, *up_left = a.up_down_right, *up_right = a.up_down_left;
  for (int i = 0; i < count; ++i) {
    const float row = self[i] * x[i] + (right[i - 1] * x[i - 1] + right[i] * x[i + 1]);
    const float next =
        below[i] * down[i] + (down_left[i] * down[i - 1] + down_right[i] * down[i + 1]);
    const float last =
        above[i] * up[i] + (up_left[i - 1] * up[i - 1] + up_right[i + 1] * up[i + 1]);
    out[i] = keep * x[i] + omega * scale[i] * (b[i] - (row + (next + last)));
  }
}

PARIAN_HOT void scale_row(const float* scale, const float* b, float omega, int count,
                          float* PARIAN_RESTRICT out) {
  for (int i = 0; i < count; ++i) out[i] = omega * scale[i] * b[i];
}

PARIAN_HOT void restrict_rows(const float* last, const float* here, const float* next,
                              float next_weight, const float* mask, int fine_width,
                              int coarse_width, float* PARIAN_RESTRICT work,
                              float* PARIAN_RESTRICT coarse) {
  // work[i] is column i-1; the columns beyond the border are 0.
  for (int i = 0; i <= 2 * coarse_width; ++i)
    work[i] = here[i - 1] + (0.5f * last[i - 1] + next_weight * next[i - 1]);
  if (fine_width % 2 == 0) work[fine_width] *= 2;
  for (int i = 0; i < coarse_width; ++i)
    coarse[i] = mask[i] * (work[2 * i + 1] + 0.5f * (work[2 * i] + work[2 * i + 2]));
}

PARIAN_HOT void prolong_row(const float* a, const float* b, const float* mask, int fine_width,
                            int coarse_width, float* PARIAN_RESTRICT work,
                            float* PARIAN_RESTRICT fine) {
  for (int i = 0; i < coarse_width; ++i) work[i] = 0.5f * (a[i] + b[i]);
  work[coarse_width] = fine_width % 2 == 0 ? work[coarse_width - 1] : 0.0f;
  for (int i = 0; i < coarse_width; ++i) {
    fine[2 * i] += mask[2 * i] * work[i];
    fine[2 * i + 1] += mask[2 * i + 1] * (0.5f * (work[i] + work[i + 1]));
  }
}

// The sums below keep row_align partial sums: one order for every instruction set.
static double add_lanes(const double* lanes) {
  return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
         ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

PARIAN_HOT void find_residual_row(const ResidualRows& rows, const double* mask, double scale,
                                  int width, double* PARIAN_RESTRICT out) {
  const double *f = rows.f, *up = rows.up, *down = rows.down, *gx = rows.gradient_x;
  const double *gy = rows.gradient_y, *gy_up = rows.gradient_y_up;
  for (int i = 1; i < width - 1; ++i) {
    const double along_x = ((f[i - 1] - f[i]) + gx[i - 1]) + ((f[i + 1] - f[i]) - gx[i]);
    const double along_y = ((up[i] - f[i]) + gy_up[i]) + ((down[i] - f[i]) - gy[i]);
    const double sum = scale * (along_x + along_y);
    out[i] = mask[i] != 0 ? sum : 0.0;
  }
  const int step = width > 1 ? width - 1 : 1;
  for (int i = 0; i < width; i += step) {  // the first and last column
    const double left = i > 0 ? (f[i - 1] - f[i]) + gx[i - 1] : 0.0;
    const double right = i + 1 < width ? (f[i + 1] - f[i]) - gx[i] : 0.0;
    const double along_y = ((up[i] - f[i]) + gy_up[i]) + ((down[i] - f[i]) - gy[i]);
    const double sum = scale * ((left + right) + along_y);
    out[i] = mask[i] != 0 ? sum : 0.0;
  }
}

PARIAN_HOT double max_row(const double* values, const double* mask, int width) {
  double lanes[row_align] = {};
  int i = 0;
  for (; i + row_align <= width; i += row_align)
    for (int k = 0; k < row_align; ++k) {
      const double value = mask[i + k] != 0 ? std::abs(values[i + k]) : 0.0;
      lanes[k] = value > lanes[k] ? value : lanes[k];
    }
  for (; i < width; ++i)
    if (mask[i] != 0) lanes[0] = std::max(lanes[0], std::abs(values[i]));
  for (const double lane : lanes) lanes[0] = std::max(lanes[0], lane);
  return lanes[0];
}

PARIAN_HOT void add_row(const double* e, const double* mask, double scale, int width,
                        double* PARIAN_RESTRICT values) {
  for (int i = 0; i < width; ++i) {
    const double sum = values[i] + scale * e[i];
    values[i] = mask[i] != 0 ? sum : values[i];
  }
}

PARIAN_HOT double square_row(const double* values, int count) {
  double lanes[row_align] = {};
  for (int i = 0; i < count; i += row_align)
    for (int k = i; k < i + row_align; ++k) lanes[k - i] += values[k] * values[k];
  return add_lanes(lanes);
}

PARIAN_HOT double apply_laplacian(const double* self, const double* mask, const double* p,
                                  const double* up, const double* down, int count,
                                  double* PARIAN_RESTRICT q) {
  double lanes[row_align] = {};
  for (int i = 0; i < count; i += row_align)
    for (int k = i; k < i + row_align; ++k) {
      const double sum = (p[k - 1] + p[k + 1]) + (up[k] + down[k]);
      q[k] = mask[k] * (self[k] * p[k] - sum);
      lanes[k - i] += p[k] * q[k];
    }
  return add_lanes(lanes);
}

PARIAN_HOT double step_row(const double* p, const double* q, double alpha, int count,
                           double* PARIAN_RESTRICT e, double* PARIAN_RESTRICT r,
                           float* PARIAN_RESTRICT b) {
  double lanes[row_align] = {};
  for (int i = 0; i < count; i += row_align)
    for (int k = i; k < i + row_align; ++k) {
      e[k] += alpha * p[k];
      r[k] -= alpha * q[k];
      b[k] = static_cast<float>(r[k]);
      lanes[k - i] += r[k] * r[k];
    }
  return add_lanes(lanes);
}

PARIAN_HOT double dot_row(const double* r, const float* z, int count) {
  double lanes[row_align] = {};
  for (int i = 0; i < count; i += row_align)
    for (int k = i; k < i + row_align; ++k) lanes[k - i] += r[k] * static_cast<double>(z[k]);
  return add_lanes(lanes);
}

PARIAN_HOT void turn_row(const float* z, double beta, int count, double* PARIAN_RESTRICT p) {
  for (int i = 0; i < count; ++i) p[i] = static_cast<double>(z[i]) + beta * p[i];
}

}  // namespace parian

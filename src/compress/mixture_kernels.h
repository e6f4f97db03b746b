// Arithmetic on rows of `stride` floats (a multiple of 8): one pixel's profiles.
#pragma once

#include <cstddef>
#include <cstdint>

namespace parian {

// out = sum_k weight[k] bases[index[k]]
void mix_row(const float* bases, std::size_t stride, const std::uint16_t* index,
             const float* weight, std::size_t count, float* out);

// corners[k] = bases[index[k]] - target, and their Gram matrix in the tridiagonal metric of
// `diagonal` and `coupling`: gram[k * count + l].
void eval_corners(const float* bases, std::size_t stride, const std::uint16_t* index,
                  std::size_t count, const float* target, const float* diagonal,
                  const float* coupling, float* corners, float* gram);

// v^T D v of v = sum_k weight[k] corners[k].
float eval_mixed_corners(const float* corners, std::size_t stride, const float* weight,
                         std::size_t count, const float* diagonal, const float* coupling);

// out += scale D v
void add_metric_product(const float* diagonal, const float* coupling, const float* v, float scale,
                        float* out, std::size_t stride);

// a += scale b, of rows
void add_row(const float* b, float scale, float* a, std::size_t stride);

// out[j] = sum_k w[k] matrix[k][j] for columns j < count, a multiple of 32.
void project_row(const float* matrix, std::size_t rows, std::size_t count, const float* w,
                 float* out);

// Squared distance of a point to the segments from m to each corner j, up to the point's own norm:
// `inner`[j] = <m, V_j>, norm[j] = |V_j|^2, distance[j] = |w - V_j|^2, alpha = |w - m|^2,
// mm = |m|^2.
void screen_segments(const float* inner, const float* norm, const float* distance, float alpha,
                     float mm, float* out, std::size_t count);

}  // namespace parian

// Inner loops of the 2019 paper's energy. Planes are [y][x] of one channel and knot; rows hold a
// pixel's or a base's values [knot][4], channels padded to four.
#pragma once

#include <cstddef>
#include <cstdint>

namespace parian::kbmpp {

// out = low a + high b
void interpolate(const float* a, const float* b, float low, float high, std::size_t count,
                 float* out);

// Residuals e = q[i] + q[i + shift] - y[i] for i in [begin, end), 0 where y is NaN: adds e to
// at[i] and to at_partner[i + shift] (another plane), and returns the sum of e^2.
double add_residuals(const float* q, const float* y, std::ptrdiff_t shift, std::size_t begin,
                     std::size_t end, float* at, float* at_partner);

// As add_residuals with e = 1 where y is not NaN.
void add_counts(const float* y, std::ptrdiff_t shift, std::size_t begin, std::size_t end, float* at,
                float* at_partner);

// s = a + b; to_low += low s; to_high += high s; a and b become 0.
void spread(float* a, float* b, float low, float high, std::size_t count, float* to_low,
            float* to_high);

// rows[i] = sum_k weight[i][k] bases[index[i][k]] for `count` pixels (Eq. 4).
void mix_rows(const float* bases, const std::uint16_t* index, const float* weight,
              std::size_t count, std::size_t per_pixel, std::size_t row, float* rows);

// The transpose of mix_rows and its derivative by the weights:
// to_bases[index[i][k]] += weight[i][k] rows[i];  to_weight[i][k] = rows[i] . bases[index[i][k]]
void project_rows(const float* bases, const std::uint16_t* index, const float* weight,
                  const float* rows, std::size_t count, std::size_t per_pixel, std::size_t row,
                  float* to_bases, float* to_weight);

// delta . gradient + 1/2 delta^T D delta, D tridiagonal over knots: `diagonal` and `off` as rows.
float eval_change(const float* delta, const float* gradient, const float* diagonal,
                  const float* off, std::size_t row);

// gradient += D delta
void add_curvature(const float* delta, const float* diagonal, const float* off, std::size_t row,
                   float* gradient);

}  // namespace parian::kbmpp

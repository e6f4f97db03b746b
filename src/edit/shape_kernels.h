// The vectorised inner loops over blocks of shape_lanes profiles side by side.
#pragma once

#include "edit/shape_planes.h"

namespace parian {

inline constexpr double log_of_support = 9.210340371976182;  // -ln(support_threshold)

// The measurement of a block; see measure_shapes.
struct ShapeSums {
  alignas(64) double value[shape_lanes];     // P at the last knot
  alignas(64) double integral[shape_lanes];  // int P r dr; after finish_shapes 2 pi times it
  alignas(64) double tail[shape_lanes];      // after finish_shapes: support beyond the last knot
};
// Over all knots; rows[k * stride + i] is ln P_i at radius[k].
void sum_segments(const float* rows, std::size_t stride, const double* radius, std::size_t knots,
                  ShapeSums* sums);

// Where P falls below the threshold for good: the last segment that crosses the level.
struct ShapeCrossings {
  alignas(64) float top[shape_lanes];      // largest ln P
  alignas(64) float segment[shape_lanes];  // its index, whole; -1: none so far
};
// Of all lanes of the rows; as sum_segments.
void find_crossings(const float* rows, std::size_t stride, std::size_t knots,
                    ShapeCrossings* crossings);

// The tail beyond the last knot, from ln P there and at the knot before.
void finish_shapes(const float* before, const float* end, double last_radius, double last_length,
                   const ShapeCrossings* crossings, ShapeSums* sums);

// Rows of profiles on common knots: value[k * shape_lanes + i].
struct ShapeRows {
  const float* value;
  const float* radius;          // [knot]
  const float* inverse_length;  // [segment]
  const float* tail_slope;      // [lane], of ln P beyond the last knot
  const float* support;         // [lane], mm: ends there (log_of_zero)
  std::size_t knots;
};
inline constexpr float log_of_zero = -1e4f;

// Tail slope and support of rows [knot][lane], as the kernels want them.
struct ShapeTails {
  alignas(64) float slope[shape_lanes];
  alignas(64) float support[shape_lanes];
};
// range_mm as measure_shapes finds it.
void find_tails(const KnotTable& knots, const float* rows, const double* range_mm,
                ShapeTails* tails);
// From ln P before the last knot and at it.
void finish_tails(const float* before, const float* end, const double* range_mm, double last_radius,
                  float inverse_length, ShapeTails* tails);
// ln(alpha^2 / C) of 2 pi C and alpha: what turns ln P into ln S.
void fill_log_scales(const double* range, const double* albedo, float* out);
// Refers to all three.
ShapeRows view_rows(const KnotTable& knots, const float* rows, const ShapeTails& tails);

// out[k * shape_lanes + i] = ln P_i at radius[k] * scale[i].
void sample_shapes(const ShapeRows& rows, const float* scale, float* out);

// Where both sides of a mixture are sampled: at r / alpha' of their own ranges, with
// 1 / alpha' = (1 - w) / alpha_1 + w / alpha_2 and w = amount part.
struct MixScales {
  alignas(64) float weight[shape_lanes];
  alignas(64) float first[shape_lanes];
  alignas(64) float second[shape_lanes];
};
void fill_mix_scales(const double* range_1, const double* range_2, const float* part, double amount,
                     MixScales* scales);

// Rows of ln((1 - w) e^(a + a_shift) + w e^(b + b_shift)), lane by lane.
void mix_shapes(const float* a, const float* a_shift, const float* b, const float* b_shift,
                const float* w, std::size_t knots, float* out);

// S' = scale(u) S0 (S / S0)^exponent + offset(u), per lane interpolated by `amount`.
struct ShapeCurves {
  const float* scale;   // [samples + 1] over u in [0, 1]
  const float* offset;  // likewise; 0 beyond u = 1; null: none
  int samples;
  alignas(64) float inverse_range[shape_lanes];
  alignas(64) float shift[shape_lanes];  // ln S - ln P
  alignas(64) float exponent[shape_lanes];
};
// `row` is ln P at `radius`, `first` at 0; `out` is ln S'.
void bend_shape_row(const ShapeCurves* curves, float radius, const float* row, const float* first,
                    const float* amount, float* out);

}  // namespace parian

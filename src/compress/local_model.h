// What every objective of the compression offers its optimiser: its value at a field of profiles,
// and a separable quadratic around it.
//
//   F(p + delta) ~ F(p) + sum_x [ g_x^T delta_x + 1/2 delta_x^T D_x delta_x ]
//
// A field p is ln P at the knots, planes [channel][knot][y][x]. D_x is tridiagonal over the knots
// of each channel. Where D_x bounds the curvature of F (the pair (x, y) couples by (u + v)^2, which
// is at most 2 u^2 + 2 v^2), a step that lowers the right side lowers F, whatever other pixels do.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "base/aligned.h"

namespace parian {

// Sizes of rows: one pixel's profiles, all channels and knots, padded for whole vectors.
struct RowShape {
  std::size_t pixels = 0, channels = 0, knots = 0;
  std::size_t stride() const { return (channels * knots + 7) / 8 * 8; }
  std::size_t row(std::size_t pixel) const { return pixel * stride(); }
};

// D, one row a pixel: element channel * knots + knot; `coupling` of a knot with the next, 0 at the
// last of each channel and in the padding, where `diagonal` is 0 too.
struct LocalMetric {
  RowShape shape;
  AlignedVector<float> diagonal, coupling;
};

// Squared errors of each pixel, for objectives that know them; empty otherwise.
struct PixelErrors {
  std::vector<float> relative, albedo;
};

struct BlendObjective {
  RowShape shape;
  LocalMetric metric;
  double curvature_weight = 0;  // of 1/2 sum of squared second differences of the base profiles
  // F(p) without the base profiles' own term; writes its gradient [channel][knot][y][x] and the
  // pixels' errors where they are not null.
  std::function<double(const float* field, float* gradient, PixelErrors* errors)> eval;
};

// [channel][knot][pixel] <-> rows [pixel][channel * knots + knot], padding 0.
AlignedVector<float> make_rows(const RowShape& shape, const float* planes);
void scatter_rows(const RowShape& shape, const float* rows, float* planes);

}  // namespace parian

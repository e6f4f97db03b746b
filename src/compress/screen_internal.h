// Rows in coordinates where the common metric is the identity.
#pragma once

#include <vector>

#include "compress/mixture.h"

namespace parian {

// The mean of all pixels' metrics, D = L L^T, L lower bidiagonal.
struct CommonMetric {
  RowShape shape;
  std::vector<float> diagonal, next;  // of L^T: (L^T v)_i = diagonal_i v_i + next_i v_{i+1}
  std::vector<float> centre;          // subtracted first, so that products keep their digits
};
CommonMetric make_common_metric(const LocalMetric& metric, const AlignedVector<float>& rows);
void whiten(const CommonMetric& common, const float* row, float* out);

// Up to this many bases all pairs' inner products are kept.
inline constexpr std::size_t max_gram_bases = 2048;

struct ScreenedBases {
  std::size_t count = 0, padded = 0;  // bases, and columns
  AlignedVector<float> columns;       // [stride][padded]: whitened bases
  AlignedVector<float> norm;          // [padded]; of padding huge, so that it is never near
  AlignedVector<float> gram;          // [padded][padded], or empty
};
ScreenedBases screen_bases(const CommonMetric& common, const AlignedVector<float>& bases);

}  // namespace parian

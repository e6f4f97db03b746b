// New profile shapes for some pixels of a state, block by block: what every edit of shapes shares.
#pragma once

#include <functional>

#include "edit/edit_state.h"

namespace parian {

// Up to shape_lanes profiles side by side; idle lanes repeat the last one.
struct ShapeBlock {
  int channel = 0;
  std::size_t first = 0;  // pixel
  std::size_t count = 0;
  const float* rows = nullptr;       // [knot][lane], ln P of the knots alone
  const float* amount = nullptr;     // [lane]
  const double* albedo = nullptr;    // [lane] of the knots alone
  const double* range_mm = nullptr;  // [lane]
  float* scratch = nullptr;          // room for two blocks of rows
};

// Writes the new rows of a block, [knot][lane], in any scale of P and of r: albedo and range are
// set afterwards.
using ShapeFunction = std::function<void(const ShapeBlock& block, float* rows)>;

// Where amount[pixel] > 0 the profiles get the new rows, and gain and dilation such that albedo and
// range stay. Elsewhere nothing changes, bit for bit.
void reshape(EditState& state, const std::vector<float>& amount, const ShapeFunction& make_rows);

// value[k][lane] never rises with k: a running minimum, which keeps every profile that falls.
void make_rows_non_increasing(float* rows, std::size_t knots);

}  // namespace parian

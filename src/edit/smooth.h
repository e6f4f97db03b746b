// Filtering of properties as of images (SubEdit, section 7.1): albedo and range in logarithms, so
// that ratios count and nothing turns negative, shapes as ln S at equal places in units of the
// range.
#pragma once

#include "base/params.h"
#include "edit/edit_state.h"

namespace parian {

enum class FilterKind { gaussian, bilateral, unsharp };

struct FilterParams {
  FilterKind kind = FilterKind::gaussian;
  double sigma_mm = 1;
  // Of the bilateral filter, in ln albedo and ln range, jointly over channels: one weight for all.
  double range_sigma = 0.3;
  double amount = 1;  // of unsharp: f + amount (f - G f)
  bool albedo = true;
  bool range = true;
  bool shape = false;
};
ParamList describe(FilterParams& params);

// The change is taken in part where the mask is below 1; 0 changes nothing, bit for bit. The
// filter itself sees the whole map.
void apply(const FilterParams& params, EditState& state, const Mask& mask, EditReport& report);

}  // namespace parian

// The plain numbers of selections: read by them, and shown as sliders.
#pragma once

#include <string>
#include <vector>

#include "edit/read_parts_internal.h"
#include "edit/selection_property.h"

namespace parian {

struct EllipseNumbers {
  double rotation_deg = 0;
};
ParamList describe(EllipseNumbers& numbers);

struct BrushNumbers {
  double radius = 1;
  double hardness = 0.5;
};
ParamList describe(BrushNumbers& numbers);

struct ThresholdNumbers {
  SelectionProperty property = SelectionProperty::albedo;
  bool current = false;
  double low = -1e9, high = 1e9, softness = 0;
};
ParamList describe(ThresholdNumbers& numbers);

// Applied in this order.
struct Modifiers {
  double grow = 0, feather = 0;
  bool invert = false;
};
ParamList describe(Modifiers& numbers);

}  // namespace parian

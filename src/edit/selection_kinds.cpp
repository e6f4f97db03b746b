#include "edit/selection_kinds_internal.h"

namespace parian {

ParamList describe(EllipseNumbers& numbers) {
  return {{.name = "rotation-deg",
           .help = "turned from x to y",
           .target = &numbers.rotation_deg,
           .min = -360,
           .max = 360,
           .unit = "degrees"}};
}

ParamList describe(BrushNumbers& numbers) {
  return {{.name = "radius",
           .help = "of the brush",
           .target = &numbers.radius,
           .min = 1e-6,
           .max = max_edit_length_mm,
           .unit = "mm"},
          {.name = "hardness",
           .help = "part of the radius that is fully selected",
           .target = &numbers.hardness,
           .min = 0,
           .max = 1}};
}

ParamList describe(ThresholdNumbers& numbers) {
  constexpr double most = 1e9;
  return {
      {.name = "property",
       .help = "what is compared",
       .target = make_choice(numbers.property, selection_property_names())},
      {.name = "low", .help = "lower bound", .target = &numbers.low, .min = -most, .max = most},
      {.name = "high", .help = "upper bound", .target = &numbers.high, .min = -most, .max = most},
      {.name = "softness",
       .help = "width of the transition at the bounds",
       .target = &numbers.softness,
       .min = 0,
       .max = most},
      describe_state(numbers.current)};
}

ParamList describe(Modifiers& numbers) {
  return {{.name = "grow",
           .help = "widens the selection; negative narrows it",
           .target = &numbers.grow,
           .min = -max_edit_length_mm,
           .max = max_edit_length_mm,
           .unit = "mm"},
          {.name = "feather",
           .help = "softens its edge",
           .target = &numbers.feather,
           .min = 0,
           .max = max_edit_length_mm,
           .unit = "mm"},
          {.name = "invert", .help = "what was not selected", .target = &numbers.invert}};
}

}  // namespace parian

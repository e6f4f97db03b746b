// What layers can do: one file each, op_....cpp; see OperationKind for adding one.
#pragma once

#include "edit/recipe.h"

namespace parian {

OperationKind make_adjust_operation();
OperationKind make_interpolate_operation();
OperationKind make_shape_operation();
OperationKind make_blend_operation();
OperationKind make_paste_operation();
OperationKind make_filter_operation();
OperationKind make_hallucinate_operation();
OperationKind make_bound_operation();
OperationKind make_monotone_operation();
OperationKind make_crop_operation();
OperationKind make_tile_operation();
OperationKind make_flip_operation();
OperationKind make_rotate_operation();
OperationKind make_resample_operation();
OperationKind make_synthesize_operation();

}  // namespace parian

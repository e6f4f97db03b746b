// The list of operations.
#include "edit/operations.h"

namespace parian {

const std::vector<OperationKind>& operation_kinds() {
  static const std::vector<OperationKind> kinds{
      make_adjust_operation(),      make_interpolate_operation(), make_shape_operation(),
      make_blend_operation(),       make_paste_operation(),       make_filter_operation(),
      make_hallucinate_operation(), make_bound_operation(),       make_monotone_operation(),
      make_crop_operation(),        make_tile_operation(),        make_flip_operation(),
      make_rotate_operation(),      make_resample_operation(),    make_synthesize_operation()};
  return kinds;
}

}  // namespace parian

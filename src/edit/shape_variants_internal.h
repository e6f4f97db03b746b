// The kernels of shape_kernels.h that are compiled for several instruction sets.
#pragma once

#include <vector>

#include "edit/shape_kernels.h"

namespace parian {

struct ShapeVariant {
  const char* name;
  decltype(&sum_segments) sum;
  decltype(&find_crossings) cross;
  decltype(&finish_shapes) finish;
  decltype(&sample_shapes) sample;
  decltype(&mix_shapes) mix;
};
// Those that this processor can run, the fastest last.
std::vector<ShapeVariant> supported_shape_variants();

}  // namespace parian

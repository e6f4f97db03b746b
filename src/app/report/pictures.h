// Small helpers of the pages' pictures.
#pragma once

#include "image/image.h"

namespace parian {

// The largest finite value, or 0.
double largest_value(const Image& values);

// |a - b| per value.
Image absolute_difference(const Image& a, const Image& b);

}  // namespace parian

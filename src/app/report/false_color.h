// Single numbers per pixel as colours, for error images.
#pragma once

#include "image/image.h"

namespace parian {

// Black through violet, red and orange to pale yellow as the value goes from 0 to `scale` (0: the
// largest value); values that are not finite are grey. Takes 1 channel, gives 3 (linear Rec. 709).
Image draw_false_color(const Image& values, double scale = 0);

// The largest finite value, or 0.
double largest_value(const Image& values);

// |a - b| per value.
Image absolute_difference(const Image& a, const Image& b);

}  // namespace parian

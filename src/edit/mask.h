// Soft selections: a weight for each pixel of a map, and the algebra of selections.
#pragma once

#include <cstddef>
#include <vector>

#include "image/image.h"

namespace parian {

struct Mask {
  int width = 0;
  int height = 0;
  std::vector<float> weight;  // [y][x] in [0, 1]

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

Mask make_mask(int width, int height, float value);
bool is_empty(const Mask& mask);  // all 0

// The luminance of an image with three channels, or its one channel, clamped to [0, 1]; an image of
// another size is stretched over the map. Throws Error for values that are not finite.
Mask make_mask(const Image& image, int width, int height);

// 1 where low <= value <= high, falling smoothly to 0 over `softness` beyond; 0 for NaN.
Mask threshold(const double* values, int width, int height, double low, double high,
               double softness);

// Pixel by pixel, of masks of one size.
Mask unite(const Mask& a, const Mask& b);      // the larger
Mask intersect(const Mask& a, const Mask& b);  // the smaller
Mask subtract(const Mask& a, const Mask& b);   // the smaller of a and 1 - b
Mask invert(Mask mask);                        // 1 - a
Mask scale(Mask mask, double factor);          // factor in [0, 1]

// Blurred by a Gaussian, mirrored at the borders; the mean stays. sigma <= 0 changes nothing.
Mask feather(const Mask& mask, double sigma_px);
// The largest weight within a disc, whose rim covers pixels in part, times that part: a straight
// edge moves by the radius. A negative radius shrinks, the same of what is not selected. Nothing
// comes in from beyond the map. The time grows with the radius, not with its square.
Mask grow(const Mask& mask, double radius_px);

}  // namespace parian

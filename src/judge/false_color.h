// Numbers as colours: error images that a person can read.
#pragma once

#include <array>
#include <string>

#include "image/image.h"

namespace parian {

// A colour of a perceptual map, dark violet at 0 over teal to light yellow at 1, of increasing
// luminance; linear Rec. 709. `value` is clamped to [0, 1].
std::array<float, 3> map_color(double value);

// The first channel of `values`, from 0 to max; NaN is grey.
Image false_color(const Image& values, double max);

// The same, every pixel magnified, with a title above and a labelled colour bar to the right.
Image draw_color_map(const Image& values, double max, int magnification, const std::string& title);

}  // namespace parian

// PNG of 16 bits, which stb does not write. Internal to this folder.
#pragma once

#include <string>

#include "image/image.h"

namespace parian {

// Values in [0, 1] become codes in [0, 2^bits - 1], rounded; bits is 8 or 16. NaN becomes 0.
std::string encode_raw_png(const Image& image, int bits);

}  // namespace parian

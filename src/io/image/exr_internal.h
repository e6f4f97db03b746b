// OpenEXR images. Internal to this folder.
#pragma once

#include <string>

#include "image/image.h"

namespace parian {

// R, G, B (those that are there; the others 0) or Y; half, float or integer.
Image decode_exr(const std::string& bytes, const std::string& path);
// Float, ZIP; channels R, G, B or Y.
std::string encode_exr(const Image& image, const std::string& path);

}  // namespace parian

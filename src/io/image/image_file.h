// Image files by extension: .png and .jpg are sRGB-encoded 8 bit, .exr and .hdr linear.
#pragma once

#include <string>

#include "image/image.h"

namespace parian {

// 1 or 3 channels, linear Rec. 709 (grey stays one channel, alpha is dropped). At most 2^28 pixels.
Image load_image(const std::string& path);
// PNG: sRGB-encoded, clamped to [0, 1]. EXR: float, ZIP. HDR: Radiance. Anything else is an error.
void save_image(const std::string& path, const Image& image);

}  // namespace parian

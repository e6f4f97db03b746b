// Image files by extension: .png and .jpg are sRGB-encoded 8 bit, .exr and .hdr linear.
#pragma once

#include <string>

#include "image/image.h"

namespace parian {

// 1 or 3 channels, linear Rec. 709 (grey stays one channel, alpha is dropped). At most 2^28 pixels.
Image load_image(const std::string& path);
// PNG: sRGB-encoded, clamped to [0, 1]. EXR: float, ZIP. HDR: Radiance. Anything else is an error.
void save_image(const std::string& path, const Image& image);

// What a camera stored: .png codes (8 or 16 bit) over the largest code, without a transfer curve,
// and .exr values as they are. `allow_nan` lets NaN pass; infinities never do.
Image load_raw_image(const std::string& path, bool allow_nan = false);
// Values in [0, 1] as .png codes of 8 or 16 bits, without a transfer curve; clamped.
void save_raw_png(const std::string& path, const Image& image, int bits);

}  // namespace parian

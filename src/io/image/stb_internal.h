// PNG and JPEG, and writing Radiance HDR, through stb, whose implementation is compiled in stb.cpp
// alone. Internal to this folder.
#pragma once

#include <string>

#include "image/image.h"

namespace parian {

// 8 and 16 bit, sRGB-encoded; as_stored: codes over the largest one.
Image decode_png_or_jpeg(const std::string& bytes, const std::string& path, bool as_stored = false);
std::string encode_png(const Image& image);
std::string encode_hdr(const Image& image);

}  // namespace parian

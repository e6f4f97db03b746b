// Radiance HDR images (RGBE), read by a decoder of our own: that of stb runs forever on truncated
// files (CVE-2021-42715). Internal to this folder.
#pragma once

#include <string>

#include "image/image.h"

namespace parian {

// Row-run-length-encoded and plain scanlines, orientation -Y +X, 3 channels.
Image decode_hdr(const std::string& bytes, const std::string& path);

}  // namespace parian

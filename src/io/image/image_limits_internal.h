// What an image file may claim before anything is allocated for it. Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace parian {

// Pixels per byte of file beyond which a stated size is not believed: deflate (PNG) reaches 1032
// bytes per byte; JPEG and run lengths less; OpenEXR's lossy codecs more.
inline constexpr double stb_compression = 4096;
inline constexpr double exr_compression = 131072;

// Throws unless 1 <= width * height <= 2^28 and the file is large enough to hold that.
void check_image_size(const std::string& path, std::int64_t width, std::int64_t height,
                      std::size_t file_bytes, double pixels_per_byte);

}  // namespace parian

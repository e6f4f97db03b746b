#include "io/image/png_internal.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/check.h"

namespace parian {
namespace {

void append_u32(std::string& bytes, std::uint32_t value) {
  for (unsigned shift = 32; shift > 0; shift -= 8)
    bytes += static_cast<char>((value >> (shift - 8)) & 255u);
}

// PNG specification, 5.3: length, type, data, CRC-32 of type and data.
void append_chunk(std::string& bytes, const std::string& type, const std::string& data) {
  append_u32(bytes, static_cast<std::uint32_t>(data.size()));
  const std::string content = type + data;
  bytes += content;
  append_u32(bytes,
             static_cast<std::uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(content.data()),
                                              static_cast<uInt>(content.size()))));
}

// Rows of big-endian codes, each less the code to its left (filter 1, "Sub").
std::string filter_rows(const Image& image, int bits) {
  const auto bytes_per_value = static_cast<std::size_t>(bits / 8);
  const std::size_t row_values =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.channels);
  const std::size_t pixel_bytes = bytes_per_value * static_cast<std::size_t>(image.channels);
  const float top = bits == 16 ? 65535.0f : 255.0f;
  std::string rows;
  rows.reserve((row_values * bytes_per_value + 1) * static_cast<std::size_t>(image.height));
  std::vector<unsigned char> row(row_values * bytes_per_value);
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    for (std::size_t i = 0; i < row_values; ++i) {
      const float value = image.values[y * row_values + i];
      const float clamped = std::isnan(value) ? 0.0f : std::clamp(value, 0.0f, 1.0f);
      const auto code = static_cast<unsigned>(std::lround(top * clamped));
      if (bits == 16) {
        row[2 * i] = static_cast<unsigned char>(code >> 8u);
        row[2 * i + 1] = static_cast<unsigned char>(code & 255u);
      } else {
        row[i] = static_cast<unsigned char>(code);
      }
    }
    rows += '\1';
    for (std::size_t i = 0; i < row.size(); ++i) {
      const int left = i < pixel_bytes ? 0 : row[i - pixel_bytes];
      rows += static_cast<char>((row[i] - left) & 255);
    }
  }
  return rows;
}

}  // namespace

std::string encode_raw_png(const Image& image, int bits) {
  const std::string rows = filter_rows(image, bits);
  uLongf size = compressBound(rows.size());
  std::string packed(size, '\0');
  const int status = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(rows.data()), rows.size(), 3);
  PARIAN_CHECK_EQ(status, Z_OK);
  packed.resize(size);
  std::string header;
  append_u32(header, static_cast<std::uint32_t>(image.width));
  append_u32(header, static_cast<std::uint32_t>(image.height));
  header += static_cast<char>(bits);
  header += static_cast<char>(image.channels == 1 ? 0 : 2);  // grey or RGB
  header += std::string(3, '\0');                            // deflate, filters, not interlaced
  std::string bytes = "\x89PNG\r\n\x1a\n";
  append_chunk(bytes, "IHDR", header);
  append_chunk(bytes, "IDAT", packed);
  append_chunk(bytes, "IEND", {});
  return bytes;
}

}  // namespace parian

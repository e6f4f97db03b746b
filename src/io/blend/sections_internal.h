// Bytes of .kbm files: little-endian numbers, and sections with their lengths and checksums.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace parian {

static_assert(std::endian::native == std::endian::little, "files are written as memory lies");

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

// CRC-32 as in gzip and PNG.
std::uint32_t checksum_of(std::string_view bytes);

// Length (uint64), checksum (uint32), payload.
void append_section(std::string& bytes, std::string_view payload);

// Reads from the front; errors name the file and `place`.
struct ByteReader {
  std::string_view bytes;
  std::string file;

  // Throws Error "PLACE: expected N bytes, found M" when fewer are left.
  std::string_view take(std::size_t count, const std::string& place);
  template <typename T>
  T read(const std::string& place) {
    T value;
    const std::string_view from = take(sizeof(T), place);
    std::char_traits<char>::copy(reinterpret_cast<char*>(&value), from.data(), sizeof(T));
    return value;
  }
  std::string_view take_section(const std::string& place);
};

// Floats as they lie, and back. The number of values has been checked.
std::string_view bytes_of(const std::vector<float>& values);
std::vector<float> floats_of(std::string_view bytes);

// Integers of one plane below 2^(8 width), in rows: each value less a neighbour's (whichever of
// none, left, upper makes the least bytes), split into bytes and compressed.
// Layout: uint8 filter, uint32 length, zstd frame of `width` planes of bytes, low byte first.
void append_plane(std::string& bytes, const std::vector<std::uint32_t>& values,
                  std::size_t row_length, std::size_t width);
// `count` values; throws Error for damage and for sizes that the frame cannot hold.
std::vector<std::uint32_t> read_plane(ByteReader& reader, std::size_t count, std::size_t row_length,
                                      std::size_t width, const std::string& place);

}  // namespace parian

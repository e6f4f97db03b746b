#include <fmt/format.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>

#include "base/error.h"
#include "io/blend/sections_internal.h"

namespace parian {
namespace {

constexpr int level = 19;
// A frame's block of 128 KiB takes at least 4 bytes: what claims more is damaged.
constexpr std::size_t largest_ratio = 32768;

enum Filter : std::uint8_t { none, left, upper, filters };

// The value's neighbour that the filter subtracts, or 0.
std::uint32_t predict(const std::vector<std::uint32_t>& values, std::size_t i,
                      std::size_t row_length, std::uint8_t filter) {
  if (filter == left && i % row_length > 0) return values[i - 1];
  if (filter == upper && i >= row_length) return values[i - row_length];
  return 0;
}

std::string split(const std::vector<std::uint32_t>& values, std::size_t row_length,
                  std::size_t width, std::uint8_t filter) {
  std::string bytes(values.size() * width, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::uint32_t residual = values[i] - predict(values, i, row_length, filter);
    for (std::size_t b = 0; b < width; ++b)
      bytes[b * values.size() + i] = static_cast<char>(residual >> (8 * b) & 0xffu);
  }
  return bytes;
}

std::string compress(const std::string& bytes) {
  std::string packed(ZSTD_compressBound(bytes.size()), 0);
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), level);
  if (ZSTD_isError(size)) throw Error({{}, "zstd", "a compressed plane", ZSTD_getErrorName(size)});
  packed.resize(size);
  return packed;
}

}  // namespace

std::uint32_t checksum_of(std::string_view bytes) {
  uLong crc = crc32(0, nullptr, 0);
  for (std::size_t at = 0; at < bytes.size();) {
    const auto count = static_cast<uInt>(
        std::min<std::size_t>(bytes.size() - at, std::numeric_limits<uInt>::max()));
    crc = crc32(crc, reinterpret_cast<const Bytef*>(bytes.data() + at), count);
    at += count;
  }
  return static_cast<std::uint32_t>(crc);
}

void append_section(std::string& bytes, std::string_view payload) {
  append(bytes, static_cast<std::uint64_t>(payload.size()));
  append(bytes, checksum_of(payload));
  bytes.append(payload);
}

std::string_view ByteReader::take(std::size_t count, const std::string& place) {
  if (count > bytes.size())
    throw Error({file, place, fmt::format("{} bytes", count),
                 fmt::format("{} before the file's end", bytes.size())});
  const std::string_view taken = bytes.substr(0, count);
  bytes.remove_prefix(count);
  return taken;
}

std::string_view ByteReader::take_section(const std::string& place) {
  const auto count = read<std::uint64_t>(place);
  const auto expected = read<std::uint32_t>(place);
  const std::string_view payload = take(static_cast<std::size_t>(count), place);
  const std::uint32_t found = checksum_of(payload);
  if (found != expected)
    throw Error({file, place, fmt::format("checksum {:08x}", expected),
                 fmt::format("{:08x}: the file is damaged", found)});
  return payload;
}

std::string_view bytes_of(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

std::vector<float> floats_of(std::string_view bytes) {
  std::vector<float> values(bytes.size() / sizeof(float));
  std::char_traits<char>::copy(reinterpret_cast<char*>(values.data()), bytes.data(),
                               values.size() * sizeof(float));
  return values;
}

void append_plane(std::string& bytes, const std::vector<std::uint32_t>& values,
                  std::size_t row_length, std::size_t width) {
  std::string best;
  std::uint8_t chosen = none;
  for (std::uint8_t filter = none; filter < filters; ++filter) {
    std::string packed = compress(split(values, row_length, width, filter));
    if (filter > none && packed.size() >= best.size()) continue;
    best = std::move(packed);
    chosen = filter;
  }
  append(bytes, chosen);
  append(bytes, static_cast<std::uint32_t>(best.size()));
  bytes += best;
}

std::vector<std::uint32_t> read_plane(ByteReader& reader, std::size_t count, std::size_t row_length,
                                      std::size_t width, const std::string& place) {
  const auto filter = reader.read<std::uint8_t>(place);
  if (filter >= filters)
    throw Error({reader.file, place, fmt::format("a filter below {}", static_cast<int>(filters)),
                 fmt::format("{}", filter)});
  const auto size = reader.read<std::uint32_t>(place);
  const std::string_view frame = reader.take(size, place);
  const std::size_t expected = count * width;
  if (expected / largest_ratio > frame.size())
    throw Error({reader.file, place, fmt::format("a frame of {} bytes", expected),
                 fmt::format("{} bytes, too few to hold them", frame.size())});
  std::string plain(expected, 0);
  const std::size_t got = ZSTD_decompress(plain.data(), plain.size(), frame.data(), frame.size());
  if (ZSTD_isError(got) || got != expected)
    throw Error({reader.file, place, fmt::format("a zstd frame of {} bytes", expected),
                 ZSTD_isError(got) ? ZSTD_getErrorName(got) : fmt::format("{}", got)});
  const std::uint32_t mask = width >= 4 ? ~std::uint32_t{0} : (std::uint32_t{1} << (8 * width)) - 1;
  std::vector<std::uint32_t> values(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t residual = 0;
    for (std::size_t b = 0; b < width; ++b)
      residual |= static_cast<std::uint32_t>(static_cast<unsigned char>(plain[b * count + i]))
                  << (8 * b);
    values[i] = (residual + predict(values, i, row_length, filter)) & mask;
  }
  return values;
}

}  // namespace parian

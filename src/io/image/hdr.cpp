#include "io/image/hdr_internal.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "base/error.h"
#include "io/image/image_limits_internal.h"

namespace parian {
namespace {

using Pixel = std::array<unsigned char, 4>;  // mantissas of R, G, B and the shared exponent

struct Reader {
  const std::string& bytes;
  const std::string& path;
  std::size_t at = 0;

  [[noreturn]] void fail(const std::string& found) const {
    throw Error({.file = path, .expected = "a whole Radiance HDR image", .found = found});
  }
  unsigned char next() {
    if (at >= bytes.size()) fail("the end of the file");
    return static_cast<unsigned char>(bytes[at++]);
  }
  std::string next_line() {
    constexpr std::size_t longest = 4096;
    const std::size_t end = bytes.find('\n', at);
    if (end == std::string::npos || end - at > longest) fail("no end of its header");
    std::string line = bytes.substr(at, end - at);
    at = end + 1;
    return line;
  }
};

// The text header ends with an empty line; then comes the resolution.
void read_header(Reader& reader, int& width, int& height) {
  const std::string magic = reader.next_line();
  if (magic != "#?RADIANCE" && magic != "#?RGBE")
    throw Error(
        {.file = reader.path, .expected = "a Radiance HDR image", .found = "something else"});
  bool is_rgbe = false;
  for (std::string line = reader.next_line(); !line.empty(); line = reader.next_line())
    is_rgbe = is_rgbe || line == "FORMAT=32-bit_rle_rgbe";
  if (!is_rgbe) reader.fail("another format than 32-bit_rle_rgbe");
  const std::string size = reader.next_line();
  if (std::sscanf(size.c_str(), "-Y %9d +X %9d", &height, &width) != 2)
    reader.fail("a resolution that is not '-Y height +X width'");
}

// Four planes of runs: a count above 128 repeats one byte count - 128 times, others copy bytes.
void read_runs(Reader& reader, std::vector<Pixel>& row) {
  for (std::size_t plane = 0; plane < 4; ++plane) {
    for (std::size_t x = 0; x < row.size();) {
      const std::size_t code = reader.next();
      const std::size_t count = code > 128 ? code - 128 : code;
      if (count == 0 || count > row.size() - x) reader.fail("a run beyond its row");
      const unsigned char first = reader.next();
      for (std::size_t i = 0; i < count; ++i)
        row[x + i][plane] = code > 128 || i == 0 ? first : reader.next();
      x += count;
    }
  }
}

void read_row(Reader& reader, std::vector<Pixel>& row) {
  Pixel first{};
  for (unsigned char& byte : first) byte = reader.next();
  const std::size_t stated = static_cast<std::size_t>(first[2]) << 8u | first[3];
  const bool runs = row.size() >= 8 && row.size() < 32768 && first[0] == 2 && first[1] == 2;
  if (runs && stated == row.size()) return read_runs(reader, row);
  row[0] = first;
  for (std::size_t x = 1; x < row.size(); ++x) {
    for (unsigned char& byte : row[x]) byte = reader.next();
    if (row[x][0] == 1 && row[x][1] == 1 && row[x][2] == 1) reader.fail("old-style runs");
  }
}

}  // namespace

Image decode_hdr(const std::string& bytes, const std::string& path) {
  Reader reader{bytes, path};
  int width = 0, height = 0;
  read_header(reader, width, height);
  check_image_size(path, width, height, bytes.size(), stb_compression);
  Image image = make_image(width, height, 3);
  std::vector<Pixel> row(static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) {
    read_row(reader, row);
    for (int x = 0; x < width; ++x) {
      const Pixel& pixel = row[static_cast<std::size_t>(x)];
      // value = mantissa / 256 * 2^(e - 128); exponent 0 is black.
      const float scale = pixel[3] == 0 ? 0.0f : std::ldexp(1.0f, pixel[3] - 136);
      for (int c = 0; c < 3; ++c)
        at(image, x, y, c) = scale * static_cast<float>(pixel[static_cast<std::size_t>(c)]);
    }
  }
  return image;
}

}  // namespace parian

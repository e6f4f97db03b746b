#include "io/image/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include "base/check.h"
#include "base/error.h"
#include "io/image/exr_internal.h"
#include "io/image/hdr_internal.h"
#include "io/image/image_limits_internal.h"
#include "io/image/png_internal.h"
#include "io/image/stb_internal.h"
#include "io/json/files.h"

namespace parian {
namespace {

// stb takes int sizes: below 2 GiB.
constexpr std::size_t max_file_bytes = (std::size_t{1} << 31u) - 1;
constexpr std::int64_t max_pixels = std::int64_t{1} << 28u;

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

[[noreturn]] void throw_extension(const std::string& path, const char* known) {
  const std::string extension = extension_of(path);
  throw Error({.file = path,
               .expected = fmt::format("a file name that ends in {}", known),
               .found = extension.empty() ? "no extension" : "'" + extension + "'"});
}

void check_finite(const Image& image, const std::string& path, bool allow_nan = false) {
  const auto bad = std::find_if(image.values.begin(), image.values.end(), [allow_nan](float value) {
    return !std::isfinite(value) && !(allow_nan && std::isnan(value));
  });
  if (bad == image.values.end()) return;
  const auto pixel = (bad - image.values.begin()) / image.channels;
  throw Error({path, fmt::format("pixel ({}, {})", pixel % image.width, pixel / image.width),
               "a finite value", fmt::format("{}", *bad)});
}

}  // namespace

void check_image_size(const std::string& path, std::int64_t width, std::int64_t height,
                      std::size_t file_bytes, double pixels_per_byte) {
  if (width < 1 || height < 1 || width > max_pixels || height > max_pixels ||
      width * height > max_pixels)
    throw Error({path, "size", "1 to 2^28 pixels", fmt::format("{} x {}", width, height)});
  if (static_cast<double>(width * height) > pixels_per_byte * static_cast<double>(file_bytes))
    throw Error({path, "size", fmt::format("the data of {} x {} pixels", width, height),
                 fmt::format("{} bytes", file_bytes)});
}

Image load_image(const std::string& path) {
  const std::string extension = extension_of(path);
  const bool is_ldr = extension == ".png" || extension == ".jpg" || extension == ".jpeg";
  if (!is_ldr && extension != ".exr" && extension != ".hdr")
    throw_extension(path, ".png, .jpg, .exr or .hdr");
  const std::string bytes = read_file(path, max_file_bytes);
  Image image = is_ldr                ? decode_png_or_jpeg(bytes, path)
                : extension == ".exr" ? decode_exr(bytes, path)
                                      : decode_hdr(bytes, path);
  check_finite(image, path);
  return image;
}

void save_image(const std::string& path, const Image& image) {
  PARIAN_CHECK(image.channels == 1 || image.channels == 3);
  PARIAN_CHECK_LT(0, image.width);
  PARIAN_CHECK_LT(0, image.height);
  const std::string extension = extension_of(path);
  if (extension != ".png" && extension != ".exr" && extension != ".hdr")
    throw_extension(path, ".png, .exr or .hdr");
  check_writable(path);
  write_text(path, extension == ".png"   ? encode_png(image)
                   : extension == ".exr" ? encode_exr(image, path)
                                         : encode_hdr(image));
}

Image load_raw_image(const std::string& path, bool allow_nan) {
  const std::string extension = extension_of(path);
  if (extension != ".png" && extension != ".exr") throw_extension(path, ".png or .exr");
  const std::string bytes = read_file(path, max_file_bytes);
  Image image = extension == ".png" ? decode_png_or_jpeg(bytes, path, /*as_stored=*/true)
                                    : decode_exr(bytes, path);
  check_finite(image, path, allow_nan);
  return image;
}

void save_raw_png(const std::string& path, const Image& image, int bits) {
  PARIAN_CHECK(image.channels == 1 || image.channels == 3);
  PARIAN_CHECK(bits == 8 || bits == 16);
  if (extension_of(path) != ".png") throw_extension(path, ".png");
  check_writable(path);
  write_text(path, encode_raw_png(image, bits));
}

}  // namespace parian

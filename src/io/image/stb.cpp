#include "io/image/stb_internal.h"

// Static, so that a program that has its own copy of stb links both.
#ifndef __clang_analyzer__  // which would judge stb, not us
#define STB_IMAGE_STATIC
#define STB_IMAGE_WRITE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_WRITE_IMPLEMENTATION
#endif
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS (1 << 24)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#include <stb_image.h>
#include <stb_image_write.h>
#pragma GCC diagnostic pop

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "base/error.h"
#include "image/color.h"
#include "io/image/image_limits_internal.h"

namespace parian {
namespace {

const stbi_uc* data_of(const std::string& bytes) {
  return reinterpret_cast<const stbi_uc*>(bytes.data());
}

[[noreturn]] void throw_stb(const std::string& path, const char* kind) {
  const char* reason = stbi_failure_reason();
  throw Error({.file = path,
               .expected = std::string("a whole ") + kind + " image",
               .found = reason == nullptr ? "damaged data" : reason});
}

struct Size {
  int width = 0, height = 0, channels = 0;
};

// Sizes are read and checked before anything is decoded. Alpha is dropped: 1 or 3 channels remain.
Size read_size(const std::string& bytes, const std::string& path, const char* kind) {
  Size size;
  int channels = 0;
  if (stbi_info_from_memory(data_of(bytes), static_cast<int>(bytes.size()), &size.width,
                            &size.height, &channels) == 0)
    throw_stb(path, kind);
  check_image_size(path, size.width, size.height, bytes.size(), stb_compression);
  size.channels = channels <= 2 ? 1 : 3;
  return size;
}

template <typename T, typename Decode>
Image decode(const T* pixels, const Size& size, const std::string& path, const char* kind,
             Decode decode_value) {
  const std::unique_ptr<const T, void (*)(const T*)> owner(
      pixels, [](const T* data) { stbi_image_free(const_cast<T*>(data)); });
  if (pixels == nullptr) throw_stb(path, kind);
  Image image = make_image(size.width, size.height, size.channels);
  std::transform(pixels, pixels + image.values.size(), image.values.begin(), decode_value);
  return image;
}

void append(void* text, void* data, int count) {
  static_cast<std::string*>(text)->append(static_cast<const char*>(data),
                                          static_cast<std::size_t>(count));
}

}  // namespace

Image decode_png_or_jpeg(const std::string& bytes, const std::string& path, bool as_stored) {
  const char* kind = "PNG or JPEG";
  const int count = static_cast<int>(bytes.size());
  const Size size = read_size(bytes, path, kind);
  Size found;
  if (stbi_is_16_bit_from_memory(data_of(bytes), count) != 0)
    return decode(stbi_load_16_from_memory(data_of(bytes), count, &found.width, &found.height,
                                           &found.channels, size.channels),
                  size, path, kind, [as_stored](stbi_us value) {
                    const float code = static_cast<float>(value) / 65535.0f;
                    return as_stored ? code : decode_srgb(code);
                  });
  std::vector<float> curve(256);
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const float code = static_cast<float>(i) / 255.0f;
    curve[i] = as_stored ? code : decode_srgb(code);
  }
  return decode(stbi_load_from_memory(data_of(bytes), count, &found.width, &found.height,
                                      &found.channels, size.channels),
                size, path, kind, [&](stbi_uc value) { return curve[value]; });
}

std::string encode_png(const Image& image) {
  std::vector<stbi_uc> pixels(image.values.size());
  std::transform(image.values.begin(), image.values.end(), pixels.begin(), [](float value) {
    const float encoded = std::isnan(value) ? 0.0f : encode_srgb(value);
    return static_cast<stbi_uc>(std::lround(255.0f * encoded));
  });
  std::string bytes;
  stbi_write_png_to_func(append, &bytes, image.width, image.height, image.channels, pixels.data(),
                         image.width * image.channels);
  return bytes;
}

// The format has neither negative values nor infinities: clamped; NaN becomes 0.
std::string encode_hdr(const Image& image) {
  constexpr float largest = 1e37f;
  std::vector<float> values = image.values;
  for (float& value : values) value = value > 0 ? std::min(value, largest) : 0.0f;
  std::string bytes;
  stbi_write_hdr_to_func(append, &bytes, image.width, image.height, image.channels, values.data());
  return bytes;
}

}  // namespace parian

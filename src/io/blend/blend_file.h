// Profile blends in .kbm files (docs/formats.md specifies them byte for byte).
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "material/profile_blend.h"

namespace parian {

enum class BlendEncoding {
  paper,   // float32 profiles and weights, 8- or 16-bit indices, as published
  packed,  // every plane as integers on the blend's grid, predicted and compressed; loses nothing,
           // but bases are renumbered and a pixel's entries sorted by falling weight
};

// The file's bytes. Packed encoding needs a blend whose values lie on its grid (Error otherwise);
// gain and dilation, where there are any, are kept as float32 in both.
std::string encode_blend(const ProfileBlend& blend, BlendEncoding encoding);

// Throws Error, with `name` as its file, for every kind of damage: magic, version, sizes,
// checksums, truncation, values out of range. Never allocates more than the sizes that it has
// checked against the number of bytes and the limits of the format.
ProfileBlend decode_blend(std::string_view bytes, const std::string& name);

ProfileBlend load_blend(const std::string& path);
// Writes to a temporary file and renames.
void save_blend(const std::string& path, const ProfileBlend& blend, BlendEncoding encoding);

// Whether the file begins as a blend does. False for what cannot be read.
bool is_blend_file(const std::string& path);

// How the bytes of a file are spent.
struct BlendBytes {
  std::size_t file = 0;
  std::size_t profiles = 0, indices = 0, weights = 0, gain_dilation = 0;
  std::size_t overhead = 0;  // magic, header, checksums
  BlendEncoding encoding = BlendEncoding::paper;
};
BlendBytes measure_blend_file(const std::string& path);

}  // namespace parian

#include "io/blend/blend_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "base/error.h"
#include "io/blend/header_internal.h"
#include "io/blend/packed_internal.h"
#include "io/json/files.h"

namespace parian {
namespace {

constexpr std::string_view magic = "KBM1";
constexpr std::uint32_t version = 1;
constexpr std::size_t max_file_bytes = std::size_t{1} << 33u;

std::string index_bytes(const ProfileBlend& blend) {
  std::string bytes;
  for (std::uint16_t index : blend.index) {
    bytes += static_cast<char>(index & 0xffu);
    if (blend.bases() > 256) bytes += static_cast<char>(index >> 8u);
  }
  return bytes;
}

std::string_view take_floats(ByteReader& reader, std::size_t count, const char* name) {
  const std::string place = fmt::format("section '{}'", name);
  const std::string_view payload = reader.take_section(place);
  if (payload.size() != count * sizeof(float))
    throw Error({reader.file, place, fmt::format("{} bytes", count * sizeof(float)),
                 fmt::format("{}", payload.size())});
  return payload;
}

void read_index_bytes(ByteReader& reader, std::size_t bases, ProfileBlend& blend) {
  const std::string place = "section 'indices'";
  const std::string_view payload = reader.take_section(place);
  const std::size_t width = bases <= 256 ? 1 : 2;
  const std::size_t count = static_cast<std::size_t>(blend.per_pixel) * blend.pixels();
  if (payload.size() != count * width)
    throw Error({reader.file, place, fmt::format("{} bytes", count * width),
                 fmt::format("{}", payload.size())});
  blend.index.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    blend.index[i] = static_cast<unsigned char>(payload[i * width]);
    if (width == 2)
      blend.index[i] = static_cast<std::uint16_t>(
          blend.index[i] | static_cast<unsigned char>(payload[i * width + 1]) << 8u);
  }
}

void read_paper(ByteReader& reader, std::size_t bases, ProfileBlend& blend) {
  const std::size_t row = static_cast<std::size_t>(blend.channels) * blend.knots_mm.size();
  blend.base_log_profile = floats_of(take_floats(reader, bases * row, "profiles"));
  read_index_bytes(reader, bases, blend);
  if (blend.per_pixel > 1)
    blend.weight = floats_of(take_floats(
        reader, static_cast<std::size_t>(blend.per_pixel - 1) * blend.pixels(), "weights"));
}

// The section's payload as a reader of its own; what it leaves unread is damage.
template <typename Unpack>
void read_packed_section(ByteReader& reader, const char* name, Unpack unpack) {
  unpack(ByteReader{reader.take_section(fmt::format("section '{}'", name)), reader.file});
}

void read_packed(ByteReader& reader, std::size_t bases, ProfileBlend& blend) {
  read_packed_section(reader, "profiles",
                      [&](ByteReader part) { unpack_profiles(std::move(part), bases, blend); });
  read_packed_section(reader, "indices",
                      [&](ByteReader part) { unpack_indices(std::move(part), bases, blend); });
  if (blend.per_pixel > 1)
    read_packed_section(reader, "weights",
                        [&](ByteReader part) { unpack_weights(std::move(part), blend); });
}

BlendHeader take_header(ByteReader& reader) {
  const std::string_view found =
      reader.take(std::min(magic.size(), reader.bytes.size()), "magic number");
  if (found != magic)
    throw Error({reader.file, "magic number", fmt::format("'{}'", magic), "another kind of file"});
  const auto number = reader.read<std::uint32_t>("version");
  if (number != version)
    throw Error({reader.file, "version", fmt::format("{}", version), fmt::format("{}", number)});
  return parse_header(reader.take_section("header"), reader.file);
}

std::string read_blend_file(const std::string& path) {
  return read_file(path, max_file_bytes);
}

}  // namespace

std::string encode_blend(const ProfileBlend& blend, BlendEncoding encoding) {
  check(blend, "the blend to write");
  const bool packed = encoding == BlendEncoding::packed;
  if (packed && (blend.grid.profile_step <= 0 || blend.grid.weight_levels <= 0))
    throw Error({"the blend to write", "grid", "a step and levels, as packed files need", "none"});
  std::string bytes(magic);
  append(bytes, version);
  append_section(bytes, format_header(blend, encoding));
  if (packed) {
    const ProfileBlend sorted = sort_blend(blend);
    append_section(bytes, pack_profiles(sorted));
    append_section(bytes, pack_indices(sorted));
    if (blend.per_pixel > 1) append_section(bytes, pack_weights(sorted));
  } else {
    append_section(bytes, bytes_of(blend.base_log_profile));
    append_section(bytes, index_bytes(blend));
    if (blend.per_pixel > 1) append_section(bytes, bytes_of(blend.weight));
  }
  if (!blend.gain.empty()) append_section(bytes, bytes_of(blend.gain));
  if (!blend.dilation.empty()) append_section(bytes, bytes_of(blend.dilation));
  return bytes;
}

ProfileBlend decode_blend(std::string_view bytes, const std::string& name) {
  ByteReader reader{bytes, name};
  BlendHeader header = take_header(reader);
  ProfileBlend& blend = header.blend;
  if (header.encoding == BlendEncoding::packed)
    read_packed(reader, header.bases, blend);
  else
    read_paper(reader, header.bases, blend);
  const std::size_t planes = static_cast<std::size_t>(blend.channels) * blend.pixels();
  if (header.has_gain) blend.gain = floats_of(take_floats(reader, planes, "gain"));
  if (header.has_dilation) blend.dilation = floats_of(take_floats(reader, planes, "dilation"));
  if (!reader.bytes.empty())
    throw Error({name, "end", "no more bytes", fmt::format("{}", reader.bytes.size())});
  check(blend, name);
  return std::move(blend);
}

ProfileBlend load_blend(const std::string& path) {
  return decode_blend(read_blend_file(path), path);
}

void save_blend(const std::string& path, const ProfileBlend& blend, BlendEncoding encoding) {
  write_text(path, encode_blend(blend, encoding));
}

bool is_blend_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string start(magic.size(), 0);
  return file.read(start.data(), static_cast<std::streamsize>(start.size())) && start == magic;
}

BlendBytes measure_blend_file(const std::string& path) {
  const std::string bytes = read_blend_file(path);
  ByteReader reader{bytes, path};
  const BlendHeader header = take_header(reader);
  BlendBytes spent;
  spent.file = bytes.size();
  spent.encoding = header.encoding;
  spent.profiles = reader.take_section("section 'profiles'").size();
  spent.indices = reader.take_section("section 'indices'").size();
  if (header.blend.per_pixel > 1) spent.weights = reader.take_section("section 'weights'").size();
  if (header.has_gain) spent.gain_dilation += reader.take_section("section 'gain'").size();
  if (header.has_dilation) spent.gain_dilation += reader.take_section("section 'dilation'").size();
  spent.overhead =
      spent.file - spent.profiles - spent.indices - spent.weights - spent.gain_dilation;
  return spent;
}

}  // namespace parian

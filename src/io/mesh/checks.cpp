// Checks of OBJ and glTF before assimp reads them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/document.h"
#include "base/error.h"
#include "io/json/json.h"
#include "io/mesh/readers_internal.h"

namespace parian {
namespace {

constexpr double largest_size = 4294967296.0;  // of a buffer: 4 GiB

double member_or(const Document& object, std::string_view key, double fallback) {
  const Document* node = find(object, key);
  if (node == nullptr) return fallback;
  const double value = as_number(*node, 0, largest_size);
  if (value != std::floor(value)) throw_at(*node, "a whole number");
  return value;
}

const Document::Array& array_or_none(const Document& root, std::string_view key) {
  static const Document::Array none;
  const Document* node = find(root, key);
  return node == nullptr ? none : as_array(*node);
}

const Document& item_at(const Document::Array& array, const Document& index,
                        std::string_view what) {
  const double i = as_number(index);
  if (!(i >= 0 && i < static_cast<double>(array.size())) || i != std::floor(i))
    throw_at(index, fmt::format("the index of one of {} {}", array.size(), what));
  return array[static_cast<std::size_t>(i)];
}

double component_bytes(const Document& accessor) {
  switch (as_int(get(accessor, "componentType"), 5120, 5126)) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      throw_at(get(accessor, "componentType"), "5120, 5121, 5122, 5123, 5125 or 5126");
  }
}

double component_count(const Document& accessor) {
  const std::string& type = as_string(get(accessor, "type"));
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  if (type == "VEC4" || type == "MAT2") return 4;
  if (type == "MAT3") return 9;
  if (type == "MAT4") return 16;
  throw_at(get(accessor, "type"), "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
}

void check_views(const Document& root) {
  const Document::Array& buffers = array_or_none(root, "buffers");
  for (const Document& view : array_or_none(root, "bufferViews")) {
    const Document& buffer = item_at(buffers, get(view, "buffer"), "buffers");
    const double end = member_or(view, "byteOffset", 0) + member_or(view, "byteLength", 0);
    const double size = member_or(buffer, "byteLength", 0);
    if (end > size)
      throw_at(view, fmt::format("a view within its buffer of {} bytes", size),
               fmt::format("one that ends at {}", end));
  }
}

void check_accessors(const Document& root) {
  const Document::Array& views = array_or_none(root, "bufferViews");
  for (const Document& accessor : array_or_none(root, "accessors")) {
    if (const Document* sparse = find(accessor, "sparse"))
      throw_at(*sparse, "an accessor that is not sparse", "a sparse one");
    const Document& view = item_at(views, get(accessor, "bufferView"), "views");
    const double item = component_bytes(accessor) * component_count(accessor);
    const double count = member_or(accessor, "count", 0);
    const double stride = std::max(item, member_or(view, "byteStride", 0));
    const double end =
        member_or(accessor, "byteOffset", 0) + (count > 0 ? (count - 1) * stride + item : 0);
    if (end > member_or(view, "byteLength", 0))
      throw_at(accessor,
               fmt::format("data within its view of {} bytes", member_or(view, "byteLength", 0)),
               fmt::format("data that end at {}", end));
  }
}

// Each node has one parent at most, and no circle: scenes are forests, not too deep for assimp's
// recursion.
void check_nodes(const Document& root) {
  const Document::Array& nodes = array_or_none(root, "nodes");
  constexpr std::size_t none = ~std::size_t{0};
  std::vector<std::size_t> parent(nodes.size(), none);
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const Document& child : array_or_none(nodes[i], "children")) {
      item_at(nodes, child, "nodes");
      std::size_t& above = parent[static_cast<std::size_t>(as_number(child))];
      if (above != none) throw_at(child, "a node with one parent", "one with two");
      above = i;
    }
  }
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::size_t depth = 0;
    for (std::size_t at = i; at != none; at = parent[at])
      if (++depth > 256) throw_at(nodes[i], "nodes nested at most 256 deep", "more");
  }
}

std::uint32_t read_u32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8u | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

}  // namespace

void check_gltf(std::string_view json, const std::string& path) {
  const Document root = parse_document(json, path);
  check_views(root);
  check_accessors(root);
  check_nodes(root);
}

void check_glb(std::string_view bytes, const std::string& path) {
  if (bytes.size() < 20 || bytes.substr(0, 4) != "glTF" || bytes.substr(16, 4) != "JSON")
    throw Error({path, "", "a binary glTF file", "another beginning"});
  const std::size_t length = read_u32(bytes, 8);
  const std::size_t json = read_u32(bytes, 12);
  if (length > bytes.size() || json > bytes.size() - 20)
    throw Error({path, "", fmt::format("{} bytes", std::max(length, json + 20)),
                 fmt::format("{} bytes", bytes.size())});
  check_gltf(bytes.substr(20, json), path);
}

void check_obj(std::string_view bytes, const std::string& path) {
  while (!bytes.empty() && std::strchr(" \t\r\n", bytes.back()) != nullptr) bytes.remove_suffix(1);
  const std::size_t begin = bytes.find_last_of('\n');
  const std::string_view line = begin == std::string_view::npos ? bytes : bytes.substr(begin + 1);
  const bool is_face = line.starts_with("f ");
  if (!is_face && !line.starts_with("v ")) return;
  std::size_t words = 0;
  for (std::size_t i = 1; i < line.size(); ++i)
    if (std::strchr(" \t", line[i]) == nullptr && std::strchr(" \t", line[i - 1]) != nullptr)
      ++words;
  if (words < 3)
    throw Error({path, "last line", is_face ? "a face of 3 vertices or more" : "3 coordinates",
                 fmt::format("'{}'", single_line(line))});
}

std::string single_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const bool blank = static_cast<unsigned char>(c) <= ' ';
    if (!blank) line += c;
    if (blank && !line.empty() && line.back() != ' ') line += ' ';
    if (line.size() >= 200) break;
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line.empty() ? "an unknown fault" : line;
}

}  // namespace parian

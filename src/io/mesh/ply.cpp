// PLY files: a header of elements with properties, then their values as text or binary.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/error.h"
#include "io/mesh/readers_internal.h"

namespace parian {
namespace {

constexpr std::string_view space = " \t\r\n";

enum class Type : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class Encoding : std::uint8_t { ascii, little, big };

struct Property {
  std::string name;
  Type type = Type::f32;
  bool is_list = false;
  Type count_type = Type::u8;
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};
struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t size = 0;  // bytes
};

std::size_t size_of(Type type) {
  static constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  while (true) {
    const std::size_t begin = line.find_first_not_of(space);
    if (begin == std::string_view::npos) return words;
    line.remove_prefix(begin);
    words.push_back(line.substr(0, line.find_first_of(space)));
    line.remove_prefix(words.back().size());
  }
}

std::string quote(std::string_view text) {
  return fmt::format("'{}'", single_line(text.substr(0, 40)));
}

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}

  Header read() {
    if (next_line() != "ply") fail("a PLY file, which begins with 'ply'", "another first line");
    bool has_format = false;
    while (true) {
      const std::string_view line = next_line();
      const std::vector<std::string_view> words = split_words(line);
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format" && words.size() == 3) {
        read_format(words[1]);
        has_format = true;
      } else if (words[0] == "element" && words.size() == 3) {
        header_.elements.push_back({std::string(words[1]), read_count(words[2]), {}});
      } else if (words[0] == "property" && !header_.elements.empty() &&
                 (words.size() == 3 || (words.size() == 5 && words[1] == "list"))) {
        header_.elements.back().properties.push_back(read_property(words));
      } else {
        fail("a line of a PLY header", quote(line));
      }
    }
    if (!has_format) fail("a format before the end of the header", "none");
    header_.size = at_;
    return header_;
  }

 private:
  [[noreturn]] void fail(std::string expected, std::string found) const {
    throw Error({path_, fmt::format("line {}", line_), std::move(expected), std::move(found)});
  }
  std::string_view next_line() {
    ++line_;
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos) fail("the rest of the header", "the end of the file");
    std::string_view line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  void read_format(std::string_view name) {
    if (name == "ascii") {
      header_.encoding = Encoding::ascii;
    } else if (name == "binary_little_endian") {
      header_.encoding = Encoding::little;
    } else if (name == "binary_big_endian") {
      header_.encoding = Encoding::big;
    } else {
      fail("ascii, binary_little_endian or binary_big_endian", quote(name));
    }
  }
  std::uint64_t read_count(std::string_view text) const {
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size() || count >= (1ull << 32u))
      fail("a number of elements below 2^32", quote(text));
    return count;
  }
  Type read_type(std::string_view name) const {
    static constexpr std::array<std::string_view, 16> names{
        "char", "int8",  "uchar", "uint8",  "short", "int16",   "ushort", "uint16",
        "int",  "int32", "uint",  "uint32", "float", "float32", "double", "float64"};
    const auto at = std::find(names.begin(), names.end(), name);
    if (at == names.end()) fail("a PLY type", quote(name));
    return static_cast<Type>((at - names.begin()) / 2);
  }
  Property read_property(const std::vector<std::string_view>& words) const {
    Property property;
    property.name = words.back();
    property.type = read_type(words[words.size() - 2]);
    property.is_list = words.size() == 5;
    if (property.is_list) {
      property.count_type = read_type(words[2]);
      if (property.count_type >= Type::f32)
        fail("a whole type for a list's length", quote(words[2]));
    }
    return property;
  }

  std::string_view bytes_;
  const std::string& path_;
  std::size_t at_ = 0;
  std::size_t line_ = 0;
  Header header_;
};

// One value after another, whatever the encoding.
class Values {
 public:
  Values(std::string_view bytes, Encoding encoding, const std::string& path)
      : rest_(bytes), encoding_(encoding), path_(path) {}

  void enter(const Element& element, std::uint64_t index) {
    element_ = &element;
    index_ = index;
  }
  [[noreturn]] void fail(std::string expected, std::string found) const {
    throw Error({path_, fmt::format("{} {}", element_->name, index_), std::move(expected),
                 std::move(found)});
  }
  // What `values` of a type take at least.
  std::size_t least_bytes(Type type) const {
    return encoding_ == Encoding::ascii ? 2 : size_of(type);
  }
  std::size_t left() const { return rest_.size() + 1; }  // the last value needs no blank after it

  double read(Type type) { return encoding_ == Encoding::ascii ? read_text() : read_binary(type); }
  // The length of a list that the rest of the file can hold.
  std::uint64_t read_length(const Property& property) {
    const double length = read(property.count_type);
    if (!(length >= 0) || length != static_cast<double>(static_cast<std::uint32_t>(length)))
      fail("the length of a list", fmt::format("{}", length));
    if (length * static_cast<double>(least_bytes(property.type)) > static_cast<double>(left()))
      fail(fmt::format("a list of {}", length), "the end of the file");
    return static_cast<std::uint64_t>(length);
  }

 private:
  [[noreturn]] void fail_at_end() const {
    fail(fmt::format("{} elements", element_->count), "the end of the file");
  }
  double read_text() {
    const std::size_t begin = rest_.find_first_not_of(space);
    if (begin == std::string_view::npos) fail_at_end();
    rest_.remove_prefix(begin);
    if (rest_.front() == '+') rest_.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    const auto length = static_cast<std::size_t>(end - rest_.data());
    const bool whole = length == rest_.size() || space.find(*end) != std::string_view::npos;
    if (error == std::errc::invalid_argument || !whole)
      fail("a number", quote(rest_.substr(0, rest_.find_first_of(space))));
    // Too small is zero; too large is not a coordinate.
    if (error == std::errc::result_out_of_range && std::abs(value) > 1)
      value = std::numeric_limits<double>::infinity();
    rest_.remove_prefix(length);
    return value;
  }
  double read_binary(Type type) {
    const std::size_t size = size_of(type);
    if (rest_.size() < size) fail_at_end();
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t at = encoding_ == Encoding::little ? size - 1 - i : i;
      bits = bits << 8u | static_cast<unsigned char>(rest_[at]);
    }
    rest_.remove_prefix(size);
    switch (type) {
      case Type::i8:
        return static_cast<std::int8_t>(bits);
      case Type::i16:
        return static_cast<std::int16_t>(bits);
      case Type::i32:
        return static_cast<std::int32_t>(bits);
      case Type::f32:
        return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
      case Type::f64:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }

  std::string_view rest_;
  Encoding encoding_;
  const std::string& path_;
  const Element* element_ = nullptr;
  std::uint64_t index_ = 0;
};

// Before anything is allocated for them.
void check_count(Values& values, const Element& element) {
  std::size_t least = 0;
  for (const Property& property : element.properties)
    least += values.least_bytes(property.is_list ? property.count_type : property.type);
  values.enter(element, 0);
  if (least == 0 && element.count > 0) values.fail("properties", "none");
  if (least > 0 && element.count > values.left() / least)
    values.fail(fmt::format("the {} of the header", element.count),
                fmt::format("room for {} in the file", values.left() / least));
}

void skip(Values& values, const Property& property) {
  const std::uint64_t length = property.is_list ? values.read_length(property) : 1;
  for (std::uint64_t i = 0; i < length; ++i) values.read(property.type);
}

// The place of a vertex property among x y z nx ny nz u v, or 8.
std::size_t slot_of(const Property& property) {
  static constexpr std::array<std::array<std::string_view, 3>, 8> names{{{"x"},
                                                                         {"y"},
                                                                         {"z"},
                                                                         {"nx"},
                                                                         {"ny"},
                                                                         {"nz"},
                                                                         {"s", "u", "texture_u"},
                                                                         {"t", "v", "texture_v"}}};
  if (property.is_list) return 8;
  std::size_t slot = 0;
  while (slot < 8 &&
         std::find(names[slot].begin(), names[slot].end(), property.name) == names[slot].end())
    ++slot;
  return slot;
}

void read_vertices(Values& values, const Element& element, TriangleMesh& mesh) {
  std::vector<std::size_t> slots;
  std::array<bool, 9> has{};
  for (const Property& property : element.properties) {
    slots.push_back(slot_of(property));
    has[slots.back()] = true;
  }
  if (!has[0] || !has[1] || !has[2]) values.fail("the properties x, y and z", "other properties");
  const bool normals = has[3] && has[4] && has[5];
  const bool texcoords = has[6] && has[7];
  mesh.positions.reserve(element.count);
  std::array<float, 8> vertex{};
  for (std::uint64_t i = 0; i < element.count; ++i) {
    values.enter(element, i);
    for (std::size_t p = 0; p < slots.size(); ++p) {
      if (slots[p] == 8) {
        skip(values, element.properties[p]);
      } else {
        vertex[slots[p]] = static_cast<float>(values.read(element.properties[p].type));
      }
    }
    mesh.positions.push_back({vertex[0], vertex[1], vertex[2]});
    if (normals) mesh.normals.push_back({vertex[3], vertex[4], vertex[5]});
    if (texcoords) mesh.texcoords.push_back({vertex[6], 1 - vertex[7]});
  }
}

void read_faces(Values& values, const Element& element, std::uint64_t vertices,
                TriangleMesh& mesh) {
  mesh.triangles.reserve(element.count);
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    values.enter(element, i);
    for (const Property& property : element.properties) {
      if (!property.is_list ||
          (property.name != "vertex_indices" && property.name != "vertex_index")) {
        skip(values, property);
        continue;
      }
      corners.resize(values.read_length(property));
      for (std::uint32_t& corner : corners) {
        const double index = values.read(property.type);
        if (!(index >= 0 && index < static_cast<double>(vertices)))
          values.fail(fmt::format("a vertex below {}", vertices), fmt::format("{}", index));
        corner = static_cast<std::uint32_t>(index);
      }
      for (std::size_t c = 2; c < corners.size(); ++c)
        mesh.triangles.push_back({corners[0], corners[c - 1], corners[c]});
    }
  }
}

void append_word(std::string& bytes, std::uint32_t word) {
  for (int i = 0; i < 4; ++i) bytes += static_cast<char>(word >> (8 * i) & 0xffu);
}
void append_floats(std::string& bytes, std::initializer_list<float> values) {
  for (const float value : values) append_word(bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace

TriangleMesh decode_ply(std::string_view bytes, const std::string& path) {
  const Header header = HeaderReader(bytes, path).read();
  Values values(bytes.substr(header.size), header.encoding, path);
  TriangleMesh mesh;
  const auto vertices = std::find_if(header.elements.begin(), header.elements.end(),
                                     [](const Element& e) { return e.name == "vertex"; });
  const std::uint64_t count = vertices == header.elements.end() ? 0 : vertices->count;
  for (const Element& element : header.elements) {
    check_count(values, element);
    if (element.name == "vertex" && mesh.positions.empty()) {
      read_vertices(values, element, mesh);
    } else if (element.name == "face") {
      read_faces(values, element, count, mesh);
    } else {
      for (std::uint64_t i = 0; i < element.count; ++i) {
        values.enter(element, i);
        for (const Property& property : element.properties) skip(values, property);
      }
    }
  }
  return mesh;
}

std::string encode_ply(const TriangleMesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n",
      mesh.positions.size());
  if (!mesh.normals.empty()) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!mesh.texcoords.empty()) bytes += "property float s\nproperty float t\n";
  bytes += fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                       mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3 p = mesh.positions[v];
    append_floats(bytes, {p.x, p.y, p.z});
    if (!mesh.normals.empty())
      append_floats(bytes, {mesh.normals[v].x, mesh.normals[v].y, mesh.normals[v].z});
    if (!mesh.texcoords.empty())
      append_floats(bytes, {mesh.texcoords[v].x, 1 - mesh.texcoords[v].y});
  }
  for (const auto& t : mesh.triangles) {
    bytes += '\3';
    for (const std::uint32_t v : t) append_word(bytes, v);
  }
  return bytes;
}

}  // namespace parian

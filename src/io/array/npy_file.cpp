#include "io/array/npy_file.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "io/json/files.h"

namespace parian {
namespace {

constexpr std::size_t max_file_bytes = std::size_t{1} << 34u;
constexpr std::size_t max_axes = 4;
constexpr std::size_t max_values = std::size_t{1} << 32u;

[[noreturn]] void throw_header(const std::string& path, std::string expected, std::string found) {
  throw Error({path, "header", std::move(expected), std::move(found)});
}

// The Python literal of the header, of which only what numpy.save writes is understood:
// {'descr': '<f4', 'fortran_order': False, 'shape': (3, 4), }
class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  void skip_spaces() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
  }
  bool accept(std::string_view token) {
    skip_spaces();
    if (text_.substr(at_, token.size()) != token) return false;
    at_ += token.size();
    return true;
  }
  void expect(std::string_view token) {
    if (!accept(token)) fail(fmt::format("'{}'", token));
  }
  std::string quoted() {
    const char quote = accept("'") ? '\'' : accept("\"") ? '"' : '\0';
    if (quote == '\0') fail("a quoted string");
    const std::size_t end = text_.find(quote, at_);
    if (end == std::string_view::npos) fail("a closing quote");
    std::string text(text_.substr(at_, end - at_));
    at_ = end + 1;
    return text;
  }
  std::size_t whole_number() {
    skip_spaces();
    const std::size_t begin = at_;
    std::size_t value = 0;
    for (; at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9'; ++at_) {
      value = 10 * value + static_cast<std::size_t>(text_[at_] - '0');
      if (value > max_values) fail(fmt::format("a number of at most {}", max_values));
    }
    if (at_ == begin) fail("a whole number");
    accept("L");  // Python 2
    return value;
  }
  void end() {
    skip_spaces();
    if (at_ != text_.size()) fail("the end");
  }
  [[noreturn]] void fail(const std::string& expected) const {
    const std::string_view rest = text_.substr(at_, 20);
    std::string shown;
    for (const char c : rest) shown += c >= ' ' && c <= '~' ? c : '?';
    throw_header(path_, expected, rest.empty() ? "the end" : fmt::format("'{}'", shown));
  }

 private:
  std::string_view text_;
  const std::string& path_;
  std::size_t at_ = 0;
};

struct Header {
  std::string descr;
  bool fortran_order = false;
  std::vector<std::size_t> shape;
};

std::vector<std::size_t> read_shape(HeaderReader& reader) {
  std::vector<std::size_t> shape;
  reader.expect("(");
  while (!reader.accept(")")) {
    if (shape.size() == max_axes) reader.fail(fmt::format("at most {} axes", max_axes));
    shape.push_back(reader.whole_number());
    if (!reader.accept(",")) {
      reader.expect(")");
      break;
    }
  }
  return shape;
}

Header read_header(std::string_view text, const std::string& path) {
  HeaderReader reader(text, path);
  Header header;
  bool has_descr = false, has_order = false, has_shape = false;
  reader.expect("{");
  while (!reader.accept("}")) {
    const std::string key = reader.quoted();
    reader.expect(":");
    bool& seen = key == "descr" ? has_descr : key == "shape" ? has_shape : has_order;
    if (seen || (&seen == &has_order && key != "fortran_order"))
      throw_header(path, "the keys 'descr', 'fortran_order' and 'shape', each once",
                   fmt::format("another key '{}'", key.substr(0, 20)));
    seen = true;
    if (key == "descr") {
      header.descr = reader.quoted();
    } else if (key == "shape") {
      header.shape = read_shape(reader);
    } else {
      header.fortran_order = reader.accept("True");
      if (!header.fortran_order) reader.expect("False");
    }
    if (!reader.accept(",")) {
      reader.expect("}");
      break;
    }
  }
  reader.end();
  if (!has_descr || !has_order || !has_shape)
    throw_header(path, "the keys 'descr', 'fortran_order' and 'shape', each once", "not all");
  return header;
}

// IEEE 754 binary16.
float from_half(std::uint16_t bits) {
  const int exponent = (bits >> 10u) & 31;
  const auto mantissa = static_cast<float>(bits & 1023u);
  const float sign = (bits & 0x8000u) != 0 ? -1.0f : 1.0f;
  if (exponent == 31)
    return mantissa != 0 ? std::numeric_limits<float>::quiet_NaN()
                         : sign * std::numeric_limits<float>::infinity();
  return sign * (exponent == 0 ? std::ldexp(mantissa, -24)
                               : std::ldexp(1024.0f + mantissa, exponent - 25));
}

template <typename Bits>
Bits read_bits(const char* data, bool swap) {
  unsigned char bytes[sizeof(Bits)];
  std::memcpy(bytes, data, sizeof(Bits));
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(Bits); ++i)
    bits |= std::uint64_t{bytes[swap ? sizeof(Bits) - 1 - i : i]} << (8 * i);
  return static_cast<Bits>(bits);
}

using Decode = float (*)(const char* data, bool swap);
template <typename Bits, typename Number>
float decode(const char* data, bool swap) {
  return static_cast<float>(std::bit_cast<Number>(read_bits<Bits>(data, swap)));
}
float decode_half(const char* data, bool swap) {
  return from_half(read_bits<std::uint16_t>(data, swap));
}

struct NumberType {
  const char* name;
  std::size_t bytes;
  Decode decode;
};
constexpr NumberType number_types[] = {
    {"f4", 4, decode<std::uint32_t, float>},
    {"f8", 8, decode<std::uint64_t, double>},
    {"f2", 2, decode_half},
    {"u1", 1, decode<std::uint8_t, std::uint8_t>},
    {"i1", 1, decode<std::uint8_t, std::int8_t>},
    {"b1", 1, decode<std::uint8_t, std::uint8_t>},
    {"u2", 2, decode<std::uint16_t, std::uint16_t>},
    {"i2", 2, decode<std::uint16_t, std::int16_t>},
    {"u4", 4, decode<std::uint32_t, std::uint32_t>},
    {"i4", 4, decode<std::uint32_t, std::int32_t>},
    {"u8", 8, decode<std::uint64_t, std::uint64_t>},
    {"i8", 8, decode<std::uint64_t, std::int64_t>},
};

const NumberType& find_type(const std::string& descr, const std::string& path) {
  if (descr.size() == 3 && std::string_view("<>|=").find(descr[0]) != std::string_view::npos)
    for (const NumberType& type : number_types)
      if (descr.substr(1) == type.name) return type;
  throw_header(path, "a number type such as '<f4'", fmt::format("'{}'", descr.substr(0, 20)));
}

// Where the k-th number in Fortran order belongs in C order.
std::size_t c_order_index(std::size_t k, const std::vector<std::size_t>& shape) {
  std::size_t index = 0, stride = 1;
  for (const std::size_t length : shape) stride *= length;
  for (const std::size_t length : shape) {
    stride /= length;
    index += k % length * stride;
    k /= length;
  }
  return index;
}

}  // namespace

NpyArray parse_npy(std::string_view bytes, const std::string& path) {
  if (bytes.substr(0, 6) != "\x93NUMPY")
    throw Error({.file = path, .expected = "a .npy file", .found = "no NumPy signature"});
  const int version = bytes.size() > 7 ? bytes[6] : 0;
  if (version < 1 || version > 3)
    throw_header(path, "version 1, 2 or 3", fmt::format("{}", version));
  const std::size_t start = version == 1 ? 10 : 12;
  const std::size_t length = bytes.size() < start ? std::numeric_limits<std::uint32_t>::max()
                             : version == 1 ? read_bits<std::uint16_t>(bytes.data() + 8, false)
                                            : read_bits<std::uint32_t>(bytes.data() + 8, false);
  if (bytes.size() < start || length > bytes.size() - start)
    throw Error({.file = path, .expected = "a whole .npy file", .found = "a truncated one"});
  Header header = read_header(bytes.substr(start, length), path);
  const NumberType& type = find_type(header.descr, path);
  std::size_t count = 1;
  for (const std::size_t axis : header.shape) {
    if (axis == 0 || axis > max_values / count)
      throw_header(path, fmt::format("1 to {} numbers", max_values),
                   fmt::format("shape {}", format_shape(header.shape)));
    count *= axis;
  }
  const std::string_view data = bytes.substr(start + length);
  if (data.size() != count * type.bytes)
    throw Error(
        {path, "data",
         fmt::format("{} bytes, as shape {} needs", count * type.bytes, format_shape(header.shape)),
         fmt::format("{}", data.size())});
  NpyArray array{.shape = std::move(header.shape), .values = std::vector<float>(count)};
  for (std::size_t i = 0; i < count; ++i)
    array.values[header.fortran_order ? c_order_index(i, array.shape) : i] =
        type.decode(data.data() + i * type.bytes, header.descr[0] == '>');
  return array;
}

NpyArray load_npy(const std::string& path) {
  return parse_npy(read_file(path, max_file_bytes), path);
}

std::string format_shape(const std::vector<std::size_t>& shape) {
  std::string text;
  for (const std::size_t length : shape) text += fmt::format("[{}]", length);
  return text.empty() ? "[]" : text;
}

}  // namespace parian

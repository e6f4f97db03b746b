#include "io/json/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "base/error.h"
#include "io/json/files.h"

namespace parian {
namespace {

constexpr std::size_t max_text = std::size_t{64} << 20;
constexpr std::size_t max_memory = std::size_t{512} << 20;
constexpr std::size_t max_depth = 64;
constexpr std::size_t longest_in_error = 200;

std::string cut(const std::string& text) {
  return text.size() <= longest_in_error ? text : text.substr(0, longest_in_error) + "...";
}

// RFC 6901: "~" and "/" of keys are written "~0" and "~1".
std::string escape_key(const std::string& key) {
  std::string escaped;
  for (const char c : key) {
    if (c == '~') {
      escaped += "~0";
    } else if (c == '/') {
      escaped += "~1";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string remove_prefix(const std::string& text, std::string_view prefix) {
  return text.compare(0, prefix.size(), prefix) == 0 ? text.substr(prefix.size()) : text;
}

// Builds the tree from the parser's events: the SAX interface sees each key before it would be
// merged with an equal one, and lets us stop at the depth limit before any recursion.
struct Builder {
  std::string_view text;
  std::shared_ptr<const std::string> file;
  Document root;

  struct Open {
    Document* node;
    std::unordered_set<std::string> keys;
    std::string key;
  };
  std::vector<Open> stack = {};
  std::size_t memory = 0;

  std::string next_pointer() const {
    if (stack.empty()) return {};
    const Open& open = stack.back();
    if (const auto* array = std::get_if<Document::Array>(&open.node->value))
      return open.node->pointer + "/" + std::to_string(array->size());
    return open.node->pointer + "/" + escape_key(open.key);
  }

  // Pointers to open containers stay valid: a container only grows while its last child is closed.
  Document* add(Document node) {
    node.file = file;
    node.pointer = next_pointer();
    memory += 2 * sizeof(Document) + node.pointer.capacity();
    if (const auto* string = std::get_if<std::string>(&node.value)) memory += string->capacity();
    if (memory > max_memory)
      throw Error({*file, cut(node.pointer), "a document of at most 512 MiB in memory", "more"});
    if (stack.empty()) {
      root = std::move(node);
      return &root;
    }
    Open& open = stack.back();
    if (auto* array = std::get_if<Document::Array>(&open.node->value))
      return &array->emplace_back(std::move(node));
    auto& members = std::get<Document::Object>(open.node->value);
    return &members.emplace_back(open.key, std::move(node)).second;
  }

  bool open(Document node) {
    if (stack.size() == max_depth)
      throw Error({*file, cut(next_pointer()),
                   fmt::format("nesting of at most {} levels", max_depth), "a deeper one"});
    stack.push_back({add(std::move(node)), {}, {}});
    return true;
  }
  bool close() {
    stack.pop_back();
    return true;
  }
  bool leaf(Document node) {
    add(std::move(node));
    return true;
  }

  // The events of nlohmann's SAX interface.
  bool null() { return leaf(nullptr); }
  bool boolean(bool value) { return leaf(value); }
  bool number_integer(std::int64_t value) { return leaf(static_cast<double>(value)); }
  bool number_unsigned(std::uint64_t value) { return leaf(static_cast<double>(value)); }
  bool number_float(double value, const std::string&) { return leaf(value); }
  bool string(std::string& value) { return leaf(std::move(value)); }
  bool binary(nlohmann::json::binary_t&) { return false; }  // never in text
  bool start_object(std::size_t) { return open(Document::Object{}); }
  bool end_object() { return close(); }
  bool start_array(std::size_t) { return open(Document::Array{}); }
  bool end_array() { return close(); }
  bool key(std::string& value) {
    Open& open = stack.back();
    open.key = value;
    memory += 3 * value.size();
    if (!open.keys.insert(value).second)
      throw Error({*file, cut(next_pointer()), "each key once", "it again"});
    return true;
  }
  bool parse_error(std::size_t position, const std::string& last,
                   const nlohmann::json::exception& error) {
    throw_syntax(position, last, error.what());
  }

  [[noreturn]] void throw_syntax(std::size_t position, const std::string& last,
                                 const std::string& message) const;
};

// nlohmann: "... - unexpected X; expected Y", "... - invalid literal; last read: ..." or, for
// 1e999,
// "... number overflow parsing '1e999'".
void Builder::throw_syntax(std::size_t position, const std::string& last,
                           const std::string& message) const {
  const std::string_view before = text.substr(0, position == 0 ? 0 : position - 1);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_begin = before.rfind('\n') == before.npos ? 0 : before.rfind('\n') + 1;
  const std::string place = fmt::format("line {}, column {}", line, before.size() - line_begin + 1);
  if (message.find("number overflow") != message.npos)
    throw Error({*file, place, "a number that fits a double", cut(last)});
  const std::size_t dash = message.find(" - ");
  std::string found = dash == message.npos ? message : message.substr(dash + 3);
  std::string expected = "valid JSON";
  if (const std::size_t at = found.find("; expected "); at != found.npos) {
    expected = found.substr(at + 11);
    found.resize(at);
  }
  if (const std::size_t at = found.find("; last read"); at != found.npos) found.resize(at);
  found = remove_prefix(remove_prefix(found, "unexpected "), "invalid string: ");
  throw Error({*file, place, cut(expected), cut(found)});
}

struct Formatter {
  std::string out;

  void indent(std::size_t level) { out.append(2 * level, ' '); }

  void string(const std::string& value) {
    out += nlohmann::json(value).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

  void array(const Document::Array& array, std::size_t level) {
    const bool nested = std::any_of(array.begin(), array.end(), [](const Document& node) {
      return std::holds_alternative<Document::Array>(node.value) ||
             std::holds_alternative<Document::Object>(node.value);
    });
    out += '[';
    for (std::size_t i = 0; i < array.size(); ++i) {
      if (i > 0) out += nested ? "," : ", ";
      if (nested) out += '\n', indent(level + 1);
      format(array[i], level + 1);
    }
    if (nested) out += '\n', indent(level);
    out += ']';
  }

  void object(const Document::Object& object, std::size_t level) {
    out += '{';
    for (std::size_t i = 0; i < object.size(); ++i) {
      out += i > 0 ? ",\n" : "\n";
      indent(level + 1);
      string(object[i].first);
      out += ": ";
      format(object[i].second, level + 1);
    }
    if (!object.empty()) out += '\n', indent(level);
    out += '}';
  }

  void format(const Document& node, std::size_t level) {
    if (const auto* boolean = std::get_if<bool>(&node.value)) {
      out += *boolean ? "true" : "false";
    } else if (const auto* number = std::get_if<double>(&node.value)) {
      out += std::isfinite(*number) ? fmt::format("{}", *number) : "null";
    } else if (const auto* text = std::get_if<std::string>(&node.value)) {
      string(*text);
    } else if (const auto* elements = std::get_if<Document::Array>(&node.value)) {
      array(*elements, level);
    } else if (const auto* members = std::get_if<Document::Object>(&node.value)) {
      object(*members, level);
    } else {
      out += "null";
    }
  }
};

}  // namespace

Document parse_document(std::string_view text, const std::string& name) {
  if (text.size() > max_text)
    throw Error({.file = name,
                 .expected = fmt::format("a file of at most {} bytes", max_text),
                 .found = fmt::format("{} bytes", text.size())});
  Builder builder{.text = text, .file = std::make_shared<const std::string>(name), .root = {}};
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  return std::move(builder.root);
}

Document load_document(const std::string& path) {
  return parse_document(read_file(path, max_text), path);
}

std::string format_document(const Document& document) {
  Formatter formatter;
  formatter.format(document, 0);
  return std::move(formatter.out);
}

void save_document(const std::string& path, const Document& document) {
  write_text(path, format_document(document) + "\n");
}

}  // namespace parian

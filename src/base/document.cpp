#include "base/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/names.h"

namespace parian {
namespace {

template <typename T>
const T& as(const Document& node, const char* expected) {
  if (const T* value = std::get_if<T>(&node.value)) return *value;
  throw_at(node, expected);
}

struct ReadParam {
  const Param& param;
  const Document& node;

  void operator()(bool* target) const { *target = as_bool(node); }
  void operator()(int* target) const {
    *target = as_int(node, std::numeric_limits<int>::min(), std::numeric_limits<int>::max());
  }
  void operator()(std::uint64_t* target) const {
    // JSON numbers are doubles here: whole up to 2^53.
    const double number = as_number(node, 0, 0x1.0p53);
    if (number != std::floor(number)) throw_at(node, "a whole number");
    *target = static_cast<std::uint64_t>(number);
  }
  void operator()(double* target) const { *target = as_number(node); }
  void operator()(std::string* target) const { *target = as_string(node); }
  void operator()(std::vector<double>* target) const {  // one number is a list of one
    if (std::holds_alternative<double>(node.value))
      *target = {as_number(node)};
    else if (std::holds_alternative<Document::Array>(node.value))
      *target = as_numbers(node);
    else
      throw_at(node, "a number or an array of numbers");
  }
  void operator()(const ChoiceTarget&) const { parse_value(param, as_string(node)); }
};

struct WriteParam {
  const Param& param;

  Document operator()(const bool* value) const { return *value; }
  Document operator()(const int* value) const { return *value; }
  Document operator()(const std::uint64_t* value) const { return static_cast<double>(*value); }
  Document operator()(const double* value) const { return *value; }
  Document operator()(const std::string* value) const { return *value; }
  Document operator()(const std::vector<double>* values) const {
    return Document::Array(values->begin(), values->end());
  }
  Document operator()(const ChoiceTarget&) const { return format_value(param); }
};

}  // namespace

std::string describe_value(const Document& node) {
  struct Visitor {
    std::string operator()(std::nullptr_t) const { return "null"; }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(double value) const { return fmt::format("the number {}", value); }
    std::string operator()(const std::string& value) const {
      constexpr std::size_t longest = 60;
      return fmt::format("the string '{}{}'", value.substr(0, longest),
                         value.size() > longest ? "..." : "");
    }
    std::string operator()(const Document::Array& value) const {
      return fmt::format("an array of {}", value.size());
    }
    std::string operator()(const Document::Object&) const { return "an object"; }
  };
  return std::visit(Visitor{}, node.value);
}

void throw_at(const Document& node, std::string expected, std::string found) {
  throw Error({node.file ? *node.file : std::string(), node.pointer.empty() ? "/" : node.pointer,
               std::move(expected), std::move(found)});
}

void throw_at(const Document& node, std::string expected) {
  throw_at(node, std::move(expected), describe_value(node));
}

const Document::Object& as_object(const Document& node) {
  return as<Document::Object>(node, "an object");
}
const Document::Array& as_array(const Document& node) {
  return as<Document::Array>(node, "an array");
}
const std::string& as_string(const Document& node) {
  return as<std::string>(node, "a string");
}
double as_number(const Document& node) {
  return as<double>(node, "a number");
}

double as_number(const Document& node, double min, double max) {
  const double value = as_number(node);
  if (!(value >= min && value <= max))
    throw_at(node, fmt::format("a number in [{}, {}]", min, max));
  return value;
}

int as_int(const Document& node, int min, int max) {
  const double value = as_number(node);
  if (!(value >= min && value <= max) || value != std::floor(value))
    throw_at(node, fmt::format("a whole number in [{}, {}]", min, max));
  return static_cast<int>(value);
}

bool as_bool(const Document& node) {
  return as<bool>(node, "true or false");
}

std::vector<double> as_numbers(const Document& node) {
  std::vector<double> numbers;
  for (const Document& element : as_array(node)) numbers.push_back(as_number(element));
  return numbers;
}

const Document* find(const Document& object, std::string_view key) {
  for (const auto& [name, member] : as_object(object))
    if (name == key) return &member;
  return nullptr;
}

const Document& get(const Document& object, std::string_view key) {
  if (const Document* member = find(object, key)) return *member;
  throw_at(object, fmt::format("the key '{}'", key), "no such key");
}

void check_keys(const Document& object, const std::vector<std::string>& known) {
  for (const auto& [name, member] : as_object(object)) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string nearest = nearest_name(name, known);
    throw_at(member, nearest.empty() ? "one of the keys " + list_names(known) : "a known key",
             nearest.empty() ? fmt::format("the unknown key '{}'", name)
                             : fmt::format("'{}' (did you mean '{}'?)", name, nearest));
  }
}

void set(Document& object, std::string key, Document value) {
  if (std::holds_alternative<std::nullptr_t>(object.value)) object.value = Document::Object{};
  auto& members = std::get<Document::Object>(object.value);
  const auto found = std::find_if(members.begin(), members.end(),
                                  [&](const auto& member) { return member.first == key; });
  if (found != members.end()) {
    found->second = std::move(value);
  } else {
    members.emplace_back(std::move(key), std::move(value));
  }
}

void read_params(const Document& object, const ParamList& params,
                 const std::vector<std::string>& also_known) {
  std::vector<std::string> known = also_known;
  for (const Param& param : params) known.push_back(json_key(param));
  check_keys(object, known);
  for (const Param& param : params) {
    const Document* member = find(object, json_key(param));
    if (member == nullptr) continue;
    try {
      std::visit(ReadParam{param, *member}, param.target);
      check({param});
    } catch (const Error& error) {
      if (!error.parts.file.empty()) throw;
      throw_at(*member, error.parts.expected, error.parts.found);
    }
  }
}

Document write_params(const ParamList& params) {
  Document object{Document::Object{}};
  for (const Param& param : params)
    set(object, json_key(param), std::visit(WriteParam{param}, param.target));
  return object;
}

}  // namespace parian

// Documents: trees of values that know which file they come from and where in it (JSON pointer),
// so that whoever reads a value can name the place of what is wrong with it. JSON text is read and
// written by io; this is the value type between io and everything else.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/params.h"

namespace parian {

class Document {
 public:
  using Array = std::vector<Document>;
  // Keys in the order in which they were written.
  using Object = std::vector<std::pair<std::string, Document>>;
  using Value = std::variant<std::nullptr_t, bool, double, std::string, Array, Object>;

  Document() = default;
  Document(std::nullptr_t) {}
  Document(bool boolean) : value(boolean) {}
  Document(double number) : value(number) {}
  Document(int number) : value(static_cast<double>(number)) {}
  Document(std::size_t number) : value(static_cast<double>(number)) {}
  Document(const char* text) : value(std::string(text)) {}
  Document(std::string text) : value(std::move(text)) {}
  Document(Array array) : value(std::move(array)) {}
  Document(Object object) : value(std::move(object)) {}

  // Where it stands; empty for documents made by code.
  std::shared_ptr<const std::string> file;
  std::string pointer;  // "/materials/0/sigma_a"
  Value value;
};

// "null", "true", "the number 3", "the string 'x'", "an array of 3", "an object"
std::string describe_value(const Document& node);
// An Error at this node.
[[noreturn]] void throw_at(const Document& node, std::string expected, std::string found);
[[noreturn]] void throw_at(const Document& node, std::string expected);

// Typed access; each throws an Error that names file and pointer when the node is something else.
const Document::Object& as_object(const Document& node);
const Document::Array& as_array(const Document& node);
const std::string& as_string(const Document& node);
double as_number(const Document& node);
// A number in [min, max]; NaN-free by construction.
double as_number(const Document& node, double min, double max);
// A whole number in [min, max].
int as_int(const Document& node, int min, int max);
bool as_bool(const Document& node);
std::vector<double> as_numbers(const Document& node);

// Members of objects. find returns null where the key is absent, get throws.
const Document* find(const Document& object, std::string_view key);
const Document& get(const Document& object, std::string_view key);
// Throws at the first key that is not known, naming the nearest known one.
void check_keys(const Document& object, const std::vector<std::string>& known);
// Sets or appends a member of an object made by code.
void set(Document& object, std::string key, Document value);

// Params structs as JSON objects: reads each key that is present, rejects unknown ones, checks
// ranges. `also_known` are keys that the caller reads itself.
void read_params(const Document& object, const ParamList& params,
                 const std::vector<std::string>& also_known = {});
Document write_params(const ParamList& params);

}  // namespace parian

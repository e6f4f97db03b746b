#include "acquire/provenance.h"

#include <fmt/format.h>

namespace parian {
namespace {

// Compact JSON. Files are io's affair; this text goes into a table's header.
struct WriteJson {
  std::string& text;

  void operator()(std::nullptr_t) const { text += "null"; }
  void operator()(bool value) const { text += value ? "true" : "false"; }
  void operator()(double value) const { text += fmt::format("{}", value); }
  void operator()(const std::string& value) const {
    text += '"';
    for (const char c : value) {
      if (c == '"' || c == '\\') {
        text += '\\';
        text += c;
      } else if (static_cast<unsigned char>(c) < 0x20) {
        text += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
      } else {
        text += c;
      }
    }
    text += '"';
  }
  void operator()(const Document::Array& elements) const {
    text += '[';
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (i > 0) text += ',';
      std::visit(*this, elements[i].value);
    }
    text += ']';
  }
  void operator()(const Document::Object& members) const {
    text += '{';
    for (std::size_t i = 0; i < members.size(); ++i) {
      if (i > 0) text += ',';
      (*this)(members[i].first);
      text += ':';
      std::visit(*this, members[i].second.value);
    }
    text += '}';
  }
};

}  // namespace

std::string format_compact(const Document& document) {
  std::string text;
  std::visit(WriteJson{text}, document.value);
  return text;
}

std::string make_provenance(const std::string& engine, const Document::Object::value_type& how,
                            const Document& description) {
  return format_compact(
      Document::Object{{"kind", engine}, {"simulated", true}, how, {"sample", description}});
}

}  // namespace parian

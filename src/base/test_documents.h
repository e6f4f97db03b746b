// Documents made by code, for tests.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "base/document.h"

namespace parian {

inline Document object(Document::Object members) {
  return members;
}
inline Document array(Document::Array elements) {
  return elements;
}

// With the places in s.json that a parser would give.
inline Document locate(Document node, const std::string& pointer = {}) {
  node.file = std::make_shared<std::string>("s.json");
  node.pointer = pointer;
  if (auto* elements = std::get_if<Document::Array>(&node.value)) {
    for (std::size_t i = 0; i < elements->size(); ++i)
      (*elements)[i] = locate(std::move((*elements)[i]), pointer + "/" + std::to_string(i));
  } else if (auto* members = std::get_if<Document::Object>(&node.value)) {
    for (auto& [key, member] : *members) member = locate(std::move(member), pointer + "/" + key);
  }
  return node;
}

}  // namespace parian

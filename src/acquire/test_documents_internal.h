// Descriptions made by code for the tests of this module, with the places that a parser would give.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "base/document.h"
#include "base/error.h"

namespace parian {

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

inline Document object(Document::Object members) {
  return members;
}
inline Document array(Document::Array elements) {
  return elements;
}

// 24 x 20 pixels of 0.25 mm, radius 5, marble squares.
inline Document chessboard_description() {
  return object({{"name", "board"},
                 {"materials", array({object({{"name", "white"}, {"material", "Marble"}}),
                                      object({{"name", "dark"},
                                              {"sigma_a", array({0.3, 0.2, 0.1})},
                                              {"sigma_s_prime", array({1.0, 1.1, 1.2})},
                                              {"scale", 0.5}})})},
                 {"layout", object({{"kind", "chessboard"}, {"tile_mm", 1.5}})},
                 {"pitch_mm", 0.25},
                 {"size", array({24, 20})},
                 {"radius_px", 5},
                 {"seed", 3}});
}

inline Document homogeneous_description(const char* material) {
  Document document = chessboard_description();
  set(document, "materials", array({object({{"name", "all"}, {"material", material}})}));
  set(document, "layout", object({{"kind", "uniform"}}));
  return document;
}

inline std::string error_of(const std::function<void()>& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace parian

// Recipes made by code, for tests.
#pragma once

#include <utility>
#include <vector>

#include "base/test_documents.h"
#include "edit/selection_cache.h"

namespace parian {

inline Document point(double x, double y) {
  return Document(Document::Array{x, y});
}
inline Document points(const std::vector<std::pair<double, double>>& places) {
  Document::Array array;
  array.reserve(places.size());
  for (const auto& [x, y] : places) array.push_back(point(x, y));
  return array;
}
inline Document recipe_of(const std::vector<Document>& layers) {
  return object({{"format", "parian-recipe"}, {"layers", Document::Array(layers)}});
}

}  // namespace parian

#include "app/studio/selection_edit.h"

#include <algorithm>
#include <utility>

#include "app/studio/selection_places.h"
#include "base/check.h"
#include "edit/recipe.h"
#include "edit/selection_property.h"

namespace parian {
namespace {

Document::Array* find_parts(Document& part) {
  auto* members = std::get_if<Document::Object>(&part.value);
  if (members == nullptr) return nullptr;
  for (auto& [key, member] : *members)
    if (key == "of") return std::get_if<Document::Array>(&member.value);
  return nullptr;
}

Document* at_path(Document& selection, const PartPath& path) {
  Document* part = &selection;
  for (const std::size_t index : path) {
    Document::Array* parts = find_parts(*part);
    if (parts == nullptr || index >= parts->size()) return nullptr;
    part = &(*parts)[index];
  }
  return part;
}

Document make_set(const std::string& kind, Document first) {
  Document set_of{Document::Object{}};
  set(set_of, "type", kind);
  set(set_of, "of", Document::Array{std::move(first)});
  return set_of;
}

Document make_threshold(const EditState& state) {
  Plane values = eval_selection_property(state, SelectionProperty::albedo, -1);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  Document part{Document::Object{}};
  set(part, "type", "threshold");
  set(part, "property", "albedo");
  set(part, "low", *middle);
  return part;
}

// Lines along an axis have no area, but what comes after them shall have some.
void widen(PlaceBox& box, const MapSize& size) {
  const Place sides{box[1][0] - box[0][0], box[1][1] - box[0][1]};
  const double least =
      std::max(0.5 * std::max(sides[0], sides[1]), 0.1 * std::min(size.width_mm, size.height_mm));
  for (std::size_t i = 0; i < 2; ++i)
    if (sides[i] < 0.1 * least) {
      box[0][i] -= 0.5 * least;
      box[1][i] += 0.5 * least;
    }
}

// Keys that mean the same wherever they stand.
constexpr const char* common_keys[] = {"grow",  "feather", "invert", "distance",
                                       "table", "state",   "sigma"};

}  // namespace

void remove_key(Document& object, const std::string& key) {
  std::erase_if(std::get<Document::Object>(object.value),
                [&](const auto& member) { return member.first == key; });
}

std::string part_type(const Document& part) {
  if (!std::holds_alternative<Document::Object>(part.value)) return {};
  const Document* type = find(part, "type");
  const auto* text = type != nullptr ? std::get_if<std::string>(&type->value) : nullptr;
  return text != nullptr ? *text : std::string();
}

bool is_set(const std::string& type) {
  return type == "union" || type == "intersection" || type == "difference";
}

const Document* find_part(const Document& selection, const PartPath& path) {
  const Document* part = &selection;
  for (const std::size_t index : path) {
    if (!is_set(part_type(*part))) return nullptr;
    const Document* parts = find(*part, "of");
    const auto* array = parts != nullptr ? std::get_if<Document::Array>(&parts->value) : nullptr;
    if (array == nullptr || index >= array->size()) return nullptr;
    part = &(*array)[index];
  }
  return part;
}

void set_part(Document& selection, const PartPath& path, Document part) {
  Document* place = at_path(selection, path);
  PARIAN_CHECK(place != nullptr);
  *place = std::move(part);
}

PartPath add_part(Document& selection, PartPath path, Document part) {
  while (true) {
    Document* place = at_path(selection, path);
    if (place != nullptr && is_set(part_type(*place)))
      if (Document::Array* parts = find_parts(*place); parts != nullptr) {
        parts->push_back(std::move(part));
        path.push_back(parts->size() - 1);
        return path;
      }
    if (path.empty()) break;
    path.pop_back();
  }
  selection = make_set("union", std::move(selection));
  find_parts(selection)->push_back(std::move(part));
  return {1};
}

bool remove_part(Document& selection, PartPath path) {
  while (!path.empty()) {
    const std::size_t index = path.back();
    path.pop_back();
    Document* holder = at_path(selection, path);
    Document::Array* parts = holder != nullptr ? find_parts(*holder) : nullptr;
    if (parts == nullptr || index >= parts->size()) return true;
    parts->erase(parts->begin() + static_cast<std::ptrdiff_t>(index));
    if (!parts->empty()) return true;
  }
  return false;
}

PartPath raise_part(Document& selection, PartPath path) {
  if (path.empty() || path.back() == 0) return path;
  PartPath above = path;
  above.pop_back();
  Document* holder = at_path(selection, above);
  Document::Array* parts = holder != nullptr ? find_parts(*holder) : nullptr;
  if (parts == nullptr || path.back() >= parts->size()) return path;
  std::swap((*parts)[path.back()], (*parts)[path.back() - 1]);
  --path.back();
  return path;
}

Document make_part(const std::string& kind, const PartStart& start) {
  if (is_set(kind)) return make_set(kind, make_part("rectangle", start));
  if (kind == "threshold") return make_threshold(start.state);
  Document part{Document::Object{}};
  set(part, "type", kind);
  if (kind == "image") set(part, "file", start.file);
  const MapSize size = size_of(start.state);
  place_part(part, {{{0.25 * size.width_mm, 0.25 * size.height_mm},
                     {0.75 * size.width_mm, 0.75 * size.height_mm}}});
  if (kind == "similar") set(part, "at", Document::Array{start.at_mm[0], start.at_mm[1]});
  if (kind == "stroke") set(part, "radius", start.brush_mm);
  if (kind == "propagate") {
    Document stroke{Document::Object{}};
    set(stroke, "points", Document::Array{Document::Array{start.at_mm[0], start.at_mm[1]}});
    set(stroke, "radius", start.brush_mm);
    set(part, "strokes", Document::Array{std::move(stroke)});
  }
  return part;
}

Document change_part(const Document& part, const std::string& kind, const PartStart& start) {
  const std::string old = part_type(part);
  if (is_set(kind) && !is_set(old)) return make_set(kind, part);
  if (is_set(kind)) {
    Document changed = part;
    set(changed, "type", kind);
    return changed;
  }
  Document from = part;
  convert_unit(from, false, size_of(start.state));
  Document changed = make_part(kind, start);
  if (auto box = find_box(from)) {
    widen(*box, size_of(start.state));
    place_part(changed, *box);
  }
  for (const SelectionKind& known : selection_kinds()) {
    if (known.name != kind) continue;
    for (const char* key : common_keys) {
      const bool is_modifier = std::string(key) == "grow" || std::string(key) == "feather" ||
                               std::string(key) == "invert";
      const bool takes =
          is_modifier || std::find(known.keys.begin(), known.keys.end(), key) != known.keys.end();
      if (const Document* member = find(from, key); takes && member != nullptr)
        set(changed, key, *member);
    }
  }
  return changed;
}

}  // namespace parian

// Selections of layers as trees of documents: sets (union, intersection, difference) hold parts
// under "of", every other part is of one kind. What the panel's widgets do to them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/document.h"
#include "edit/edit_state.h"

namespace parian {

// A key less.
void remove_key(Document& object, const std::string& key);

// Indices under "of", from the selection down to a part; empty: the selection itself.
using PartPath = std::vector<std::size_t>;

std::string part_type(const Document& part);  // empty where it says none
bool is_set(const std::string& type);
// Null where the path leads nowhere.
const Document* find_part(const Document& selection, const PartPath& path);
void set_part(Document& selection, const PartPath& path, Document part);
// Into the set at the path, or the nearest one that holds it; a selection that is no set becomes a
// union with it. Returns where the new part is.
PartPath add_part(Document& selection, PartPath path, Document part);
// With sets that it leaves empty. False: nothing is left of the selection.
bool remove_part(Document& selection, PartPath path);
// Before its neighbour: the first of a difference is what the others are taken from.
PartPath raise_part(Document& selection, PartPath path);

// What new parts start from: they lie in the middle of the map, around the inspected pixel, or
// where the part was that they replace.
struct PartStart {
  const EditState& state;
  std::array<double, 2> at_mm{};
  double brush_mm = 1;
  std::string file;  // of images
};
Document make_part(const std::string& kind, const PartStart& start);
// The part as another kind: what both have stays. A part that becomes a set is its first.
Document change_part(const Document& part, const std::string& kind, const PartStart& start);

}  // namespace parian

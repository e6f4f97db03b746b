// Places of selections on the flat map: what a drag draws, and the handles by which shapes are
// changed. Lengths in mm.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/document.h"
#include "edit/edit_state.h"

namespace parian {

using Place = std::array<double, 2>;

struct MapSize {
  double width_mm = 1, height_mm = 1;
};
MapSize size_of(const EditState& state);

// Two corners: least and largest x and y.
using PlaceBox = std::array<Place, 2>;
// Around a shape whose places are in mm; none for parts without places.
std::optional<PlaceBox> find_box(const Document& part);
// Gives a part of a kind with a shape, in mm, places that fill the box.
void place_part(Document& part, const PlaceBox& box);

// All places and lengths of a part in mm, or relative to the map, with its key "unit". Parts of
// sets and strokes of scribbles have units of their own.
bool is_relative(const Document& part);
void convert_unit(Document& part, bool relative, const MapSize& size);

// New places from a line that was drawn: a drag across a box, an outline, an axis, a click. False
// where the kind has none, or the line gives no shape.
bool draw_part(Document& part, const std::vector<Place>& line, const MapSize& size);

// Points that can be dragged, in mm, and the part with one of them elsewhere.
std::vector<Place> find_handles(const Document& part, const MapSize& size);
void move_handle(Document& part, std::size_t handle, Place to, const MapSize& size);

// Closed outline, or a line, in mm, for the flat view; empty: nothing to show.
struct PartOutline {
  std::vector<Place> points;
  bool is_closed = false;
};
PartOutline find_outline(const Document& part, const MapSize& size);

}  // namespace parian

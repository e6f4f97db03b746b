// What strokes and clicks in the flat view or on the mesh do: they become layers of the recipe.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "app/studio/selection_places.h"
#include "app/studio/studio.h"

namespace parian {

// A layer of an operation with its defaults, over all of the map.
Document make_default_layer(const std::string& operation, const std::string& name);
void add_layer(Studio& studio, const Document& layer);
// The selected layer as it shall be; what has the same key as the last change is one entry with it.
void change_layer(Studio& studio, Document layer, std::string label, std::string merge_key = {});
// Panels see it at once, also while the editor works.
void show_pending(Studio& studio);
bool takes_selection(const std::string& operation);

// The layer that is selected, or null, and the part of its selection.
const LayerSnapshot* selected_layer(const Studio& studio);
PartPath selected_part(const Studio& studio);

// The tool `select`: a press near a handle of the part grabs it, and then it follows.
void grab_handle(Studio& studio, double x_mm, double y_mm, double reach_mm);
void drag_handle(Studio& studio, double x_mm, double y_mm);

// A layer that an operation can start with: with what was picked, stamped or inspected where it
// needs that. Throws Error that says what to do first.
Document make_starting_layer(const Studio& studio, const std::string& operation);
// A material from a photograph, with the range and shape of the inspected pixel.
void hallucinate(Studio& studio, const std::string& photograph);

// A stroke is drawn point by point, in mm, and done by finish_stroke: scribbles and brushes go into
// the selected layer's selection where it is of their kind, otherwise into a new layer; paint mixes
// in the picked profile; the stamp takes its source, then puts it down. Nothing waits: while the
// editor works strokes are kept, and apply_strokes, once a frame, does them.
void extend_stroke(Studio& studio, double x_mm, double y_mm, bool on_second = false);
void break_stroke(Studio& studio);  // what comes next is a line of its own
void finish_stroke(Studio& studio);
void apply_strokes(Studio& studio);

// Its strokes are drawn on the map, in its flat view or on the mesh.
bool draws_on_map(Tool tool);
// Of the radius of such strokes: a part of a pixel, a part of the map.
struct BrushBounds {
  double least_mm = 0, most_mm = 0;
};
BrushBounds brush_bounds(const Studio& studio);

// The eyedropper, and where profiles are plotted.
void pick_pixel(Studio& studio, MapPixel pixel);
// The eyedropper on the second material.
void pick_second(Studio& studio, double x_mm, double y_mm);
std::optional<MapPixel> pixel_at(const EditState& state, double x_mm, double y_mm);

// The place on the map, in mm, under a pixel of the 3-D view.
std::optional<std::array<double, 2>> mesh_to_map(const Studio& studio, double px, double py);
// A stroke goes on along the mesh from one pixel of the view to another. Where the map jumps under
// it, at seams of the mapping and at the edges of what is seen, a new line begins.
void extend_mesh_stroke(Studio& studio, const std::array<double, 2>& from,
                        const std::array<double, 2>& to);

// The shape curve: factors at u = r / range; becomes or changes a layer of operation `shape`.
void set_shape_point(Studio& studio, double u, double factor);

}  // namespace parian

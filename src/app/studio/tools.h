// What strokes and clicks in the flat view or on the mesh do: they become layers of the recipe.
#pragma once

#include <optional>
#include <string>

#include "app/studio/studio.h"

namespace parian {

// A layer of an operation with its defaults, over all of the map.
Document make_default_layer(const std::string& operation, const std::string& name);
void add_layer(Studio& studio, Document layer);

// The layer that is selected, or null.
const LayerSnapshot* selected_layer(const Studio& studio);

// A stroke is drawn point by point, in mm, and done by finish_stroke: scribbles and brushes go into
// the selected layer's selection where it is of their kind, otherwise into a new layer; paint mixes
// in the picked profile; the stamp takes its source, then puts it down.
void extend_stroke(Studio& studio, double x_mm, double y_mm);
void finish_stroke(Studio& studio);

// The eyedropper, and where profiles are plotted.
void pick_pixel(Studio& studio, MapPixel pixel);
std::optional<MapPixel> pixel_at(const Studio& studio, double x_mm, double y_mm);

// The shape curve: factors at u = r / range; becomes or changes a layer of operation `shape`.
void set_shape_point(Studio& studio, double u, double factor);

}  // namespace parian

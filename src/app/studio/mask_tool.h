// The tool `mask`: paints the mask of the layer that is chosen under Surface, on the mesh.
#pragma once

#include <array>

#include "app/studio/studio.h"

namespace parian {

// A press. A mask of another kind becomes one of weights at vertices with its values; one that is
// everywhere becomes empty, or stays whole where the stroke erases. Says what is missing where
// nothing can be painted, and then the stroke paints nothing.
void begin_mask_stroke(Studio& studio, bool erases);
// From one pixel of the view to another.
void extend_mask_stroke(Studio& studio, const std::array<double, 2>& from,
                        const std::array<double, 2>& to);
void finish_mask_stroke(Studio& studio);

// 0 or 1 at all vertices of the chosen layer.
void fill_mask(Studio& studio, float weight);

// Of the present stage; made when it is first asked for.
const VertexGraph& stage_graph(Studio& studio);

// The layer whose mask the tool paints; null: none is chosen.
const SurfaceLayer* painted_layer(const Studio& studio);

}  // namespace parian

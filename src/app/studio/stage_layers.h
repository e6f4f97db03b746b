// Layers of other materials over the one that is edited, and their masks.
#pragma once

#include <string>
#include <vector>

#include "app/studio/studio.h"

namespace parian {

// On top of the others, mapped as the material below, and selected.
void add_stage_layer(Studio& studio, SurfaceLayer layer);
void set_stage_layer(Studio& studio, std::size_t index, SurfaceLayer layer);
void move_stage_layer(Studio& studio, std::size_t from, std::size_t to);
void remove_stage_layer(Studio& studio, std::size_t index);

// Masks that need no file: "everywhere", "painted" (on nothing), then those of surface_mask.h. What
// a mask from a file is called comes last; it cannot be chosen.
const std::vector<std::string>& mask_kind_names();
std::size_t mask_kind_of(const SurfaceMask& mask);
// Across the object, so that an edge is seen.
SurfaceMask make_mask(std::size_t kind, const Stage& stage);

}  // namespace parian

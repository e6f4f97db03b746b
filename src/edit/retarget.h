// Edits of compressed materials: gains and dilations of pixels go into a blend as they are; edits
// of base materials change the few base profiles.
#pragma once

#include "edit/edit_state.h"
#include "material/profile_blend.h"

namespace parian {

// The blend with the gains and dilations of `after`, which edits made of `before`, the blend's own
// state. Throws Error when they changed shapes or the grid: then the map must be edited and
// compressed again.
ProfileBlend retarget(const ProfileBlend& blend, const EditState& before, const EditState& after);

// The base materials as a map of M x 1 pixels, and back: profiles sampled at the blend's knots,
// non-increasing, on its grid.
EditState make_base_state(const ProfileBlend& blend);
ProfileBlend retarget_bases(const ProfileBlend& blend, const EditState& bases);

}  // namespace parian

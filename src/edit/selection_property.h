// What thresholds compare: one value for each pixel of a map.
#pragma once

#include <string>
#include <vector>

#include "edit/edit_state.h"

namespace parian {

enum class SelectionProperty { albedo, range, mean_radius, lightness, chroma, hue_deg };
const std::vector<std::string>& selection_property_names();

// Albedo, range and mean radius of a channel, or with -1 their mean over the channels; of the
// albedo in OKLCh lightness, chroma, and hue in [0, 360).
Plane eval_selection_property(const EditState& state, SelectionProperty property, int channel);

}  // namespace parian

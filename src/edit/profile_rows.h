// Shapes of all pixels at the same places, so that they can be filtered and interpolated.
#pragma once

#include <vector>

#include "edit/edit_state.h"

namespace parian {

// ln S [channel][knot][y][x] at u_k = r_k / mean range of the channel's knots: profiles of other
// ranges are sampled between their knots. Non-increasing where the profiles are.
std::vector<float> normalise_rows(const EditState& state);

}  // namespace parian

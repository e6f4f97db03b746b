// How sources of raw appearance vectors hand them to the reduction. Private to edit.
#pragma once

#include <cstddef>
#include <functional>

#include "edit/features.h"

namespace parian {

// Writes the raw vectors of pixels [begin, begin + count) to out [raw_dim][count]. Called from
// several threads, more than once for some pixels.
using FillRaw = std::function<void(std::size_t begin, std::size_t count, float* out)>;

// Principal components and scale. Raw values are finite and their squares do not overflow.
Features reduce_features(int width, int height, int raw_dims, int dims, const FillRaw& fill);

}  // namespace parian

// Reduced systems before their data. Private to fit.
#pragma once

#include "fit/reduced_system.h"

namespace parian {

// Offsets, weights and sizes of one channel's system; nothing is read.
ReducedSystem make_geometry(const SliceSource& table, int channel, const ReducedParams& params);

}  // namespace parian

// How far a table that lists both directions is from reciprocity.
#pragma once

#include "base/progress.h"
#include "material/slices.h"

namespace parian {

// |R - R^T| / |R| (Frobenius) over the pairs that are measured in both directions, all channels;
// NaN when there are none. Reads each slice once. The table must list d and -d (Error otherwise); a
// table that is symmetric by construction gives 0 and is not read.
double measure_asymmetry(const SliceSource& table, const Progress& progress = {});

}  // namespace parian

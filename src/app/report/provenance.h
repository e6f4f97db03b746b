// Where a fitted map comes from, as it is written into the map's file.
#pragma once

#include <string>

#include "fit/fit_params.h"
#include "material/slices.h"

namespace parian {

// JSON text: program, parameters, the table's file name (without its folder) and provenance.
std::string make_fit_provenance(const SliceSource& table, const FitParams& params);

}  // namespace parian

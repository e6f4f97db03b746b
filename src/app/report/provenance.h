// Where a fitted map or a blend comes from, as it is written into its file.
#pragma once

#include <string>

#include "base/document.h"
#include "compress/compress_params.h"
#include "fit/fit_params.h"
#include "material/slices.h"
#include "transport/precompute.h"

namespace parian {

// JSON text: program, parameters, the table's file name (without its folder) and provenance.
std::string make_fit_provenance(const SliceSource& table, const FitParams& params);

// The same for a blend: program, parameters, and the map it was made from, by its file name where
// it has one, with its own provenance.
std::string make_blend_provenance(const std::string& file, const std::string& map_provenance,
                                  const CompressParams& params);

// The same for an edited material: program, recipe, and what it was applied to.
std::string make_edit_provenance(const std::string& file, const std::string& provenance,
                                 const std::string& recipe_file, const Document& recipe);

// The same for transport: program, parameters, and the scene's file name.
std::string make_transport_provenance(const std::string& scene_file,
                                      const PrecomputeParams& params);

}  // namespace parian

// Exact relighting of flat samples: M(x) = sum over measured pairs of R_d(x, y) E(y) times the
// pixel area.
#pragma once

#include <vector>

#include "base/progress.h"
#include "image/image.h"
#include "material/slices.h"

namespace parian {

enum class FlatLight { uniform, disc, line };

// Irradiance on the grid, 1 inside and 0 outside: uniform; a disc of radius min(width, height)/6 at
// the centre; a vertical line of three pixels through the centre.
Image make_flat_light(FlatLight light, int width, int height, int channels);

// Radiant exitance under each of the lights (width x height x channels each), streaming the table
// once for all of them. Pairs that are not measured contribute nothing.
std::vector<Image> relight(const SliceSource& table, const std::vector<Image>& irradiance,
                           const Progress& progress = {});

}  // namespace parian

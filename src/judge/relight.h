// Exact relighting of flat samples: M(x) = sum over measured pairs of R_d(x, y) E(y) times the
// pixel area, light leaving at x and entering at y.
#pragma once

#include <vector>

#include "base/progress.h"
#include "image/image.h"
#include "material/slices.h"

namespace parian {

enum class FlatLight { uniform, disc, line };

// Irradiance on the grid, 1 inside and 0 outside: uniform; a disc of radius min(width, height)/6 at
// the centre; a vertical line of three pixels through the centre (pixel width/2 and its
// neighbours).
Image make_flat_light(FlatLight light, int width, int height, int channels);

// Radiant exitance under each of the lights (width x height x the table's channels each), streaming
// the table once for all of them. A light has 1 channel, which lights all, or the table's. Pairs
// that are not measured contribute nothing. Of a symmetric table, a value carries light from x + d
// to x and from x to x + d; where both directions are listed, from x + d to x alone. The same bits
// for any number of threads. Throws Error for a light of another grid or with a value that is not
// finite.
std::vector<Image> relight(const SliceSource& table, const std::vector<Image>& irradiance,
                           const Progress& progress = {});

}  // namespace parian

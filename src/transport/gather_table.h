// The second pass with a measured table instead of a model: the reference that a fit is held
// against. A table is a flat sample, so R of two surface points is the mean over both ends of
//
//   the bilinear table value at the displacement between them, projected to the end's tangent
//   plane, rotated into the texture frame and lengthened to the 3-D distance,
//
// bilinear over the four offsets and over the four pixels around the end's place, and zero beyond
// the window. A displacement straight along the normal counts as one along x.
//
// Pixels beyond the border are those at the border, as mirrored tiling has it; a pair that leaves
// the grid is read with that component of d reflected. Offsets that are not in the half plane are
// read as the reverse pair. What is not measured (NaN, or an offset between listed
// ones that is not listed) is left out and the weights of the other taps are scaled up;
// where none is left, that end adds nothing. Of a table with both directions, light leaves at the
// target and enters at the source, seen from either end.
//
// Near term: as in gather.h, with the end o's table values in place of P_o. So a plane under
// uniform light scatters the table's row sum however the samples lie. A target whose near samples
// all lie where the table is zero gets the near samples' mean irradiance times I.
#pragma once

#include <cstddef>
#include <vector>

#include "base/progress.h"
#include "material/bssrdf_table.h"
#include "math/vec.h"
#include "scene/mapping.h"

namespace parian {

struct TableGatherPoint {
  Vec3 position;      // mm
  Vec3 normal;        // unit, outward
  SamplePoint place;  // in the table's grid
};

// Samples of one area each with the flux that entered there.
struct TableGatherSources {
  std::vector<TableGatherPoint> points;
  std::vector<Rgb> flux;
  double area_mm2 = 0;  // of each
};

// For each target the exitance in W/mm^2, never negative. A grey table counts for red, green and
// blue. Range-limited; the same bits for any number of threads. near_mm = 0 is the plain sum.
std::vector<Rgb> gather_table(const BssrdfTable& table, const TableGatherSources& sources,
                              const std::vector<TableGatherPoint>& targets, double near_mm,
                              const Progress& progress = {});

// Bytes that gather_table needs for a table of this header, beside the table itself.
std::size_t gather_table_bytes(const TableHeader& header);

}  // namespace parian

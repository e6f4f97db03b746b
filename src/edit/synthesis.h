// Synthesis of a map of any size from a small sample: patches of the sample are quilted on a
// lattice with minimum-error seams (Efros and Freeman 2001), their seams are covered by further
// patches where that makes them better (Kwatra et al. 2003), and sources used before are penalised
// so that no repetition is seen.
#pragma once

#include <cstdint>
#include <vector>

#include "base/params.h"
#include "base/progress.h"

namespace parian {

struct SynthesisParams {
  int width_px = 512, height_px = 512;  // wanted size; at most 2^24 pixels together
  int patch_px = 0;        // side of a patch; 0: a quarter of the sample's shorter side, at least 8
  int overlap_px = 0;      // of neighbouring patches; 0: a third of the patch
  double tolerance = 0.1;  // patches up to this much worse than the best are chosen among
  int seed = 1;
  bool tileable = false;  // the result continues itself across its borders
};
ParamList describe(SynthesisParams& params);

// For every output pixel, row by row, the index y * width + x of the sample pixel whose profiles it
// takes. Whole profiles are copied, so every invariant of the sample holds. `planes` are properties
// of the sample, [plane][y][x], that should look continuous, e.g. ln albedo and ln range of each
// channel; their units do not matter, for each is standardised, and constant ones are ignored.
// Patches and overlaps that the sample or the wanted size has no room for shrink: a patch takes at
// most half the sample's shorter side, an overlap at most half a patch.
// The same for any number of threads. Throws Error for bad parameters, a value that is not finite
// and a sample below 4 x 4 pixels, and make_cancelled_error() when cancelled.
std::vector<std::uint32_t> synthesize(const std::vector<float>& planes, int plane_count, int width,
                                      int height, const SynthesisParams& params,
                                      const Progress& progress = {});

}  // namespace parian

// K, M and the quantisers for a limit of size or error: from short runs of a few of them.
#pragma once

#include <functional>

#include "compress/compress.h"

namespace parian {

struct CompressLimits {
  std::size_t max_bytes = 0;  // of the whole file; 0: none
  double max_error = 0;       // mean relative error; 0: none
};

// Size of the file that a blend would make: io knows it.
using MeasureBytes = std::function<std::size_t(const ProfileBlend&)>;

// `params` with bases, per_pixel and, where `packed`, the lattice set for the limits: the least
// error within max_bytes, or the least size within max_error. Throws Error naming what is reached
// at best when nothing fits.
CompressParams choose_params(const ProfileMap& map,
                             const std::shared_ptr<const BlendObjective>& objective,
                             const CompressParams& params, const CompressLimits& limits,
                             bool packed, const MeasureBytes& measure_bytes,
                             const Progress& progress = {});

}  // namespace parian

// K, M and the quantisers for a limit of size or error: from short runs of a few of them.
#pragma once

#include <functional>

#include "compress/compress.h"

namespace parian {

struct CompressLimits {
  std::size_t max_bytes = 0;  // of the whole file; 0: none
  double max_error = 0;       // mean relative error; 0: none
};

// What only the caller can measure of a blend.
struct BlendMeasures {
  std::function<std::size_t(const ProfileBlend&)> bytes;  // of the file that it would make
  std::function<double(const ProfileBlend&)> error;       // mean relative, against the table
};

// `params` with bases, per_pixel and, where `packed`, the lattice set for the limits: the least
// error within max_bytes, or the least size within max_error. Throws Error naming what is reached
// at best when nothing fits.
CompressParams choose_params(const ProfileMap& map,
                             const std::shared_ptr<const BlendObjective>& objective,
                             const CompressParams& params, const CompressLimits& limits,
                             bool packed, const BlendMeasures& measures,
                             const Progress& progress = {});

}  // namespace parian

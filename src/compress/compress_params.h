// Parameters of the compression to K base materials per pixel.
#pragma once

#include <cstdint>

#include "base/params.h"

namespace parian {

// What is minimised.
enum class Objective {
  balanced,  // relative and albedo error of all pixels, squared and added
  paper,     // Eq. 5 and 6 of the 2019 paper: logarithms, weight 1 / (1 + r^2)
  relative,  // the relative error alone
  albedo,    // the albedo error, with a little of the relative error to keep shapes
};

struct CompressParams {
  int bases = 128;    // M
  int per_pixel = 2;  // K
  Objective objective = Objective::balanced;
  int rounds = 10;          // at most, for each number of bases per pixel
  double tolerance = 1e-3;  // ends the rounds that lower the objective by less than this part
  int weight_levels = 0;    // weights become multiples of 1 / levels; 0: any
  double profile_step = 0;  // ln P becomes a multiple of it; 0: any
  std::uint64_t seed = 1;
};

// The lattice of packed files: little is lost on it (docs/compression.md).
inline constexpr int default_weight_levels = 63;
inline constexpr double default_profile_step = 0.004;

ParamList describe(CompressParams& params);

}  // namespace parian

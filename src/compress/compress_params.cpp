#include "compress/compress_params.h"

#include "material/profile_blend.h"

namespace parian {

ParamList describe(CompressParams& params) {
  return {
      {.name = "bases",
       .help = "base materials; no more than pixels are used",
       .target = &params.bases,
       .min = 1,
       .max = max_bases,
       .symbol = "M",
       .letter = 'M'},
      {.name = "per-pixel",
       .help = "base materials mixed at each pixel",
       .target = &params.per_pixel,
       .min = 1,
       .max = max_bases_per_pixel,
       .symbol = "K",
       .letter = 'K'},
      {.name = "objective",
       .help = "error to minimise: relative and albedo error in balance, the 2019 paper's energy, "
               "or one of the errors",
       .target = make_choice(params.objective, {"balanced", "paper", "relative", "albedo"})},
      {.name = "rounds",
       .help = "rounds at most, for each number of bases per pixel up to K",
       .target = &params.rounds,
       .min = 0,
       .max = 10'000},
      {.name = "tolerance",
       .help = "a round that lowers the objective by less than this part is the last",
       .target = &params.tolerance,
       .min = 0,
       .max = 1},
      {.name = "weight-levels",
       .help = "weights are multiples of 1/levels; 0 takes 63 for packed files, any for others",
       .target = &params.weight_levels,
       .min = 0,
       .max = 65535},
      {.name = "profile-step",
       .help = "ln P is a multiple of it; 0 takes 0.004 for packed files, any for others",
       .target = &params.profile_step,
       .min = 0,
       .max = 1},
      {.name = "seed", .help = "of the start", .target = &params.seed},
  };
}

}  // namespace parian

#include "fit/fit_params.h"

namespace parian {

ParamList describe(FitParams& params) {
  return {
      {.name = "segments",
       .help = "equal segments of ln P over the radius; 0 takes one per pixel, at most 24",
       .target = &params.segments,
       .min = 0,
       .max = 256,
       .symbol = "n"},
      {.name = "radius-mm",
       .help = "scattering radius; pairs farther apart are left out; 0 takes the table's largest "
               "offset",
       .target = &params.radius_mm,
       .min = 0,
       .symbol = "r_s",
       .unit = "mm"},
      {.name = "knots-mm",
       .help = "knots from 0 instead of equal segments",
       .target = &params.knots_mm,
       .min = 0,
       .unit = "mm"},
      {.name = "lambda",
       .help = "weight of the curvature of ln P",
       .target = &params.lambda,
       .min = 0,
       .max = 1e6,
       .symbol = "lambda"},
      {.name = "weight",
       .help = "how much a pair counts by its distance, or by its noise",
       .target = make_choice(params.weight, {"uniform", "inverse-quadratic", "energy", "noise"}),
       .symbol = "phi"},
      {.name = "monotone",
       .help = "make every profile non-increasing after the fit",
       .target = &params.monotone},
      {.name = "tolerance",
       .help = "relative residual of the normal equations at which the solver stops",
       .target = &params.tolerance,
       .min = 1e-14,
       .max = 1},
      {.name = "max-iterations",
       .help = "limit of conjugate-gradient iterations per channel",
       .target = &params.max_iterations,
       .min = 0,
       .max = 100'000},
      {.name = "hold-out",
       .help = "fraction of the pairs to keep out of the fit and to judge it on",
       .target = &params.hold_out,
       .min = 0,
       .max = 0.9},
      {.name = "seed", .help = "which pairs are held out", .target = &params.seed},
      {.name = "fill-unmeasured",
       .help =
           "give pixels without a measured pair the nearest pixel's profile instead of stopping",
       .target = &params.fill_unmeasured},
  };
}

}  // namespace parian

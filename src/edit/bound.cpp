#include "edit/bound.h"

#include <cmath>

#include "judge/row_sums.h"
#include "material/material.h"

namespace parian {
namespace {

RowSums measure(const EditState& state, const Progress& progress) {
  const Material material = make_profile_map(state);
  return measure_row_sums(*make_slices(material, natural_header(material)), progress);
}

// C <- C min(1, limit / rho)^power, by the mask.
void lower(EditState& state, const RowSums& sums, double limit, double power, const Mask& mask) {
  auto gain = std::make_shared<Plane>(*state.gain);
  for (std::size_t i = 0; i < state.pixels(); ++i)
    for (std::size_t c = 0; c < static_cast<std::size_t>(state.channels); ++c) {
      const auto rho =
          static_cast<double>(sums.albedo.values[i * static_cast<std::size_t>(state.channels) + c]);
      // A little below, since gains are stored as floats.
      const double excess = rho * (1 + 1e-6) / limit;
      if (excess > 1)
        (*gain)[c * state.pixels() + i] *=
            std::pow(excess, -power * static_cast<double>(mask.weight[i]));
    }
  state.gain = std::move(gain);
}

}  // namespace

ParamList describe(BoundParams& params) {
  return {{.name = "limit",
           .help = "largest row sum of R_d allowed",
           .target = &params.limit,
           .min = 0.01,
           .max = 100},
          {.name = "iterations",
           .help = "gentle steps before the certain one",
           .target = &params.iterations,
           .min = 0,
           .max = 100}};
}

double bound_energy(const BoundParams& params, EditState& state, const Mask& mask,
                    const Progress& progress) {
  RowSums sums = measure(state, progress);
  const double before = sums.max;
  for (int i = 0; i < params.iterations && sums.max > params.limit; ++i) {
    lower(state, sums, params.limit, 1, mask);
    sums = measure(state, progress);
  }
  if (sums.max > params.limit) lower(state, sums, params.limit, 2, mask);
  return before;
}

}  // namespace parian

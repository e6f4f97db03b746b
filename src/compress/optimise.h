// Alternating minimisation over base profiles, indices and weights, majorised by the separable
// bound of local_model.h: one evaluation of the objective, then a few exact steps on the bound.
#pragma once

#include <cstdint>

#include "compress/mixture.h"

namespace parian {

struct OptimiseParams {
  std::size_t bases = 128;    // M
  std::size_t per_pixel = 2;  // K
  int width = 1;              // of the grid
  int weight_levels = 0;      // see AssignParams
  bool fixed_bases = false;   // indices and weights alone
  int rounds = 40;            // at most, per number of bases per pixel
  double tolerance = 1e-4;    // stops when a round lowers F by less than this part
  std::uint64_t seed = 1;
};

struct RoundReport {
  int per_pixel = 0;  // K in that round
  double energy = 0;  // F after it
  bool accepted = true;
};

// The state of a run: may be copied, advanced, abandoned, and gone on with.
struct OptimiseState {
  OptimiseParams params;
  Mixture mixture;    // the best so far
  double energy = 0;  // its F
  std::vector<RoundReport> history;
  AlignedVector<float> gradient;  // rows, at `mixture`
  double bound_scale = 1;         // of D; rises when a step did not lower F
  int round = 0;                  // with this K
  bool done = false;
};

OptimiseState make_optimise_state(const BlendObjective& objective,
                                  const AlignedVector<float>& target_rows,
                                  const OptimiseParams& params);
// From a mixture of K or fewer bases per pixel: F never ends above its own.
OptimiseState make_optimise_state(const BlendObjective& objective, Mixture start,
                                  const OptimiseParams& params);

// One round. Lowers F or leaves the mixture alone.
void advance(const BlendObjective& objective, OptimiseState& state);

// F of a mixture, with the base profiles' own term.
double eval_energy(const BlendObjective& objective, const Mixture& mixture,
                   PixelErrors* errors = nullptr);

}  // namespace parian

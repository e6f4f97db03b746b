// The compression as the 2019 paper describes it (section 3.3): random start, then rounds of a
// gradient method over bases and weights (L-BFGS-B for K = 1 and 2, augmented Lagrangian for
// K >= 3) and of a PatchMatch sweep over the pixels' parameter sets. As fast as it can be made, so
// that a comparison is about the method.
//
// Minimises E_LS + lambda_reg E_reg + lambda_barr E_barr (Eq. 5, 6): E_LS over ordered pairs within
// the last knot with phi = 1 / (1 + r^2), r in pixels; E_reg on plain second differences.
//
// Where the paper leaves a choice, or errs:
// - Barriers: gamma cancels in -log(gamma t), and -log(1 - gamma t) is flat. We take what was
//   meant: -gamma log t - gamma log(1 - t).
// - "The second step is inserted after every iteration of the solver" does not say how many
//   L-BFGS-B iterations that is: `inner`. L-BFGS-B starts without history each time, as the sweep
//   has changed its function. For K >= 3 a round is one iteration of the augmented Lagrangian: at
//   most `inner` iterations of L-BFGS-B, then multipliers or penalty are updated.
// - A round tries the left and upper neighbour (even) or the right and lower one (odd), in scan
//   order (reversed in odd rounds), then "random pixels": `random_candidates` of them.
// Both numbers are those with the lowest energy per time on a 108 x 108 stone (K = 2: from 5 to 10
// iterations the energy falls by 2 %, to 20 and more by nothing; from 1 to 64 pixels by 5 %, to 128
// by 0.6 % in a third more time).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "material/bssrdf_table.h"
#include "material/profile_blend.h"

namespace parian {

struct KbmppParams {
  int bases = 128;             // M >= K, at most 65535
  int per_pixel = 2;           // K, 1 to 8
  int iterations = 20;         // N_iter
  int run_iterations = 0;      // stop after so many of them; 0: all
  int inner = 0;               // L-BFGS-B iterations per round; 0: 10 for K <= 2, 50 for K >= 3
  int memory = 10;             // corrections that L-BFGS-B keeps
  int random_candidates = 64;  // per pixel and sweep
  double lambda_reg = 1e-3;
  double lambda_barr = 1e-3;
  double gamma = 1e-3;
  double a0 = 0.1;  // a candidate that lowers the energy is taken with min(a0 p^i, 1)
  std::uint64_t seed = 1;
};

inline int inner_iterations(const KbmppParams& params) {
  if (params.inner > 0) return params.inner;
  return params.per_pixel <= 2 ? 10 : 50;
}

// Throws Error naming the field.
void check(const KbmppParams& params);

struct KbmppRound {
  int iteration = 0;   // from 1
  double seconds = 0;  // since the start, without callbacks and the energy for them
  double energy = 0;   // E_LS + lambda_reg E_reg, with weights scaled to sum 1
  double seconds_solver = 0, seconds_evaluations = 0, seconds_match = 0;  // parts, since the start
  int evaluations = 0;            // of function and gradient, since the start
  std::size_t replaced = 0;       // parameter sets that this round's sweep has copied
  double largest_constraint = 0;  // max_x |sum_k t_xk - 1| before the sweep (K >= 3)
};
using KbmppCallback = std::function<void(const KbmppRound&)>;

// Base profiles are not kept from rising: the paper does not. Pairs that are not measured, or not
// positive, are left out. Same bits for any number of threads.
ProfileBlend run_kbmpp(const BssrdfTable& table, const std::vector<double>& knots_mm,
                       const KbmppParams& params, const KbmppCallback& callback = {});

// E_LS + lambda_reg E_reg of a blend by a plain loop over the pairs in double precision.
double eval_kbmpp_energy(const BssrdfTable& table, const ProfileBlend& blend,
                         double lambda_reg = 1e-3);

}  // namespace parian

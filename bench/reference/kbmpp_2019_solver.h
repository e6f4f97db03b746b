// The first step of a round in the 2019 paper: bases and weights for fixed indices.
#pragma once

#include <cstddef>
#include <vector>

#include "bench/reference/kbmpp_2019.h"
#include "bench/reference/kbmpp_2019_lbfgsb.h"
#include "bench/reference/kbmpp_2019_pairs.h"

namespace parian::kbmpp {

// Conn, Gould and Toint 1991 for c_x = sum_k t_xk - 1 = 0, with the constants of LANCELOT
// but for the first penalty, whose choice matters (10 ends lower than 1e-4 to 1 and 100):
// Phi = E + sum_x (multiplier_x c_x + c_x^2 / (2 penalty)).
struct Lagrangian {
  std::vector<double> multiplier;  // [y][x]; empty for K <= 2
  double penalty = 10;             // mu
  double tolerance = 0.1;          // eta: on max |c|
};

struct Solver {
  const Pairs& pairs;
  const KbmppParams& params;
  Model model;
  Workspace work;
  // Variables: bases [base][knot][channel], then t [y][x] for K = 2, t [y][x][k] for K >= 3.
  std::vector<double> x;
  Box box;
  Lagrangian lagrangian;
  int evaluations = 0;
  double seconds_evaluations = 0;
};

// Random start of section 3.3.
Solver make_solver(const Pairs& pairs, const KbmppParams& params);

// The function that L-BFGS-B minimises: E_LS + lambda_reg E_reg + lambda_barr E_barr, for K >= 3
// with multipliers and penalty, and its gradient.
double eval_objective(Solver& solver, const double* x, double* gradient);

// E_LS + lambda_reg E_reg, weights scaled to sum 1. Overwrites the workspace.
double eval_feasible_energy(Solver& solver);

// At most `inner` iterations of L-BFGS-B; for K >= 3 then the update of the Lagrangian. The
// workspace holds the result's evaluation. Returns max |c| (0 for K <= 2).
double solve(Solver& solver);

// After a sweep has changed the model.
void read_model(Solver& solver);

}  // namespace parian::kbmpp

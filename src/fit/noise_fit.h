// The fit of tables with a noise model: Gauss-Newton steps on reduced systems (noise_step.h), each
// of which reads the table once. Zero and negative values take part; no logarithm of noise is
// taken.
#pragma once

#include <vector>

#include "fit/noise_step.h"
#include "fit/reduced_system.h"

namespace parian {

struct NoisyFitParams {
  // How far, as a standard deviation of ln P, a pixel's profile may be expected to part from the
  // mean profile between r = 0 and the last knot. It settles what noise hides: with the weights
  // 8 s^2 phi (1 - mean w) / (spread^2 dr / r_n) on the slopes of the difference from the mean of
  // all pixels, a random walk is what remains where v >> s^2, and nothing where the noise is small.
  double spread = 1.5;
  double tolerance = 4e-3;  // root mean square, by weight, of a step in Q_d(x) + Q_d(x + d)
  int max_steps = 30;
  int max_iterations = 200;  // of conjugate gradients, per step
};

struct NoisyFit {
  ReducedSystem system;          // of the last step; its right-hand side is about p
  std::vector<double> p;         // ln P, [knot][y][x]
  NoiseStep step;                // what a step about another field takes
  int steps = 0;                 // tables read
  int iterations = 0;            // of conjugate gradients, all steps
  double last_step = 0;          // compare tolerance
  double relative_residual = 0;  // of the equations: at the end over at the start
};

// `params.weight` is the weight by distance; noise takes none. Throws Error when noise is all there
// is: no offset has a positive mean.
NoisyFit fit_noisy(const SliceSource& table, int channel, const ReducedParams& params,
                   const NoisyFitParams& noisy, const Progress& progress = {});

// 1/2 sum of m phi w (2 z)^2 and the curvature's part: the fit's energy at p.
double eval_noisy_energy(const SliceSource& table, const ReducedParams& params, const NoisyFit& fit,
                         const std::vector<double>& p);

// The quadratic about p in the form of a reduced system: E(p') with H, b and c.
ReducedSystem make_noisy_system(const SliceSource& table, int channel, const ReducedParams& params,
                                const std::vector<double>& p, const Progress& progress = {});

}  // namespace parian

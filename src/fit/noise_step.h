// Residuals of a noisy table without logarithms of noise: the reduced system of one step of the
// noise-aware fit.
//
// The fit solves, for each channel, the estimating equations of a quasi-likelihood (Wedderburn
// 1974), with R* = exp((Q_d(x) + Q_d(x + d)) / 2) the model's own value at a pair and v = (floor^2
// + gain R*) / R*^2 its relative variance:
//
//   sum over pairs of m_d phi(d) w 2 z d(Q_d(x) + Q_d(x + d)) / dp = gradient of the regulariser
//   w = s^2 / (s^2 + v)                        s = 0.3 stands for the model's own misfit in ln R
//   z = (R - R*) / R*          where v is large: no logarithm, any R, mean 0 when R* is right
//     = ln(R / R*) + v / 2     where v is small: what the plain fit minimises, less its bias
//   and the mean of both with weights 1 and 1 / (1 + (v / 0.05)^2) in between.
//
// Weights depend on the model alone, never on the value that they weigh: so the mean of the
// equation is 0 at the model of the noise-free table, whatever the noise. Per pair the left side
// depends on Q_d(x) + Q_d(x + d) alone, so it is the gradient of a function of the profiles, and a
// step can be checked by the slope along it. One Gauss-Newton step about p solves H delta =
// right-hand side, in which H has the mean of w over each offset for w: the right-hand side is
// exact.
#pragma once

#include <vector>

#include "fit/noise_kernels.h"
#include "fit/reduced_system.h"

namespace parian {

// What a step is made about.
struct NoiseStep {
  PairNoise noise;
  std::vector<float> field;  // ln P, [knot][y][x]
  std::vector<double> phi;   // weight by distance, per offset of the system
};

// Weighted residuals m-less: rows[y][x] = phi w 2 z at x for the pairs of offset i, 0 where there
// is none. `row(y)` is where row y goes.
struct NoiseSums {
  double weight = 0;   // sum of w
  double squares = 0;  // sum of phi w (2 z)^2
};
NoiseSums eval_noise_offset(const ReducedSystem& system, const NoiseStep& step, std::size_t i,
                            const TableHeader& header, const float* slice, float* first_row,
                            std::size_t stride);

// Mean of R over the measured pairs of each offset, with negative values in, and their number.
struct OffsetMeans {
  std::vector<double> mean;  // 0 where there is no pair
  std::vector<double> known;
};
OffsetMeans measure_offset_means(const SliceSource& table, const ReducedSystem& geometry,
                                 const Progress& progress = {});

}  // namespace parian

// The reduced system of a log-domain fit (algorithms: "read the table once, then never again").
//
// Every model with radial profiles minimises the same quadratic of ln R_d, for one channel:
//
//   E(p) = 1/2 sum_d m_d sum_x W_d(x) [Q_d(x) + Q_d(x + d) - 2 ln R_d(x, x + d)]^2
//          + 1/2 lambda^2 sum (second differences of p over knots)^2
//        = 1/2 p^T H p - b^T p + c,       Q_d(x) = sum_k c_k(|d|) p[k][x]
//
// c_k are the hat functions of the knots; m_d counts ordered pairs (2, or 1 for d = 0). Weights
// have the form W_d(x) = sum_q u_q(x) u_q(x + d) phi_q(d), so H is a sum of convolutions between
// pixel scalings, minus the rows of pairs that are not measured. One pass over the slices gives b
// and c. The fit solves it; compression minimises E over its own parameters through it.
//
// Vectors p, b are planes [knot][y][x]. Systems are values; nothing refers to the table any more,
// unless `restream` is set.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/progress.h"
#include "fit/fit_params.h"
#include "material/profile_map.h"
#include "material/slices.h"

namespace parian {

// One term of the pair weights.
struct WeightTerm {
  std::vector<float> u;     // [y][x]; empty = 1. 0 masks a pixel.
  std::vector<double> phi;  // per offset of the system
};

struct ReducedSystem {
  int width = 0, height = 0;
  double pixel_pitch_mm = 1;
  std::vector<double> knots_mm;
  double lambda = 0;

  // The offsets that take part: those within the last knot.
  std::vector<Offset> offsets;
  std::vector<int> table_index;    // of each, in the table
  std::vector<double> pair_count;  // m_d
  std::vector<int> segment;        // |d| lies between knots segment and segment + 1,
  std::vector<double> fraction;    // at this fraction: c_segment = 1 - fraction

  std::vector<WeightTerm> weights;
  // Per offset: pixel indices x of pairs inside the grid that take no part (not measured, not
  // positive, held out). Empty lists when restream is set.
  std::vector<std::vector<std::uint32_t>> missing;

  std::vector<double> right_hand_side;  // b
  double constant = 0;                  // c

  // Adds 1/2 sum_k slope_weight[k] (p_{k+1} - p_k)^2 to E; knots - 1 values, or none.
  std::vector<double> slope_weight;

  // Set when very many missing pairs do not fit the form above: products then read the table again,
  // and `weights` only serves the preconditioner. Must outlive the system.
  const SliceSource* restream = nullptr;
  int channel = 0;
  PairWeight pair_weight = PairWeight::uniform;
  HoldOut hold_out;

  std::size_t pairs = 0;         // ordered pairs that take part
  std::size_t not_measured = 0;  // listed values that are NaN
  std::size_t not_positive = 0;  // listed values <= 0
  std::size_t held_out = 0;      // listed values

  std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
  std::size_t knots() const { return knots_mm.size(); }
  std::size_t unknowns() const { return knots() * pixels(); }
};

struct NoiseStep;  // noise_step.h

struct ReducedParams {
  std::vector<double> knots_mm;
  double lambda = 0.01;
  PairWeight weight = PairWeight::inverse_quadratic;
  HoldOut hold_out;
  bool allow_unmeasured = false;  // pixels without a measured pair are masked instead of an error
  std::vector<WeightTerm>
      weights;  // instead of `weight`, phi per offset of the table; may be empty
  // Instead of 2 ln R, residuals about a field: b is minus the gradient of their part of E there,
  // `weights` the mean weights of its pairs and c its value. `weight` must be uniform.
  const NoiseStep* about = nullptr;
};

// Streams one channel of the table once. Throws Error naming the pixel when one has no measured
// pair.
ReducedSystem make_reduced_system(const SliceSource& table, int channel,
                                  const ReducedParams& params, const Progress& progress = {});

// Pixels whose weights are all 0: those that the caller or allow_unmeasured masked.
std::vector<std::uint32_t> unmeasured_pixels(const ReducedSystem& system);

// Knots as FitParams ask for. Throws Error for a radius beyond the table's offsets.
std::vector<double> make_knots(const TableHeader& header, const FitParams& params);

// Coefficients of the second difference at three knots, such that equal spacing gives (1, -2, 1).
struct SecondDifference {
  double left = 1, middle = -2, right = 1;
};
SecondDifference second_difference(const std::vector<double>& knots_mm, std::size_t left);

}  // namespace parian

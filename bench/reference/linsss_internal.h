// The least-squares problem of one channel of LinSSS, through the rings of equal distance: on one,
// the Gaussians are constants, so that sums over pairs need one number per pixel, not one per
// Gaussian.
#pragma once

#include "bench/reference/linsss.h"

namespace parian {

using Plane = AlignedVector<float>;

struct Ring {
  int radius2 = 0;           // |d|^2 in pixels
  std::vector<int> offsets;  // indices into the table's
};
std::vector<Ring> find_rings(const TableHeader& header);

// 1/e_x, 0 where nothing is measured.
Plane make_pixel_weights(const BssrdfTable& table);

// F(W) = 1/2 W^T H W - b^T W + c over W [gaussian][y][x].
struct LinsssProblem {
  const BssrdfTable& table;
  int channel = 0;
  const std::vector<Ring>& rings;
  const Plane& u;               // pixel weights
  std::vector<char> gaps;       // per offset: some pair in the grid is missing
  std::vector<float> gaussian;  // [ring][gaussian]
  std::size_t gaussians = 0;
  std::vector<Plane> ring_weight;  // [ring]: sum of pair weights at x
  Plane b;                         // [gaussian][y][x]
  double c = 0;
  AlignedVector<float> bound;  // [pixel][gaussian][gaussian]: H <= blockdiag(bound)
};
LinsssProblem make_linsss_problem(const BssrdfTable& table, int channel,
                                  const std::vector<Ring>& rings, const Plane& u,
                                  const std::vector<double>& sigma_px);

// H W - b
Plane linsss_gradient(const LinsssProblem& problem, const Plane& weight);

}  // namespace parian

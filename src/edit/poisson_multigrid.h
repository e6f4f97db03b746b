// One symmetric multigrid V-cycle for the 5-point Laplacian on an irregular region: the
// preconditioner of solve_poisson. Bilinear transfer, Galerkin coarse operators, and
// Chebyshev smoothing of degree 2 (Adams, Brezina, Hu and Tuminaro 2003).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "edit/poisson_kernels.h"

namespace parian {

struct MultigridLevel {
  GridShape shape;  // of one plane
  // Coefficients, one plane each, 0 outside the region. The finest level is the plain Laplacian
  // and has no diagonal couplings.
  std::vector<float> mask, self, right, down, down_right, down_left, inverse;
  std::vector<float> weight;      // of each row of the prolongation
  std::array<float, 2> omega{};   // the two steps of the smoother
  std::vector<float> b, x, work;  // all planes
};

struct Multigrid {
  int planes = 0;
  std::vector<MultigridLevel> levels;  // finest first
  std::vector<float> coarse_inverse;   // dense, over all cells of the coarsest level
};

// region is [y][x]; the whole image (singular up to constants) is allowed.
Multigrid make_multigrid(int width, int height, int planes,
                         const std::vector<std::uint8_t>& region);

// levels[0].x = M⁻¹ levels[0].b; b must be 0 outside the region.
void run_cycle(Multigrid& grid);

}  // namespace parian

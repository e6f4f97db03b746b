// Poisson editing of property planes after Pérez, Gangnet and Blake 2003 ("Poisson Image Editing",
// Eqs. 3, 7 and 12): fills a region so that its differences follow wanted gradients and its border
// follows the surrounding pixels.
#pragma once

#include <cstdint>
#include <vector>

#include "base/params.h"

namespace parian {

struct PoissonParams {
  double tolerance = 1e-6;   // on the norm of the residual, relative to that of the target itself
  int max_iterations = 100;  // of conjugate gradients; about 5 reach 1e-6, about 10 reach 1e-10
};
ParamList describe(PoissonParams& params);

struct PoissonReport {
  int iterations = 0;
  // Largest over the planes of |b - A f| / |b - A target|, of the returned values; 0 where the
  // target already solves the equations to rounding.
  double relative_residual = 0;
  // Components of the region without a neighbour outside: on a grid 1 where the region is the
  // whole image, otherwise 0.
  int free_components = 0;
};

// Solves Δf = div v in `region` (non-zero: inside; [y][x]) with f = target on the pixels outside
// that touch it, by the 5-point formula; neighbours beyond the image border drop out (Neumann).
// Planes are [plane][y][x]. gradient_x is the wanted f(x+1, y) - f(x, y) (last column ignored),
// gradient_y the wanted f(x, y+1) - f(x, y) (last row ignored). A region that is the whole image
// leaves a constant open: every plane then keeps the mean of the target. Outside the region the
// result is the target bit for bit. The same bits for any number of threads.
// If max_iterations do not suffice the best result is returned: see the report.
// Throws Error for bad params, and naming plane and pixel of a value in reach (target in the region
// or touching it, gradients of differences with an end in the region) that is not finite or larger
// than 1e300.
std::vector<double> solve_poisson(int width, int height, int planes,
                                  const std::vector<std::uint8_t>& region,
                                  const std::vector<double>& target,
                                  const std::vector<double>& gradient_x,
                                  const std::vector<double>& gradient_y,
                                  const PoissonParams& params, PoissonReport* report = nullptr);

// Forward differences of every plane, 0 in the last column and row (Eq. 9 of the paper).
void make_gradients(int width, int height, int planes, const std::vector<double>& values,
                    std::vector<double>& gradient_x, std::vector<double>& gradient_y);

// Mixed gradients (Eq. 12 of the paper): each difference of the source is replaced by that of the
// target where the latter is larger in magnitude.
void mix_gradients(const std::vector<double>& target_x, const std::vector<double>& target_y,
                   std::vector<double>& gradient_x, std::vector<double>& gradient_y);

}  // namespace parian

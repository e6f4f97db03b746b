// Kernels and pair-by-pair products behind hessian.h. Private to fit.
#pragma once

#include <vector>

#include "fit/hessian.h"

namespace parian {

// lambda^2 L^T L, L the second differences over knots, and the slope weights' part: a symmetric
// pentadiagonal matrix.
struct CurvatureBands {
  std::vector<double> main, first, second;
};
CurvatureBands curvature_bands(const ReducedSystem& system);

// One knot's row of D + lambda^2 L^T L; use_* are 0 where a neighbour does not exist.
struct LocalRow {
  double c0 = 0, up = 0, down = 0, up2 = 0, down2 = 0, use_up = 0, use_down = 0;
};
void add_local_row(const LocalRow& row, const float* diagonal, const float* coupling_up,
                   const float* coupling_down, const float* here, const float* up,
                   const float* down, const float* up2, const float* down2, float* out,
                   std::size_t count);
void add_local_row(const LocalRow& row, const double* diagonal, const double* coupling_up,
                   const double* coupling_down, const double* here, const double* up,
                   const double* down, const double* up2, const double* down2, double* out,
                   std::size_t count);

// here <- diagonal here + up above + down previous (spectra, real factors); previous <- old
// here.
void multiply_block(float* here, const float* above, float* previous, const float* diagonal,
                    const float* up, const float* down, double use_up, double use_down,
                    std::size_t count);
void multiply_block(double* here, const double* above, double* previous, const double* diagonal,
                    const double* up, const double* down, double use_up, double use_down,
                    std::size_t count);

// out += sum over pairs of W (Q(x) + Q(x + d)) spread to both ends, pair by pair.
void add_pairs(const ReducedSystem& system, const float* p, float* out);
void add_pairs(const ReducedSystem& system, const double* p, double* out);
// out += the regulariser's part of H p.
void add_curvature(const ReducedSystem& system, const float* p, float* out);
void add_curvature(const ReducedSystem& system, const double* p, double* out);
bool has_missing(const ReducedSystem& system);
// out -= the same over the listed missing pairs.
void subtract_missing(const ReducedSystem& system, const float* p, float* out);
void subtract_missing(const ReducedSystem& system, const double* p, double* out);

}  // namespace parian

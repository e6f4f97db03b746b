// Vectorised vector operations of the solver, for one block each. Private to fit.
#pragma once

#include <cstddef>

namespace parian {

// Inner products that a step of conjugate gradients needs.
struct StepSums {
  double d_hd = 0, r_hd = 0, hd_hd = 0;
};
void step_sums_block(const float* d, const float* hd, const float* r, StepSums* sums,
                     std::size_t count);  // adds

double dot_block(const float* a, const float* b, std::size_t count);
double dot_mixed_block(const double* a, const float* b, std::size_t count);
void sums_block(const double* values, std::size_t count, double* sum, double* squares);

// x += alpha d; r -= alpha hd; returns |r|^2
double step_block(float alpha, const float* d, const float* hd, float* x, float* r,
                  std::size_t count);
// d = z + beta d
void direction_block(float beta, const float* z, float* d, std::size_t count);

// g -= b; returns m (g before / 2 - b)
double subtract_block(double m, const double* b, double* g, std::size_t count);
// x *= factor; r = -g - factor hx; without a factor neither x nor hx is read.
void start_block(float factor, const double* g, const float* hx, float* x, float* r,
                 std::size_t count);
// p = m + x; hx = -g - r; returns x (g - r)
double finish_block(double m, const double* g, const float* x, const float* r, float* hx, double* p,
                    std::size_t count);

}  // namespace parian

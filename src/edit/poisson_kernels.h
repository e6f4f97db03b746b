// Row kernels of the Poisson solver. Rows are padded with zeros to a multiple of row_align numbers
// and have at least one zero before and after, so that no kernel treats borders.
#pragma once

#include <cstddef>

namespace parian {

constexpr int row_align = 8;

// Planes interleaved by rows, [y][plane][x], with row_align zeros before each row and one row of
// zeros above and below.
struct GridShape {
  int width = 0, height = 0, planes = 1;

  int count() const { return (width + row_align - 1) / row_align * row_align; }
  std::size_t row(int y, int plane = 0) const {
    const auto index = static_cast<std::size_t>(y + 1) * static_cast<std::size_t>(planes) +
                       static_cast<std::size_t>(plane);
    return index * static_cast<std::size_t>(count() + row_align) + row_align;
  }
  std::size_t size() const { return row(height + 1); }
  GridShape with(int plane_count) const { return {width, height, plane_count}; }
};

// Half of a symmetric 9-point stencil at one row of pixels and the row above: couplings to itself,
// to the right, down, down-right and down-left.
struct StencilRows {
  const float *self, *right, *down, *down_right, *down_left;
  const float *up_down, *up_down_right, *up_down_left;  // of the row above
};

// out = keep x + omega scale (b - A x) for the 5-point graph Laplacian (couplings -1 to all
// neighbours; x is 0 outside the region) and for a general stencil.
void sweep_laplacian(const float* self, const float* scale, const float* b, const float* x,
                     const float* up, const float* down, float omega, float keep, int count,
                     float* out);
void sweep_stencil(const StencilRows& a, const float* scale, const float* b, const float* x,
                   const float* up, const float* down, float omega, float keep, int count,
                   float* out);
// out = omega scale b
void scale_row(const float* scale, const float* b, float omega, int count, float* out);

// Bilinear transfer, weights 1/2 1 1/2: coarse pixel i lies on fine pixel 2i, and a last fine pixel
// without a coarse one beyond it follows the coarse pixel before it (Neumann).
// coarse = mask Pᵀ(last, here, next): the fine rows around a coarse row, next times next_weight.
void restrict_rows(const float* last, const float* here, const float* next, float next_weight,
                   const float* mask, int fine_width, int coarse_width, float* work, float* coarse);
// fine += mask P(1/2 (a + b)).
void prolong_row(const float* a, const float* b, const float* mask, int fine_width,
                 int coarse_width, float* work, float* fine);

// Rows of an image around the row y, of `width` pixels without padding. At the image border
// `up` or `down` is the row itself, with a gradient of zeros.
struct ResidualRows {
  const double *f, *up, *down;
  const double *gradient_x, *gradient_y, *gradient_y_up;
};
// out = scale Σ_q (f_q - f - v_q) over the neighbours q where mask is not 0, else 0.
void find_residual_row(const ResidualRows& rows, const double* mask, double scale, int width,
                       double* out);
// The largest |value| where mask is not 0; 0 where there is none.
double max_row(const double* values, const double* mask, int width);
// values += scale e where mask is not 0.
void add_row(const double* e, const double* mask, double scale, int width, double* values);
double square_row(const double* values, int count);

// q = mask (self p - neighbours); returns p·q.
double apply_laplacian(const double* self, const double* mask, const double* p, const double* up,
                       const double* down, int count, double* q);
// e += alpha p, r -= alpha q, b = float(r); returns r·r.
double step_row(const double* p, const double* q, double alpha, int count, double* e, double* r,
                float* b);
double dot_row(const double* r, const float* z, int count);
// p = z + beta p
void turn_row(const float* z, double beta, int count, double* p);

}  // namespace parian

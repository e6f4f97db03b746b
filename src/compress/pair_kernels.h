// Sums over rings of equal offset length, and what is made of them, row by row.
#pragma once

#include <cstddef>

namespace parian {

inline constexpr std::size_t ring_block = 32;  // rows are padded to whole blocks

// out[x] = sum over shifts of plane[x + shift], for x < width rounded up to ring_block.
void sum_ring(const float* plane, const std::ptrdiff_t* shifts, std::size_t count, float* out,
              std::size_t width);

// exp of 1/2 ((1 - fraction) a + fraction b): the square root of a profile between two knots.
void eval_root_profile(const float* a, const float* b, float fraction, float* out,
                       std::size_t count);

// The products whose ring sums the gradient needs, of one row: g is the model's root profile, s the
// target's, d = g - s.
struct PairPlanes {
  float* g;
  float* dd;
  float* ds;
  float* ss;
  float* wdd;
  float* wds;
  float* wss;
  float* ag;
};
inline constexpr std::size_t pair_planes = 8;
void fill_pair_planes(const float* g, const float* s, const float* weight, const float* albedo,
                      std::size_t count, const PairPlanes& out);

// From ring sums of the planes above, in their order: dF / d ln P_x(r) and the pixel's part of
// sum_y (R' - R)^2, which is added to `error`.
void combine_ring(const float* g, const float* s, const float* weight, const float* albedo,
                  const float* const* sums, std::size_t count, float* gradient, float* error);

// One row of pairs (x, y) of a table: with m = share (R* - R), 0 where R is NaN, -m goes to the
// albedo and m (R* - R) to the squares of both ends (null: of x only), and (w_x + w_y) trust m
// R*, the derivative by either end's ln P, to `linear`. `miss` is work space.
void add_residual(const float* table, const float* model, const float* trust, const float* weight_x,
                  const float* weight_y, float share, std::size_t count, float* albedo_x,
                  float* albedo_y, float* squared_x, float* squared_y, float* linear_x,
                  float* linear_y, float* miss);

// to += factor from
void add_scaled(const float* from, float factor, float* to, std::size_t count);

}  // namespace parian

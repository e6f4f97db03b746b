// The hot loops of single scattering's transport: lookups of a path's points in depth maps, and
// sums over the basis functions. Internal to transport.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/spline_basis.h"
#include "transport/depth_layers.h"

namespace parian {

inline constexpr std::size_t max_path_samples = 256;

// The lit points of a path.
struct LitPath {
  std::size_t count = 0;
  float length[max_path_samples];     // s_i' + s
  float source[max_path_samples][4];  // F_t (1, w_i') times the node's weight
};

// A path in a map's space: place in texels and depth at s = 0, and their change per mm.
struct MapPath {
  float x = 0, y = 0, z = 0, dx = 0, dy = 0, dz = 0;
};

// Points up to a texel outside the layers count as inside.
void look_up_path(const DepthTexel* texels, int width, int height, float bias, const MapPath& path,
                  const float* s, const float* weight, std::size_t nodes, LitPath* lit);

// A basis as polynomials of the intervals, which are found through a table over equal bins.
struct BasisTable {
  int degree = 1;
  std::size_t intervals = 0;
  float bins_per_mm = 0;
  std::vector<std::uint16_t> first;  // of the bin's start
  std::vector<float> knots;          // [intervals + 1]
  std::vector<float> inverse;        // 1 / length of the intervals
  std::vector<float> coefficients;   // [interval][3 functions][3 powers]
};
BasisTable make_basis_table(const SplineBasis& basis);

// value[function][4][3] += colour[3] sum_i B_j(length_i) source_i. `sums` is scratch,
// [functions][4], 0 before and after.
struct BasisView {
  int degree = 1;
  std::size_t intervals = 0;
  float bins_per_mm = 0;
  std::size_t bins = 0;
  const std::uint16_t* first = nullptr;
  const float* knots = nullptr;
  const float* inverse = nullptr;
  const float* coefficients = nullptr;
};
BasisView view_of(const BasisTable& table);
void deposit_path(const BasisView& basis, const LitPath& lit, const float* colour, float* sums,
                  float* value);

}  // namespace parian

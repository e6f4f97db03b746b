// Least squares with coefficients >= 0. Internal to this folder.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace parian {

template <std::size_t N>
using Coefficients = std::array<double, N>;

// Coordinate descent on |A c - b|^2, c >= 0, given A^T A and A^T b.
template <std::size_t N>
Coefficients<N> solve_positive(const std::array<Coefficients<N>, N>& normal,
                               const Coefficients<N>& right) {
  constexpr int sweeps = 20000;
  Coefficients<N> c{};
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t k = 0; k < N; ++k) {
      double residual = right[k];
      for (std::size_t l = 0; l < N; ++l) residual -= normal[k][l] * c[l];
      if (normal[k][k] > 0) c[k] = std::max(0.0, c[k] + residual / normal[k][k]);
    }
  return c;
}

}  // namespace parian

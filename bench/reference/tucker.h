// Tucker factorisation of the tensor R'[y][x][d], one per channel (after Kurt, Ozturk and Peers
// 2013): a core of r_y r_x r_d numbers and a basis for rows, for columns and for offsets.
#pragma once

#include <array>
#include <cstdint>

#include "bench/reference/offset_matrix.h"
#include "bench/reference/rival.h"

namespace parian {

// By rows: [a][b][c], c fastest.
struct Tensor {
  std::array<std::size_t, 3> size{};
  AlignedVector<float> values;
};

struct TuckerModel {
  std::array<AlignedVector<float>, 3> basis;  // [axis][size][rank], orthonormal columns
  Tensor core;                                // sizes are the ranks
  double captured = 0;                        // |core|^2
  std::vector<double> history;                // |core|^2 before the first and after each sweep
};

std::size_t tucker_floats(const std::array<std::size_t, 3>& size,
                          const std::array<std::size_t, 3>& rank);

// The ranks that keep most energy of the core of full rank (HOSVD) in at most `floats` numbers;
// zeros if none fit. `last_size` is what a basis column of the last axis costs. `energy` may be
// null.
std::array<std::size_t, 3> choose_tucker_ranks(const Tensor& full_core, std::size_t last_size,
                                               std::size_t floats, double* energy);

// Truncated higher-order SVD, then `sweeps` of higher-order orthogonal iteration (De Lathauwer et
// al. 2000): |core|^2 does not fall, so |T - model|^2 = |T|^2 - |core|^2 does not rise.
TuckerModel factor_tucker(const Tensor& tensor, const std::array<std::size_t, 3>& rank, int sweeps);

// At most `bytes`, 4 (H r_y + W r_x + D r_d + r_y r_x r_d) per channel; channels share them so that
// most energy is kept. Offsets are compressed to a space of at most 96 dimensions first.
Rival compress_tucker(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed = 1);

}  // namespace parian

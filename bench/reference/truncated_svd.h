// Truncated singular value decomposition of R'(x, d), one matrix per channel: the best model of a
// rank in the least-squares sense.
#pragma once

#include <cstdint>

#include "bench/reference/offset_matrix.h"
#include "bench/reference/rival.h"

namespace parian {

struct SvdParams {
  int rounds = 8;          // subspace iterations, each after filling in what is missing
  std::size_t extra = 8;   // columns beyond the rank, dropped at the end
  std::uint64_t seed = 1;  // of the random start (Halko, Martinsson, Tropp 2011)
};

// left = U S by falling singular values, right = V; the rank is at most min(rows, columns). Missing
// values are filled in from the model of this rank between iterations. `singular` may be null.
Factors factor_svd(OffsetMatrix& matrix, std::size_t rank, const SvdParams& params,
                   std::vector<double>* singular = nullptr);

// The first `rank` terms.
Factors truncate(const Factors& factors, std::size_t rank);

// Ranks per channel by the largest singular values of all; 4 r (N + D) bytes per channel.
Rival compress_truncated_svd(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed = 1);

}  // namespace parian

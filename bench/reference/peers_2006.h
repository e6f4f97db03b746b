// The factored representation of Peers et al. 2006: what is left of R'(x, d) after division by the
// mean decay h(|d|) is a sum of K products of non-negative functions of x and of d,
//
//   R(x, x + d) = h(|d|) sum_k u_k(x) v_k(d),
//
// with squared errors weighted by h^2 so that they count in R, and missing pairs by 0.
#pragma once

#include <cstdint>

#include "bench/reference/offset_matrix.h"
#include "bench/reference/rival.h"

namespace parian {

struct PeersParams {
  std::size_t rank = 1;  // K, at most min(pixels, offsets)
  int iterations = 60;
  double tolerance = 1e-4;  // stops when an iteration lowers the objective by less than this part
  int sweeps = 4;           // over the unknowns of one side per product with the matrix
  std::uint64_t seed = 1;   // of the pixels whose responses start v
};

struct PeersChannel {
  std::vector<int> radius2;       // |d|^2 in pixels, ascending
  std::vector<float> mean_decay;  // h, geometric mean over the pairs at that distance
  Factors factors;                // u, and h v
  std::vector<double> objective;  // sum over measured pairs of (R - R~)^2 after each iteration
};

// With Omega = h^2 the weighted problem for u, v is the plain one for u, h v: multiplicative
// updates are the same in both. Here each unknown is set to its exact minimum in turn (Cichocki and
// Phan 2009), which takes a fraction of the iterations of multiplicative updates.
PeersChannel factor_peers_2006(OffsetMatrix& matrix, const PeersParams& params);

// 4 (N K + D K + distances) bytes per channel.
std::size_t peers_2006_bytes(const PeersChannel& channel);

// How a symmetric table is factored.
enum class PeersForm {
  plain,        // d over the whole plane: R~(x, y) and R~(y, x) differ
  symmetrised,  // the same factors, but their mean: never a larger L2 error at the same bytes
  half_plane,   // each pair once: half the columns, so that the same bytes go further
};
Rival compress_peers_2006(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed = 1,
                          PeersForm form = PeersForm::half_plane);

}  // namespace parian

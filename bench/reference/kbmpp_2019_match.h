// The second step of a round in the 2019 paper: pixels copy the parameter set (indices and
// weights) of a neighbour or of a random pixel where that lowers E_LS.
#pragma once

#include <cstddef>
#include <cstdint>

#include "bench/reference/kbmpp_2019_pairs.h"

namespace parian::kbmpp {

struct SweepParams {
  int iteration = 0;       // even: left and upper neighbours; odd: right and lower
  double probability = 1;  // with which an improvement is taken
  int random_candidates = 1;
  std::uint64_t seed = 1;
};

// Which offsets of a pixel are measured, in tables with holes: bit c of [y][x][2 plane + side] is
// set for the pair (x, x + d), side 0, or (x - d, x), side 1. Empty for complete tables.
std::vector<std::uint8_t> make_pair_mask(const Pairs& pairs);

// One sweep over all pixels, each judged at the current state of the others. `work` holds the
// evaluation of `model` and is kept up to date but for gradients by bases and weights. Pixels are
// visited in scan order within square tiles as wide as the pairs reach, tiles of one of four
// colours at a time: tiles of one colour do not meet, so they run side by side. Random candidates
// come from the state before the sweep. Returns the number of copies.
std::size_t sweep(const Pairs& pairs, const std::vector<std::uint8_t>& mask,
                  const SweepParams& params, Model& model, Workspace& work);

}  // namespace parian::kbmpp

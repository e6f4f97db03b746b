// Rigorous bounds of what emitters contribute to a block of targets, and refining them.
#pragma once

#include <cstdint>
#include <vector>

#include "transport/gather_blocks.h"

namespace parian {

// [channel][lane] each; lower <= exact sum <= upper, rounding of the exact sum included.
struct Bracket {
  BlockSums estimate{}, lower{}, upper{};
};

void add(Bracket& sum, const Bracket& part, double sign = 1);

// Of several nodes: out[i] for node nodes[i].
void bracket_nodes(const MomentSources& sources, const KnotLookup& lookup,
                   const std::vector<std::uint32_t>& nodes, const TargetBlock& block,
                   std::vector<Bracket>& out);

// Largest relative half-width over the block's targets and channels, each target's own in
// half_width[lane]: max(upper - estimate, estimate - lower) / estimate of the far sums, where
// `fixed` is the part of the exitance that is exact.
double half_widths(const Bracket& sum, const BlockSums& fixed, int count, double* half_width);

// Starts from `nodes` and opens the node with the widest bracket until every target's relative
// half-width is at most `tolerance`; samples met on the way go to `exact`. Returns the bracket of
// all that is left as nodes and of the samples that opened nodes had; visited counts evaluations.
Bracket refine(const MomentSources& sources, const KnotLookup& lookup,
               const std::vector<std::uint32_t>& nodes, const TargetBlock& block,
               const BlockSums& fixed, double tolerance, std::size_t& evaluations);

}  // namespace parian

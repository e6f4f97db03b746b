// What both gathers share: running over blocks of targets, and summing emitters for one.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

#include "transport/moments.h"

namespace parian {

// [channel][lane]
using BlockSums = std::array<double, 3 * lanes>;

// Emitters that a block needs: `far` plainly, `near` (samples only) by the near term.
struct EmitterLists {
  std::vector<std::uint32_t> far, near;
};

// sums += what the far emitters contribute.
void add_far(const EmitterView& emitters, const KnotView& lookup,
             const std::vector<std::uint32_t>& ids, const TargetBlock& block, BlockSums& sums);

// Appends a leaf's samples.
void list_samples(const SourceNode& leaf, bool near, EmitterLists& lists);

// exitance[target] = the block's sums.
void store_sums(const TargetBlock& block, const BlockSums& sums, std::vector<Rgb>& exitance);

// Neighbouring blocks that share the first part of their walk through the tree.
inline constexpr std::size_t group_size = 8;

// Calls body(blocks, count, index of the first) for all groups of blocks, in parallel, and reports
// progress. Every group but the last has group_size blocks.
void for_each_group(const ProfileField& field, const std::vector<GatherPoint>& targets,
                    const Progress& progress, std::string_view stage,
                    const std::function<void(const TargetBlock* blocks, std::size_t count,
                                             std::size_t first)>& body);

}  // namespace parian

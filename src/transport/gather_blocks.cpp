#include "transport/gather_blocks.h"

#include <algorithm>

#include "base/parallel.h"
#include "math/fast_math.h"

namespace parian {

void add_far(const EmitterView& emitters, const KnotView& lookup,
             const std::vector<std::uint32_t>& ids, const TargetBlock& block, BlockSums& sums) {
  const BlockView targets = view(block);
  alignas(64) std::array<float, gather_chunk * lanes> r;
  alignas(64) std::array<float, gather_chunk * 3 * lanes> value;
  for (std::size_t begin = 0; begin < ids.size(); begin += gather_chunk) {
    const std::size_t count = std::min(gather_chunk, ids.size() - begin);
    eval_distances(emitters, &ids[begin], count, targets, r.data());
    eval_logs(emitters, lookup, &ids[begin], count, targets, r.data(), NodeExtent::second_order,
              value.data());
    exp_array(value.data(), value.data(), count * 3 * lanes);
    alignas(64) std::array<float, 3 * lanes> partial{};
    add_values(value.data(), count, partial.data());
    for (std::size_t j = 0; j < sums.size(); ++j) sums[j] += static_cast<double>(partial[j]);
  }
}

void list_samples(const SourceNode& leaf, bool near, EmitterLists& lists) {
  std::vector<std::uint32_t>& list = near ? lists.near : lists.far;
  for (std::uint32_t i = leaf.begin; i < leaf.end; ++i) list.push_back(i);
}

void store_sums(const TargetBlock& block, const BlockSums& sums, std::vector<Rgb>& exitance) {
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(block.count); ++lane)
    exitance[block.index[lane]] = {static_cast<float>(sums[lane]),
                                   static_cast<float>(sums[lanes + lane]),
                                   static_cast<float>(sums[2 * lanes + lane])};
}

void for_each_group(const ProfileField& field, const std::vector<GatherPoint>& targets,
                    const Progress& progress, std::string_view stage,
                    const std::function<void(const TargetBlock*, std::size_t, std::size_t)>& body) {
  const std::vector<std::uint32_t> order = order_targets(targets);
  const std::size_t blocks = (targets.size() + lanes - 1) / lanes;
  const std::size_t groups = (blocks + group_size - 1) / group_size;
  const std::size_t step = std::max<std::size_t>(32, groups / 64);
  for (std::size_t first = 0; first < groups; first += step) {
    advance_progress(progress, stage, static_cast<double>(first) / static_cast<double>(groups));
    parallel_for(std::min(step, groups - first), [&](std::size_t i) {
      const std::size_t begin = (first + i) * group_size;
      const std::size_t count = std::min(group_size, blocks - begin);
      std::array<TargetBlock, group_size> group;
      for (std::size_t b = 0; b < count; ++b)
        fill_block(field, targets, order, (begin + b) * lanes, group[b]);
      body(group.data(), count, begin);
    });
  }
  advance_progress(progress, stage, 1);
}

}  // namespace parian

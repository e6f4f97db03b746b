#include "transport/gather.h"

#include <cmath>

#include "base/check.h"
#include "transport/gather_blocks.h"

namespace parian {
namespace {

// All samples whose leaf lies within the block's range.
void list_in_range(const SourceTree& tree, const TargetBlock& block, double near_mm,
                   EmitterLists& lists) {
  lists.far.clear();
  lists.near.clear();
  const double reach = std::max(near_mm, static_cast<double>(block.max_support));
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const SourceNode& node = tree.nodes[stack.back()];
    stack.pop_back();
    const auto gap = static_cast<double>(box_distance(node.box, block.box));
    if (gap > reach) continue;
    if (node.left == 0) {
      list_samples(node, gap < near_mm, lists);
    } else {
      stack.push_back(node.right);
      stack.push_back(node.left);
    }
  }
}

}  // namespace

double default_near_mm(double area_mm2) {
  return 3.5 * std::sqrt(area_mm2);
}

std::vector<Rgb> gather_brute(const ProfileField& field, const GatherSources& sources,
                              const std::vector<GatherPoint>& targets, double near_mm,
                              const Progress& progress) {
  PARIAN_CHECK_EQ(sources.points.size(), sources.flux.size());
  std::vector<Rgb> exitance(targets.size());
  if (sources.points.empty()) return exitance;
  const MomentSources tree = make_moment_sources(field, sources, /*with_nodes=*/false);
  const KnotLookup lookup = make_knot_lookup(field.knots_mm);
  const EmitterView emitters = view(tree.emitters);
  const auto gather_block = [&](const TargetBlock& block) {
    EmitterLists lists;
    list_in_range(tree.tree, block, near_mm, lists);
    BlockSums sums{};
    add_far(emitters, view(lookup), lists.far, block, sums);
    if (near_mm > 0)
      add_near(emitters, view(lookup), tree.samples, lists.near, block, field.knots_mm, near_mm,
               sums.data());
    store_sums(block, sums, exitance);
  };
  for_each_group(field, targets, progress, "gather",
                 [&](const TargetBlock* blocks, std::size_t count, std::size_t) {
                   for (std::size_t b = 0; b < count; ++b) gather_block(blocks[b]);
                 });
  return exitance;
}

}  // namespace parian

#include "transport/target_block.h"

#include <algorithm>
#include <numeric>

namespace parian {
namespace {

// Halves [begin, end) at a multiple of `lanes` until pieces fit into a block.
void split(const std::vector<GatherPoint>& targets, std::uint32_t* begin, std::uint32_t* end) {
  const auto count = static_cast<std::size_t>(end - begin);
  if (count <= static_cast<std::size_t>(lanes)) return;
  Bounds3 box;
  for (const std::uint32_t* i = begin; i != end; ++i) extend(box, targets[*i].position);
  const int axis = longest_axis(box);
  const std::size_t blocks = (count + lanes - 1) / lanes;
  std::uint32_t* middle = begin + static_cast<std::ptrdiff_t>(blocks / 2 * lanes);
  std::nth_element(begin, middle, end, [&](std::uint32_t a, std::uint32_t b) {
    const float u = component(targets[a].position, axis), v = component(targets[b].position, axis);
    return u < v || (u == v && a < b);
  });
  split(targets, begin, middle);
  split(targets, middle, end);
}

}  // namespace

std::vector<std::uint32_t> order_targets(const std::vector<GatherPoint>& targets) {
  std::vector<std::uint32_t> order(targets.size());
  std::iota(order.begin(), order.end(), 0u);
  split(targets, order.data(), order.data() + order.size());
  return order;
}

void fill_block(const ProfileField& field, const std::vector<GatherPoint>& targets,
                const std::vector<std::uint32_t>& order, std::size_t first, TargetBlock& block) {
  block.count = static_cast<int>(std::min<std::size_t>(lanes, order.size() - first));
  block.half_log.resize(field.row() * lanes);
  block.box = {};
  block.max_support = 0;
  std::vector<float> row(field.row());
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const std::size_t used = std::min(lane, static_cast<std::size_t>(block.count) - 1);
    block.index[lane] = order[first + used];
    const GatherPoint& target = targets[block.index[lane]];
    block.x[lane] = target.position.x;
    block.y[lane] = target.position.y;
    block.z[lane] = target.position.z;
    block.normal[lane] = target.normal;
    extend(block.box, target.position);
    float support[3];
    field.eval(static_cast<double>(target.x), static_cast<double>(target.y), row.data(), support);
    for (std::size_t c = 0; c < 3; ++c) {
      block.support[c][lane] = support[c];
      block.max_support = std::max(block.max_support, support[c]);
    }
    for (std::size_t at = 0; at < row.size(); ++at) block.half_log[at * lanes + lane] = row[at];
  }
}

}  // namespace parian

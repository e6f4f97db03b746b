#include "transport/source_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace parian {
namespace {

constexpr std::uint32_t leaf_size = 8;

// Makes the node of [begin, end) and those below it; returns its index.
std::uint32_t build(const GatherSources& sources, SourceTree& tree, std::uint32_t begin,
                    std::uint32_t end) {
  const auto index = static_cast<std::uint32_t>(tree.nodes.size());
  SourceNode node;
  node.begin = begin;
  node.end = end;
  for (std::uint32_t i = begin; i < end; ++i)
    extend(node.box, sources.points[tree.order[i]].position);
  tree.nodes.push_back(node);
  if (end - begin <= leaf_size) return index;
  const int axis = longest_axis(node.box);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(tree.order.begin() + begin, tree.order.begin() + middle,
                   tree.order.begin() + end, [&](std::uint32_t a, std::uint32_t b) {
                     const float u = component(sources.points[a].position, axis);
                     const float v = component(sources.points[b].position, axis);
                     return u < v || (u == v && a < b);
                   });
  const std::uint32_t left = build(sources, tree, begin, middle);
  const std::uint32_t right = build(sources, tree, middle, end);
  tree.nodes[index].left = left;
  tree.nodes[index].right = right;
  return index;
}

float outside(float low, float high, float value) {
  return std::max({low - value, value - high, 0.0f});
}

}  // namespace

SourceTree make_source_tree(const GatherSources& sources) {
  SourceTree tree;
  tree.order.resize(sources.points.size());
  std::iota(tree.order.begin(), tree.order.end(), 0u);
  if (!tree.order.empty()) build(sources, tree, 0, static_cast<std::uint32_t>(tree.order.size()));
  return tree;
}

float box_distance(const Bounds3& a, const Bounds3& b) {
  const auto gap = [](float a0, float a1, float b0, float b1) {
    return std::max({b0 - a1, a0 - b1, 0.0f});
  };
  return length({gap(a.lower.x, a.upper.x, b.lower.x, b.upper.x),
                 gap(a.lower.y, a.upper.y, b.lower.y, b.upper.y),
                 gap(a.lower.z, a.upper.z, b.lower.z, b.upper.z)});
}

float min_distance(const Bounds3& box, Vec3 point) {
  return length({outside(box.lower.x, box.upper.x, point.x),
                 outside(box.lower.y, box.upper.y, point.y),
                 outside(box.lower.z, box.upper.z, point.z)});
}

float max_distance(const Bounds3& box, Vec3 point) {
  return length(max(point - box.lower, box.upper - point));
}

}  // namespace parian

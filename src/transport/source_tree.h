// The hierarchy over the samples of a gather: a binary tree of boxes with at most eight samples in
// a leaf. It knows positions and supports; moments.h adds what nodes emit.
#pragma once

#include <cstdint>
#include <vector>

#include "transport/gather.h"

namespace parian {

struct SourceNode {
  Bounds3 box;
  std::uint32_t begin = 0, end = 0;   // of the samples in the tree's order
  std::uint32_t left = 0, right = 0;  // children, 0: a leaf
};

struct SourceTree {
  std::vector<SourceNode> nodes;     // root first, children after their parents
  std::vector<std::uint32_t> order;  // of the samples: indices into the sources
};
SourceTree make_source_tree(const GatherSources& sources);

// Distances between points of two boxes (0 where they overlap).
float box_distance(const Bounds3& a, const Bounds3& b);
// Nearest and farthest distance from a point to a box.
float min_distance(const Bounds3& box, Vec3 point);
float max_distance(const Bounds3& box, Vec3 point);

}  // namespace parian

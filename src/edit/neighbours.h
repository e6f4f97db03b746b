// The graph along which strokes propagate (after AppWand, Pellacini and Lawrence 2007): each pixel
// is joined to the pixels that look most like it, wherever they are, and to its four neighbours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/params.h"
#include "edit/features.h"

namespace parian {

struct GraphParams {
  int neighbours = 16;  // k, in appearance
};
ParamList describe(GraphParams& params);

// Symmetric, without loops. Nodes are the pixels in order of appearance, so that what is alike lies
// together in memory; rows are in order of `to`. Squared distances of features are stored, not
// weights, so that the range of appearance can change without building the graph anew.
struct NeighbourGraph {
  int width = 0;
  int height = 0;
  int neighbours = 0;                 // k
  std::vector<std::uint32_t> pixel;   // of each node: y * width + x
  std::vector<std::uint32_t> node;    // of each pixel
  std::vector<std::size_t> first;     // row of node i: [first[i], first[i + 1])
  std::vector<std::uint32_t> to;      // the other node
  std::vector<float> distance2;       // of the features
  std::vector<std::uint8_t> spatial;  // 1: neighbours in the image, not in appearance
  // Groups of nodes of like appearance and nearly equal size, for the solver's coarse level: group
  // g has nodes [group_first[g], group_first[g + 1]).
  std::vector<std::size_t> group_first;

  std::size_t pixels() const { return pixel.size(); }
  std::size_t groups() const { return group_first.empty() ? 0 : group_first.size() - 1; }
};

// Exact k nearest neighbours (k-d tree) of the features plus a pseudo-random jitter of at most
// 1e-5 that depends on the pixel's index: it settles ties, so that thousands of equal pixels are
// joined at random rather than all to the same k. Made symmetric by union.
NeighbourGraph make_neighbour_graph(const Features& features, const GraphParams& params = {});

}  // namespace parian

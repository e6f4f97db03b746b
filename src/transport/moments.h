// What the nodes of a source tree emit: their moments (moment_tree.h), as emitters after the
// samples.
#pragma once

#include <vector>

#include "transport/emitters.h"
#include "transport/near_term.h"
#include "transport/source_tree.h"

namespace parian {

// Per node, beside its emitter.
struct NodeShape {
  float spread_mm = 0;  // root mean square distance of the samples to the centroid, by flux
  float min_support[3] = {0, 0, 0};  // mm, of the samples per channel: nearer nothing is cut,
  float max_support[3] = {0, 0, 0};  // and beyond there is nothing
};

struct MomentSources {
  SourceTree tree;
  Emitters emitters;    // samples in the tree's order, then one for each node, at its centroid
  NearSamples samples;  // the same samples
  std::vector<NodeShape> shapes;
  // For bounds: each emitter's row as if no sample ended; and the slopes of the nodes' just beyond
  // each knot, [node][knot][channel], or one for all where the emitters share a row.
  std::vector<std::uint32_t> whole_row;
  AlignedVector<float> slopes;
};
// `with_nodes` false: samples alone, for brute force.
MomentSources make_moment_sources(const ProfileField& field, const GatherSources& sources,
                                  bool with_nodes);

inline std::uint32_t emitter_of(const MomentSources& sources, std::uint32_t node) {
  return static_cast<std::uint32_t>(sources.tree.order.size()) + node;
}

}  // namespace parian

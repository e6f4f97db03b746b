// What radial_moments.h keeps of the nodes of a source tree: flux, centroids and covariance.
#pragma once

#include <array>
#include <vector>

#include "base/aligned.h"
#include "transport/radial_moments_kernels.h"
#include "transport/source_tree.h"

namespace parian {

struct RadialNodes {
  SourceTree tree;
  std::array<std::vector<float>, node_fields> field;  // as find_node_distances wants them
  AlignedVector<Flux> flux;
  AlignedVector<ChannelOffsets> offset;
  std::vector<float> diameter_mm;  // of the node's box
};
// Centroid and covariance are weighted by the sum of the channels' flux, which is >= 0.
RadialNodes make_radial_nodes(const GatherSources& sources);

}  // namespace parian

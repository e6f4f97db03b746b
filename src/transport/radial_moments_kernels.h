// The inner loops of radial_moments.cpp: distances of a list of emitters to a target, side by side,
// and their flux sorted into the intervals of a basis.
#pragma once

#include <cstddef>

#include "transport/interval_table.h"

namespace parian {

// Four floats in a register: the channels' flux, and what a caller keeps beside it.
using Flux = float __attribute__((vector_size(16)));

// Fields of a node by component: centroid x y z, covariance xx yy zz xy yz zx, in mm.
inline constexpr std::size_t node_fields = 9;
// Offsets of the channels' centroids from it.
struct ChannelOffsets {
  Flux x{}, y{}, z{};
};

// Places in a basis: interval, and t in [0, 1] within it; beyond the reach the interval is the
// number of pieces, one more than there are.
struct Places {
  float* distance = nullptr;
  int* interval = nullptr;
  float* t = nullptr;
};
void find_places(const IntervalTable* table, std::size_t count, const Places* places);

// What a target sees of a node: two distances (places to be found), the direction, and half the
// inverse of their spread.
struct NodeView {
  float *near_mm = nullptr, *far_mm = nullptr;
  float *x = nullptr, *y = nullptr, *z = nullptr;
  float* half_inverse_spread = nullptr;
};
// field[f][node]
void find_node_distances(const float* const* field, std::size_t count, const float* target,
                         const NodeView* view);
// position[axis][sample]
void find_sample_distances(const float* const* position, std::size_t count, const float* target,
                           float* distance_mm);

// sum[interval][power] += t^power flux. Near and far points have sums of their own, so that neither
// waits for the other.
void add_nodes(const NodeView* view, const Places* near, const Places* far,
               const ChannelOffsets* offset, const Flux* flux, std::size_t count, int degree,
               Flux (*near_sum)[3], Flux (*far_sum)[3]);

// sum[interval][power] += t^power flux
inline void add_moment(int interval, float t, Flux flux, int degree, Flux (*sum)[3]) {
  Flux* out = sum[interval];
  out[0] += flux;
  const Flux first = t * flux;
  out[1] += first;
  if (degree == 2) out[2] += t * first;
}

}  // namespace parian

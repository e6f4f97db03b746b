// The moment tree: two-pass gathering with a rigorous bracket.
//
// At a fixed distance the product R_d = a_i a_o is rank one, so a node keeps the moments
// B[channel][knot] = sum_i flux_i a_i(r_k), and its contribution is about a_o(r) B(r) at the
// distance r of its centroid. Profiles fall with r, so
//
//   a_o(d_max) B-(d_max) <= contribution <= a_o(d_min) B+(d_min)
//
// with B+ log-linear between the knots (a sum of log-linear functions is log-convex) and B- the
// value at the next knot. A node is opened until that bracket, or an estimate of the second-order
// error, is small enough.
#pragma once

#include <memory>
#include <vector>

#include "transport/gather.h"

namespace parian {

struct TreeGatherParams {
  // Opening criterion for speed: estimated error of a node relative to the target's exitance. 0:
  // none is accepted, which is brute force.
  double quality = 0.0005;
  // > 0: nodes are opened until the bracket certifies this relative half-width at every target and
  // in every channel; quality is then not used.
  double tolerance = 0;
  // Every so many blocks of targets get a bracket when tolerance is 0; 1: all, 0: none.
  int certify_every = 16;
};

struct TreeGatherResult {
  std::vector<Rgb> exitance;
  // Relative half-widths of the brackets, (upper - lower) / (2 estimate), over certified targets.
  std::vector<float> half_width;  // per target, largest of its channels; < 0: no bracket was made
  double max_half_width = 0;
  double mean_half_width = 0;
  std::size_t certified = 0;    // targets with a bracket
  double nodes_per_target = 0;  // evaluations of nodes and samples
};

// The tree of one set of sources. Keeps its own copy of what it needs.
class MomentTree {
 public:
  MomentTree(const ProfileField& field, const GatherSources& sources);
  ~MomentTree();
  MomentTree(MomentTree&&) noexcept;
  MomentTree& operator=(MomentTree&&) noexcept;

  // The same bits for any number of threads; targets may come in any order.
  TreeGatherResult gather(const std::vector<GatherPoint>& targets, double near_mm,
                          const TreeGatherParams& params = {}, const Progress& progress = {}) const;
  std::size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

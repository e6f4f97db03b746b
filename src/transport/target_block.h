// Targets eight at a time: neighbours on the surface share one walk through the tree, and kernels
// treat them side by side.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/aligned.h"
#include "material/profile_field.h"
#include "transport/gather.h"

namespace parian {

inline constexpr int lanes = 8;

// Lanes beyond `count` repeat the last target.
struct TargetBlock {
  int count = 0;
  std::array<std::uint32_t, lanes> index{};  // into the targets
  float x[lanes], y[lanes], z[lanes];
  std::array<Vec3, lanes> normal;
  AlignedVector<float> half_log;  // [knot][channel][lane]
  float support[3][lanes];        // mm
  Bounds3 box;
  float max_support = 0;
};

// Groups targets by halving along the longest side of their box, so that blocks are compact:
// groups of `lanes` indices, the last of each half possibly shorter. Does not depend on threads.
std::vector<std::uint32_t> order_targets(const std::vector<GatherPoint>& targets);

// Targets order[first], ... of the next `lanes`.
void fill_block(const ProfileField& field, const std::vector<GatherPoint>& targets,
                const std::vector<std::uint32_t>& order, std::size_t first, TargetBlock& block);

}  // namespace parian

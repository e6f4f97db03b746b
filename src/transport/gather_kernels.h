// The hot loops of gathering: one emitter against the eight targets of a block, as many emitters as
// a chunk holds. Every clone gives the same bits (base/hot.h).
#pragma once

#include <cstddef>
#include <cstdint>

#include "transport/emitters.h"
#include "transport/knot_lookup.h"
#include "transport/target_block.h"

namespace parian {

// Emitters per call: the work space of one stays in the first-level cache.
inline constexpr std::size_t gather_chunk = 32;

// The block as plain pointers.
struct BlockView {
  const float* x;
  const float* y;
  const float* z;
  const float* half_log;  // [knot][channel][lane]
  const float* support;   // [channel][lane]
};
BlockView view(const TargetBlock& block);

// r[i][lane] = distance of emitter ids[i] to the target.
void eval_distances(const EmitterView& emitters, const std::uint32_t* ids, std::size_t count,
                    const BlockView& block, float* r);

// out[i][channel][lane] = h_o(r) + L(r) + ln flux, log_of_nothing beyond either support.
//
// The first order of a node's extent cancels at its centroid. `second_order` adds the mean of the
// second over a patch that faces the target edge-on, spread^2 / 2 along the line of sight and as
// much across it: with s the steepness of h_o + L, 1/4 spread^2 (s^2 - s / r).
enum class NodeExtent { point, second_order };
void eval_logs(const EmitterView& emitters, const KnotView& lookup, const std::uint32_t* ids,
               std::size_t count, const BlockView& block, const float* r, NodeExtent extent,
               float* out);

// out[i][channel][lane] = 2 h_o(r), ln P of the target itself, log_of_nothing beyond its support.
void eval_target_logs(const KnotView& lookup, std::size_t count, const BlockView& block,
                      const float* r, float* out);

// sum[channel][lane] += values[i][channel][lane], in the order of i.
void add_values(const float* values, std::size_t count, float* sum);

}  // namespace parian

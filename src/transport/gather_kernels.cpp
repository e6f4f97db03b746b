#include "transport/gather_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/hot.h"
#include "math/fast_log.h"

namespace parian {

BlockView view(const TargetBlock& block) {
  return {block.x, block.y, block.z, block.half_log.data(), &block.support[0][0]};
}

PARIAN_HOT void eval_distances(const EmitterView& emitters, const std::uint32_t* ids,
                               std::size_t count, const BlockView& block,
                               float* PARIAN_RESTRICT r) {
  const float* PARIAN_RESTRICT bx = block.x;
  const float* PARIAN_RESTRICT by = block.y;
  const float* PARIAN_RESTRICT bz = block.z;
  for (std::size_t i = 0; i < count; ++i) {
    const float x = emitters.x[ids[i]], y = emitters.y[ids[i]], z = emitters.z[ids[i]];
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const float dx = bx[lane] - x, dy = by[lane] - y, dz = bz[lane] - z;
      r[i * lanes + lane] = std::sqrt(dx * dx + dy * dy + dz * dz);
    }
  }
}

namespace {

// The eight lanes as one value: GCC and Clang split it for narrower registers. Loops over lanes get
// unrolled instead of vectorised where they hold a condition.
using Lanes = float __attribute__((vector_size(sizeof(float) * lanes)));

[[gnu::always_inline]] inline void load(const float* from, Lanes& to) {
  std::memcpy(&to, from, sizeof(Lanes));
}
[[gnu::always_inline]] inline void store(const Lanes& from, float* to) {
  std::memcpy(to, &from, sizeof(Lanes));
}

// Of the second order, in the logarithm: beyond it higher orders count as well.
constexpr float largest_correction = 0.5f;

// Segments that the lanes' distances fall into: [first, last].
struct Segments {
  std::int32_t first, last;
  float farthest;
};

[[gnu::always_inline]] inline Segments find_segments(const KnotView& lookup, const float* r) {
  float nearest = r[0], farthest = r[0];
  for (std::size_t lane = 1; lane < lanes; ++lane) {
    nearest = r[lane] < nearest ? r[lane] : nearest;
    farthest = r[lane] > farthest ? r[lane] : farthest;
  }
  return {find_segment(lookup, std::min(nearest, lookup.last)),
          find_segment(lookup, std::min(farthest, lookup.last)), farthest};
}

// Takes away the part of a node's samples that lies beyond a support, if they end evenly over the
// width. Without branches, so that it vectorises.
[[gnu::always_inline]] inline void fade_out(const float* r, const float* limit, float edge,
                                            float width, float* values) {
  constexpr float least = 1e-30f;  // e^-69
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const float end = edge < limit[lane] ? edge : limit[lane];
    float part = 0.5f + (end - r[lane]) / width;
    part = part < 1 ? part : 1;
    part = part > least ? part : least;
    values[lane] += fast_log(part);
  }
}

}  // namespace

// Lanes are near each other, so one or two segments hold them all: each is evaluated for all lanes,
// and lanes beyond its first knot take it. Gathers from tables would be slower.
PARIAN_HOT void eval_logs(const EmitterView& emitters, const KnotView& lookup,
                          const std::uint32_t* ids, std::size_t count, const BlockView& block,
                          const float* PARIAN_RESTRICT r, NodeExtent extent,
                          float* PARIAN_RESTRICT out) {
  const Lanes largest = Lanes{} + largest_correction;
  const float order = extent == NodeExtent::second_order ? 1 : 0;
  const Lanes nothing = Lanes{} + log_of_nothing;
  Lanes limit[3];
  float least_limit[3];
  for (std::size_t c = 0; c < 3; ++c) {
    load(block.support + c * lanes, limit[c]);
    least_limit[c] = *std::min_element(block.support + c * lanes, block.support + (c + 1) * lanes);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t id = ids[i];
    const Segments segments = find_segments(lookup, r + i * lanes);
    const float* rows = emitters.rows + emitters.row[id] * emitters.row_size;
    if (i + 6 < count)
      __builtin_prefetch(emitters.rows + emitters.row[ids[i + 6]] * emitters.row_size +
                         3 * segments.first);
    Lanes distance, result[3] = {};
    load(r + i * lanes, distance);
    const float spread = order * emitters.spread[id], width = order * emitters.edge_width[id];
    const Lanes curvature = spread / (distance + 1e-6f);
    for (std::int32_t k = segments.first; k <= segments.last; ++k) {
      const float inverse = lookup.inverse_step[k];
      const Lanes t = (distance - lookup.knots[k]) * inverse;
      const auto inside = distance >= (k == segments.first ? 0 : lookup.knots[k]);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t at = 3 * static_cast<std::size_t>(k) + c;
        Lanes h0, h1;
        load(block.half_log + at * lanes, h0);
        load(block.half_log + (at + 3) * lanes, h1);
        const Lanes a = h0 + rows[at], b = h1 + rows[at + 3];
        const Lanes rise = b - a, slope = rise * inverse;
        const Lanes second = slope * (slope * spread + curvature);
        const Lanes value = a + t * rise + (second < largest_correction ? second : largest);
        result[c] = inside ? value : result[c];
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      const Lanes value = result[c] + emitters.log_flux[c][id];
      float* to = out + (i * 3 + c) * lanes;
      const float edge = emitters.support[c][id];
      if (width > 0) {
        store(value, to);
        if (segments.farthest + 0.5f * width > std::min(edge, least_limit[c]))
          fade_out(r + i * lanes, block.support + c * lanes, edge, width, to);
      } else {
        const auto cut = (distance > edge) | (distance > limit[c]);
        store(cut ? nothing : value, to);
      }
    }
  }
}

PARIAN_HOT void eval_target_logs(const KnotView& lookup, std::size_t count, const BlockView& block,
                                 const float* PARIAN_RESTRICT r, float* PARIAN_RESTRICT out) {
  const Lanes nothing = Lanes{} + log_of_nothing;
  for (std::size_t i = 0; i < count; ++i) {
    const Segments segments = find_segments(lookup, r + i * lanes);
    Lanes distance, result[3] = {};
    load(r + i * lanes, distance);
    for (std::int32_t k = segments.first; k <= segments.last; ++k) {
      const Lanes t = (distance - lookup.knots[k]) * lookup.inverse_step[k];
      const auto inside = distance >= (k == segments.first ? 0 : lookup.knots[k]);
      for (std::size_t c = 0; c < 3; ++c) {
        const float* at = block.half_log + (3 * static_cast<std::size_t>(k) + c) * lanes;
        Lanes a, b;
        load(at, a);
        load(at + 3 * lanes, b);
        result[c] = inside ? 2 * (a + t * (b - a)) : result[c];
      }
    }
    for (std::size_t c = 0; c < 3; ++c) {
      Lanes limit;
      load(block.support + c * lanes, limit);
      store(distance > limit ? nothing : result[c], out + (i * 3 + c) * lanes);
    }
  }
}

PARIAN_HOT void add_values(const float* PARIAN_RESTRICT values, std::size_t count,
                           float* PARIAN_RESTRICT sum) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j < 3 * lanes; ++j) sum[j] += values[i * 3 * lanes + j];
}

}  // namespace parian

// From a distance to its segment between knots, in a few operations that vectorise.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace parian {

// The bits of the float r + shift, without the low ones, are a bin number that grows like log r;
// bins are so narrow that each holds one knot at most.
struct KnotLookup {
  std::vector<float> knots;         // increasing from 0
  std::vector<float> inverse_step;  // 1 / (knots[k + 1] - knots[k])
  std::vector<std::int32_t> segment_of_bin;
  float shift = 0;
  float last = 0;  // knot; distances beyond count as it
  std::int32_t drop_bits = 0;
  std::int32_t first_bin = 0;
};
KnotLookup make_knot_lookup(const std::vector<float>& knots);

// The same as plain pointers, for kernels.
struct KnotView {
  const float* knots;
  const float* inverse_step;
  const std::int32_t* segment_of_bin;
  float shift;
  float last;
  std::int32_t drop_bits;
  std::int32_t first_bin;
};
inline KnotView view(const KnotLookup& lookup) {
  return {lookup.knots.data(),
          lookup.inverse_step.data(),
          lookup.segment_of_bin.data(),
          lookup.shift,
          lookup.last,
          lookup.drop_bits,
          lookup.first_bin};
}

// k with knots[k] <= r < knots[k + 1], for r in [0, last]; the last segment holds its end.
[[gnu::always_inline]] inline std::int32_t find_segment(const KnotView& lookup, float r) {
  const std::int32_t bin =
      (std::bit_cast<std::int32_t>(r + lookup.shift) >> lookup.drop_bits) - lookup.first_bin;
  const std::int32_t k = lookup.segment_of_bin[bin];
  return k + (r >= lookup.knots[k + 1] ? 1 : 0);
}

}  // namespace parian

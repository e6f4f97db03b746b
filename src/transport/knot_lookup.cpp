#include "transport/knot_lookup.h"

#include <limits>

#include "base/check.h"

namespace parian {
namespace {

constexpr std::int32_t mantissa_bits = 23;

std::int32_t bin_of(float r, const KnotLookup& lookup) {
  return (std::bit_cast<std::int32_t>(r + lookup.shift) >> lookup.drop_bits) - lookup.first_bin;
}

// Fills the bins; false when one holds more than one knot.
bool fill_bins(KnotLookup& lookup) {
  const std::size_t segments = lookup.knots.size() - 1;
  lookup.first_bin = 0;
  lookup.first_bin = bin_of(0, lookup);
  const auto bins = static_cast<std::size_t>(bin_of(lookup.last, lookup)) + 1;
  lookup.segment_of_bin.assign(bins, 0);
  std::size_t k = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    lookup.segment_of_bin[bin] = static_cast<std::int32_t>(k);
    std::size_t inside = 0;
    while (k + 1 < segments &&
           bin_of(lookup.knots[k + 1], lookup) == static_cast<std::int32_t>(bin)) {
      ++k;
      ++inside;
    }
    if (inside > 1) return false;
  }
  return true;
}

}  // namespace

KnotLookup make_knot_lookup(const std::vector<float>& knots) {
  PARIAN_CHECK_LE(std::size_t{2}, knots.size());
  KnotLookup lookup;
  lookup.knots = knots;
  lookup.last = knots.back();
  lookup.shift = knots[1];
  for (std::size_t k = 0; k + 1 < knots.size(); ++k)
    lookup.inverse_step.push_back(1 / (knots[k + 1] - knots[k]));
  for (lookup.drop_bits = mantissa_bits - 5; lookup.drop_bits > 6; --lookup.drop_bits)
    if (fill_bins(lookup)) break;
  // A sentinel in place of the last knot keeps r = last in the last segment.
  lookup.knots.back() = std::numeric_limits<float>::infinity();
  return lookup;
}

}  // namespace parian

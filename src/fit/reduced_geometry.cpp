// Which offsets take part, and between which knots they lie.
#include <algorithm>

#include "base/check.h"
#include "fit/pair_weights.h"
#include "fit/reduced_internal.h"

namespace parian {
namespace {

void place_offsets(const TableHeader& header, const ReducedParams& params, ReducedSystem& system) {
  const auto& knots = params.knots_mm;
  for (std::size_t d = 0; d < header.offsets.size(); ++d) {
    const double r = length_px(header.offsets[d]) * header.pixel_pitch_mm;
    if (r > knots.back() * (1 + 1e-9)) continue;
    const auto above =
        std::upper_bound(knots.begin(), knots.end(), r * (1 + 1e-12)) - knots.begin();
    const auto upper =
        static_cast<std::size_t>(std::min<std::ptrdiff_t>(above, std::ssize(knots) - 1));
    const double fraction = (r - knots[upper - 1]) / (knots[upper] - knots[upper - 1]);
    system.offsets.push_back(header.offsets[d]);
    system.table_index.push_back(static_cast<int>(d));
    system.pair_count.push_back(pair_count(header, header.offsets[d]));
    system.segment.push_back(static_cast<int>(upper) - 1);
    system.fraction.push_back(std::clamp(fraction, 0.0, 1.0));
  }
}

}  // namespace

ReducedSystem make_geometry(const SliceSource& table, int channel, const ReducedParams& params) {
  const TableHeader& header = table.header();
  PARIAN_CHECK(params.knots_mm.size() >= 2 && params.knots_mm[0] == 0);
  PARIAN_CHECK_LT(channel, header.channels);
  ReducedSystem system;
  system.width = header.width;
  system.height = header.height;
  system.pixel_pitch_mm = header.pixel_pitch_mm;
  system.knots_mm = params.knots_mm;
  system.lambda = params.lambda;
  system.channel = channel;
  system.pair_weight = params.weight;
  system.hold_out = params.hold_out;
  place_offsets(header, params, system);
  system.weights = make_weight_terms(system, params);
  system.missing.resize(system.offsets.size());
  return system;
}

}  // namespace parian

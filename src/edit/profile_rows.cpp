#include "edit/profile_rows.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "edit/shape_kernels.h"

namespace parian {

std::vector<float> normalise_rows(const EditState& state) {
  const std::size_t knots = state.knots_mm.size(), pixels = state.pixels();
  const KnotTable table = make_knot_table(state.knots_mm);
  std::vector<float> rows(state.shapes->log_profile.size());
  std::vector<double> mean_range(static_cast<std::size_t>(state.channels), 0.0);
  for (std::size_t i = 0; i < state.values(); ++i)
    mean_range[i / pixels] += state.shapes->range_mm[i] / static_cast<double>(pixels);
  const std::size_t blocks = (pixels + shape_lanes - 1) / shape_lanes;
  parallel_for(blocks * mean_range.size(), [&](std::size_t b) {
    const std::size_t c = b / blocks, first = b % blocks * shape_lanes;
    const std::size_t count = std::min(shape_lanes, pixels - first);
    AlignedVector<float> block(knots * shape_lanes);
    AlignedVector<float> sampled(knots * shape_lanes);
    alignas(64) float scale[shape_lanes], shift[shape_lanes];
    alignas(64) double ranges[shape_lanes];
    for (std::size_t i = 0; i < shape_lanes; ++i) {
      const std::size_t at = c * pixels + first + std::min(i, count - 1);
      const double range = state.shapes->range_mm[at];
      ranges[i] = range;
      scale[i] = static_cast<float>(range / mean_range[c]);
      shift[i] = static_cast<float>(
          std::log(6.283185307179586 * range * range / state.shapes->albedo[at]));
      for (std::size_t k = 0; k < knots; ++k)
        block[k * shape_lanes + i] =
            state.shapes->log_profile[(c * knots + k) * pixels + first + std::min(i, count - 1)];
    }
    ShapeTails tails;
    find_tails(table, block.data(), ranges, &tails);
    sample_shapes(view_rows(table, block.data(), tails), scale, sampled.data());
    for (std::size_t k = 0; k < knots; ++k) {
      float* out = &rows[(c * knots + k) * pixels + first];
      for (std::size_t i = 0; i < count; ++i) {
        // Beyond the support: as small as at its end.
        const float least = block[i] - 20.0f;
        out[i] = std::max(sampled[k * shape_lanes + i], least) + shift[i];
      }
    }
  });
  return rows;
}

}  // namespace parian

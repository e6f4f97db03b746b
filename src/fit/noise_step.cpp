#include "fit/noise_step.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/hot.h"
#include "base/parallel.h"

namespace parian {
namespace {

// ln R* = ((1 - f) (a(x) + a(x + d)) + f (b(x) + b(x + d))) / 2
PARIAN_HOT void eval_log_model(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT ad,
                               const float* PARIAN_RESTRICT b, const float* PARIAN_RESTRICT bd,
                               float f, float* PARIAN_RESTRICT out, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    out[i] = 0.5f * ((1 - f) * (a[i] + ad[i]) + f * (b[i] + bd[i]));
}

// out = phi w 2 z; adds up w and phi w (2 z)^2.
void weigh(const float* weight, const float* residual, double phi, std::size_t count, float* out,
           NoiseSums& sums) {
  for (std::size_t i = 0; i < count; ++i) {
    const double w = static_cast<double>(weight[i]), y = 2 * static_cast<double>(residual[i]);
    out[i] = static_cast<float>(phi * w * y);
    sums.weight += w;
    sums.squares += phi * w * y * y;
  }
}

}  // namespace

NoiseSums eval_noise_offset(const ReducedSystem& system, const NoiseStep& step, std::size_t i,
                            const TableHeader& header, const float* slice, float* first_row,
                            std::size_t stride) {
  const Offset offset = system.offsets[i];
  const PixelRange range = pairs_in_grid(header, offset);
  const auto width = static_cast<std::size_t>(system.width);
  const auto count = static_cast<std::size_t>(std::max(0, range.x1 - range.x0));
  const float* low =
      step.field.data() + static_cast<std::size_t>(system.segment[i]) * system.pixels();
  const float* high = low + system.pixels();
  const std::ptrdiff_t partner = static_cast<std::ptrdiff_t>(offset.dy) * system.width + offset.dx;
  std::vector<float> log_model(count), weight(count), residual(count);
  NoiseSums sums;
  for (int y = 0; y < system.height; ++y) {
    float* row = first_row + static_cast<std::size_t>(y) * stride;
    std::fill_n(row, width, 0.0f);
    if (y < range.y0 || y >= range.y1 || count == 0) continue;
    const std::size_t x = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(range.x0);
    eval_log_model(low + x, low + x + partner, high + x, high + x + partner,
                   static_cast<float>(system.fraction[i]), log_model.data(), count);
    eval_noise_residuals(slice + x, log_model.data(), step.noise, count, weight.data(),
                         residual.data());
    weigh(weight.data(), residual.data(), step.phi[i], count, row + range.x0, sums);
  }
  return sums;
}

OffsetMeans measure_offset_means(const SliceSource& table, const ReducedSystem& geometry,
                                 const Progress& progress) {
  OffsetMeans means{std::vector<double>(geometry.offsets.size()),
                    std::vector<double>(geometry.offsets.size())};
  parallel_for(geometry.offsets.size(), [&](std::size_t i) {
    std::vector<float> slice(geometry.pixels());
    table.read_slice(geometry.channel, geometry.table_index[i], slice.data());
    double sum = 0;
    for (int y = 0; y < geometry.height; ++y)
      for (int x = 0; x < geometry.width; ++x) {
        const auto value = static_cast<double>(
            slice[static_cast<std::size_t>(y) * static_cast<std::size_t>(geometry.width) +
                  static_cast<std::size_t>(x)]);
        if (std::isnan(value) || is_held_out(geometry.hold_out, x, y, geometry.offsets[i]))
          continue;
        sum += value;
        ++means.known[i];
      }
    means.mean[i] = means.known[i] > 0 ? sum / means.known[i] : 0;
  });
  if (progress.is_cancelled && progress.is_cancelled()) throw make_cancelled_error();
  return means;
}

}  // namespace parian

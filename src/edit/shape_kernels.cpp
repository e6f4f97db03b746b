#include "edit/shape_kernels.h"

#include <cmath>
#include <cstdint>

#include "base/hot.h"
#include "math/fast_log.h"

namespace parian {
namespace {

constexpr double two_pi = 6.283185307179586;

// e^x; e^-80 below, e^80 above.
[[gnu::always_inline]] inline float exp_lane(float x) {
  const float above = x < -80.0f ? -80.0f : x;
  return exp_of_small<float, std::int32_t>(above < 80.0f ? above : 80.0f);
}

}  // namespace

PARIAN_HOT void finish_tails(const float* PARIAN_RESTRICT before, const float* PARIAN_RESTRICT end,
                             const double* PARIAN_RESTRICT range_mm, double last_radius,
                             float inverse_length, ShapeTails* PARIAN_RESTRICT tails) {
  const auto least = static_cast<float>(-min_tail_decay / last_radius);
  for (std::size_t i = 0; i < shape_lanes; ++i) {
    const float last_slope = (end[i] - before[i]) * inverse_length;
    tails->slope[i] = last_slope < least ? last_slope : least;
    // Where P falls through the threshold beyond the last knot, or that; and a little more, so that
    // rounding never cuts off the last knot.
    const double support = range_mm[i] > last_radius ? range_mm[i] : last_radius;
    tails->support[i] = 1.00001f * static_cast<float>(support);
  }
}

PARIAN_HOT void fill_log_scales(const double* PARIAN_RESTRICT range,
                                const double* PARIAN_RESTRICT albedo, float* PARIAN_RESTRICT out) {
  for (std::size_t i = 0; i < shape_lanes; ++i)
    out[i] = fast_log(static_cast<float>(two_pi * range[i] * range[i] / albedo[i]));
}

PARIAN_HOT void fill_mix_scales(const double* PARIAN_RESTRICT range_1,
                                const double* PARIAN_RESTRICT range_2,
                                const float* PARIAN_RESTRICT part, double amount,
                                MixScales* PARIAN_RESTRICT scales) {
  for (std::size_t i = 0; i < shape_lanes; ++i) {
    const double w = amount * static_cast<double>(part[i]);
    const double inverse = (1 - w) / range_1[i] + w / range_2[i];
    scales->weight[i] = static_cast<float>(w);
    scales->first[i] = static_cast<float>(range_1[i] * inverse);
    scales->second[i] = static_cast<float>(range_2[i] * inverse);
  }
}

namespace {

// Without offsets: ln S' = ln S0 + exponent ln(S / S0) + ln scale.
PARIAN_HOT void scale_shape_row(const ShapeCurves* curves, float radius,
                                const float* PARIAN_RESTRICT row,
                                const float* PARIAN_RESTRICT first,
                                const float* PARIAN_RESTRICT amount, float* PARIAN_RESTRICT out) {
  const auto samples = static_cast<float>(curves->samples);
  const float* PARIAN_RESTRICT scales = curves->scale;
  for (int i = 0; i < static_cast<int>(shape_lanes); ++i) {
    const float u = radius * curves->inverse_range[i];
    const float place = (u < 1 ? u : 1.0f) * samples;
    const int bin = static_cast<int>(place < samples ? place : samples - 1);
    const float s0 = scales[bin], s1 = scales[bin + 1];
    const float s = s0 + (place - static_cast<float>(bin)) * (s1 - s0);
    const float scale = 1 + amount[i] * (s - 1);
    const float log_bent = curves->exponent[i] * (row[i] - first[i]);
    const float capped = log_bent > 0 ? 0.0f : log_bent;  // a rise is cut off here already
    out[i] = first[i] + curves->shift[i] + capped + fast_log(scale > 1e-30f ? scale : 1e-30f);
  }
}

PARIAN_HOT void bend_general_row(const ShapeCurves* curves, float radius,
                                 const float* PARIAN_RESTRICT row,
                                 const float* PARIAN_RESTRICT first,
                                 const float* PARIAN_RESTRICT amount, float* PARIAN_RESTRICT out) {
  const auto samples = static_cast<float>(curves->samples);
  for (std::size_t i = 0; i < shape_lanes; ++i) {
    const float u = radius * curves->inverse_range[i];
    const float place = (u < 1 ? u : 1.0f) * samples;
    const int bin = static_cast<int>(place < samples ? place : samples - 1);
    const float w = place - static_cast<float>(bin);
    const float s0 = curves->scale[bin], s1 = curves->scale[bin + 1];
    const float o0 = curves->offset[bin], o1 = curves->offset[bin + 1];
    const float scale = 1 + amount[i] * (s0 + w * (s1 - s0) - 1);
    const float offset = u <= 1 ? amount[i] * (o0 + w * (o1 - o0)) : 0.0f;
    // Relative to S0, so that nothing under- or overflows.
    const float log_first = first[i] + curves->shift[i];
    const float log_bent = curves->exponent[i] * (row[i] - first[i]);
    const float capped = log_bent > 0 ? 0.0f : log_bent;  // a rise is cut off here already
    const float bent = scale * exp_lane(capped) + offset * exp_lane(-log_first);
    out[i] = log_first + fast_log(bent > 1e-30f ? bent : 1e-30f);
  }
}

}  // namespace

void bend_shape_row(const ShapeCurves* curves, float radius, const float* row, const float* first,
                    const float* amount, float* out) {
  if (curves->offset == nullptr) return scale_shape_row(curves, radius, row, first, amount, out);
  bend_general_row(curves, radius, row, first, amount, out);
}

}  // namespace parian

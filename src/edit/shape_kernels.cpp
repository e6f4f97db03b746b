#include "edit/shape_kernels.h"

#include <bit>
#include <cmath>
#include <cstdint>

#include "base/hot.h"
#include "math/fast_log.h"

namespace parian {
namespace {

constexpr double two_pi = 6.283185307179586;
constexpr auto log_of_threshold = static_cast<float>(log_of_support);

[[gnu::always_inline]] inline float exp_lane_float(float x) {
  constexpr float log2_e = 1.44269504f, ln2_high = 0.693359375f, ln2_low = -2.12194440e-4f;
  constexpr float round = 12582912.0f;
  const float clamped = x < -80.0f ? -80.0f : x;  // callers see to x < 88
  const float shifted = clamped * log2_e + round;
  const float k = shifted - round;
  const float f = (clamped - k * ln2_high) - k * ln2_low;
  const float p =
      1 + f * (1 + f * (0.5f + f * (0.16666667f +
                                    f * (0.041666668f + f * (0.0083333338f + f * 0.0013888889f)))));
  const std::uint32_t power = std::bit_cast<std::uint32_t>(shifted) << 23u;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(p) + power);
}

[[gnu::always_inline]] inline float exp_lane_any(float x) {
  const float capped = x < 80.0f ? x : 80.0f;
  return exp_lane_float(capped);
}

}  // namespace

PARIAN_HOT void note_crossing(const float* PARIAN_RESTRICT before, const float* PARIAN_RESTRICT row,
                              float index, ShapeCrossings* PARIAN_RESTRICT crossings) {
  for (std::size_t i = 0; i < shape_lanes; ++i) {
    const float level = crossings->top[i] - log_of_threshold;
    const bool crosses = (before[i] > level) & (row[i] <= level);
    crossings->segment[i] = crosses ? index : crossings->segment[i];
  }
}

PARIAN_HOT void finish_tails(const float* PARIAN_RESTRICT top, const float* PARIAN_RESTRICT before,
                             const float* PARIAN_RESTRICT end, float last_radius, float last_length,
                             ShapeTails* PARIAN_RESTRICT tails) {
  const auto least = static_cast<float>(-min_tail_decay) / last_radius;
  const float limit = static_cast<float>(support_limit) * last_radius;
  for (std::size_t i = 0; i < shape_lanes; ++i) {
    const float last_slope = (end[i] - before[i]) / last_length;
    const float slope = last_slope < least ? last_slope : least;
    const float level = top[i] - log_of_threshold;
    const float crossing = last_radius + (level - end[i]) / slope;
    float support = end[i] > level ? crossing : last_radius;
    support = support < limit ? support : limit;
    tails->slope[i] = slope;
    // A little more, so that rounding never cuts off the last knot.
    tails->support[i] = 1.00001f * support;
  }
}

PARIAN_HOT void raise_row(const float* PARIAN_RESTRICT row, float* PARIAN_RESTRICT top) {
  for (std::size_t i = 0; i < shape_lanes; ++i) top[i] = row[i] > top[i] ? row[i] : top[i];
}

PARIAN_HOT void fill_log_scales(const double* PARIAN_RESTRICT range,
                                const double* PARIAN_RESTRICT albedo, float* PARIAN_RESTRICT out) {
  for (std::size_t i = 0; i < shape_lanes; ++i)
    out[i] = fast_log(static_cast<float>(two_pi * range[i] * range[i] / albedo[i]));
}

namespace {

// The common case without a search. Nothing branches, so that lanes stay side by side.
PARIAN_HOT void sample_uniform_knots(const ShapeRows* rows, float radius,
                                     const float* PARIAN_RESTRICT scale,
                                     float* PARIAN_RESTRICT out) {
  const int last = rows->knots - 1;
  const float end = rows->radius[last], per_mm = rows->knots_per_mm;
  const float* PARIAN_RESTRICT value = rows->value;
  const float* PARIAN_RESTRICT slope = rows->tail_slope;
  const float* PARIAN_RESTRICT support = rows->support;
  for (int i = 0; i < static_cast<int>(shape_lanes); ++i) {
    const float r = radius * scale[i];
    const float inside = r < end ? r : end;
    const float place = inside * per_mm;
    int k = static_cast<int>(place);
    k = k < last - 1 ? k : last - 1;
    const float w = place - static_cast<float>(k);
    const int at = k * static_cast<int>(shape_lanes) + i;
    const float a = value[at], b = value[at + static_cast<int>(shape_lanes)];
    const float y = a + w * (b - a) + (r - inside) * slope[i];
    out[i] = r <= support[i] ? y : log_of_zero;
  }
}

}  // namespace

void sample_shapes(const ShapeRows* rows, float radius, const float* scale, float* out) {
  if (rows->knots_per_mm > 0) return sample_uniform_knots(rows, radius, scale, out);
  const int last = rows->knots - 1;
  const float end = rows->radius[last];
  for (std::size_t i = 0; i < shape_lanes; ++i) {
    const float r = radius * scale[i];
    const float inside = r < end ? r : end;
    int k = rows->segment_of_bin[static_cast<int>(inside * rows->bins_per_mm)];
    while (k + 1 < last && inside >= rows->radius[k + 1]) ++k;
    const float w = (inside - rows->radius[k]) / (rows->radius[k + 1] - rows->radius[k]);
    const float a = rows->value[static_cast<std::size_t>(k) * shape_lanes + i];
    const float b = rows->value[static_cast<std::size_t>(k + 1) * shape_lanes + i];
    const float y = a + w * (b - a) + (r - inside) * rows->tail_slope[i];
    out[i] = r <= rows->support[i] ? y : log_of_zero;
  }
}

PARIAN_HOT void mix_shape_rows(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT a_shift,
                               const float* PARIAN_RESTRICT b, const float* PARIAN_RESTRICT b_shift,
                               const float* PARIAN_RESTRICT w, float* PARIAN_RESTRICT out) {
  for (std::size_t i = 0; i < shape_lanes; ++i) {
    const float ya = a[i] + a_shift[i], yb = b[i] + b_shift[i];
    const bool first = ya > yb;  // the larger of both counts as 1
    const float top = first ? ya : yb, low = first ? yb : ya;
    const float of_top = first ? 1 - w[i] : w[i];
    out[i] = top + fast_log(of_top + (1 - of_top) * exp_lane_float(low - top));
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
    const float bent = scale * exp_lane_float(capped) + offset * exp_lane_any(-log_first);
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

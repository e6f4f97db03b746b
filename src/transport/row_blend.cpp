#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hot.h"
#include "math/fast_math.h"
#include "transport/row_blend.h"

namespace parian {
namespace {

const double range_drop = std::log(support_threshold);
constexpr float least_log = -80;  // exponentials of less would end in zero

double to_double(float value) {
  return static_cast<double>(value);
}

// int exp(y) r dr over segments [r0, r0 + h] with y linear from y0 to y1 (see segment_integral),
// p = exp(y). Where y hardly changes, the quotients cancel and series stand for them.
PARIAN_HOT void integrate_segments(const float* PARIAN_RESTRICT y, const float* PARIAN_RESTRICT p,
                                   const float* PARIAN_RESTRICT start,
                                   const float* PARIAN_RESTRICT length, std::size_t count,
                                   float* PARIAN_RESTRICT out) {
  for (std::size_t i = 0; i < count; ++i) {
    const float beta = y[i + 3] - y[i];
    const bool is_small = beta < 0.5f && beta > -0.5f;
    const float safe = is_small ? 1.0f : beta;
    const float quotient = (p[i + 3] - p[i]) / safe;
    const float moment = (p[i + 3] - quotient) / safe;
    const float phi =
        1 + beta / 2 *
                (1 + beta / 3 * (1 + beta / 4 * (1 + beta / 5 * (1 + beta / 6 * (1 + beta / 7)))));
    const float psi =
        0.5f +
        beta * (0.33333334f +
                beta * (0.125f + beta * (0.033333335f +
                                         beta * (0.0069444445f +
                                                 beta * (0.0011904762f + beta * 1.7361111e-4f)))));
    out[i] = length[i] * (is_small ? p[i] * (start[i] * phi + length[i] * psi)
                                   : start[i] * quotient + length[i] * moment);
  }
}

// C of channel c, whose logarithms are y and whose whole segments have been integrated.
double sum_to_support(const RowKnots& knots, const RowScratch& scratch, std::size_t c,
                      float support) {
  const auto beyond = std::upper_bound(knots.knots_mm.begin(), knots.knots_mm.end(), support);
  const auto k = static_cast<std::size_t>(beyond - knots.knots_mm.begin()) - 1;
  float sums[2] = {};  // of every other segment: half the latency
  for (std::size_t i = 0; i + 1 < k; i += 2) {
    sums[0] += scratch.term[3 * i + c];
    sums[1] += scratch.term[3 * i + 3 + c];
  }
  double sum = to_double(sums[0]) + to_double(sums[1]);
  if (k % 2 == 1) sum += to_double(scratch.term[3 * (k - 1) + c]);
  if (k + 1 == knots.knots() || !(support > knots.knots_mm[k])) return sum;
  const double from = to_double(knots.knots_mm[k]), part = to_double(support) - from;
  const double y0 = to_double(scratch.value[3 * k + c]);
  const double y1 = to_double(scratch.value[3 * (k + 1) + c]);
  const double length = to_double(knots.knots_mm[k + 1]) - from;
  return sum + segment_integral(from, part, y0, y0 + (y1 - y0) * part / length);
}

// Where y, at most 0, is last above the level; at most the support.
double find_range(const RowKnots& knots, const float* y, float support) {
  const auto level = static_cast<float>(range_drop);
  std::size_t k = knots.knots() - 1;
  while (k > 0 && !(y[3 * k] > level)) --k;
  if (k + 1 == knots.knots()) return to_double(support);
  const double from = to_double(knots.knots_mm[k]), to = to_double(knots.knots_mm[k + 1]);
  const double high = to_double(y[3 * k]), low = to_double(y[3 * (k + 1)]);
  return std::min(from + (to - from) * (high - range_drop) / (high - low), to_double(support));
}

// y(stretch r) at all knots, y = 2 half_log + shift; on with the last slope beyond the last knot.
// `next` has the knot after each, infinity for the last two.
PARIAN_HOT void stretch_row(const float* PARIAN_RESTRICT knots, const float* PARIAN_RESTRICT next,
                            const float* PARIAN_RESTRICT inverse_length, std::size_t count,
                            const float* PARIAN_RESTRICT half_log, float stretch, float shift,
                            float* PARIAN_RESTRICT out) {
  std::size_t k = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float r = knots[i] * stretch;
    k += next[k] <= r ? 1 : 0;  // one step is the rule
    while (next[k] <= r) ++k;
    const float t = (r - knots[k]) * inverse_length[k];
    const float low = half_log[3 * k];
    out[3 * i] = 2 * (low + t * (half_log[3 * k + 3] - low)) + shift;
  }
}

PARIAN_HOT void raise_to(float least, float* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) values[i] = values[i] > least ? values[i] : least;
}
PARIAN_HOT void mix_values(float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                           std::size_t count, float w) {
  for (std::size_t i = 0; i < count; ++i) a[i] = (1 - w) * a[i] + w * b[i];
}

// a = ln((1 - w) e^a + w e^b); b is used up.
void mix_logs(float* a, float* b, std::size_t count, float w) {
  raise_to(least_log, a, count);
  raise_to(least_log, b, count);
  exp_array(a, a, count);
  exp_array(b, b, count);
  mix_values(a, b, count, w);
  log_array(a, a, count);
}

void shift_row(ProfileRow& row, std::size_t c, double shift) {
  for (std::size_t i = c; i < row.half_log.size(); i += 3)
    row.half_log[i] = static_cast<float>(to_double(row.half_log[i]) + shift);
}

double mix(double a, double b, double w) {
  return (1 - w) * a + w * b;
}

// a's values become ln S(r / range) of the mixed shape, and its supports those of the mixture.
void mix_shapes(const RowKnots& knots, ProfileRow& a, const ProfileRow& b,
                const RowProperties& of_a, const RowProperties& of_b,
                const std::array<double, 3>& range, double w, RowScratch& scratch) {
  scratch.value.resize(knots.row());
  scratch.other.resize(knots.row());
  const auto write = [&](const ProfileRow& row, const RowProperties& of, std::size_t c,
                         std::vector<float>& out) {
    const double shift = 2 * std::log(of.range_mm[c]) - std::log(of.integral[c]);
    stretch_row(knots.knots_mm.data(), knots.next_mm.data(), knots.inverse_length.data(),
                knots.knots(), &row.half_log[c], static_cast<float>(of.range_mm[c] / range[c]),
                static_cast<float>(shift), &out[c]);
  };
  for (std::size_t c = 0; c < 3; ++c) {
    if (w < 1) write(a, of_a, c, scratch.value);
    if (w > 0) write(b, of_b, c, scratch.other);
    const double limit = to_double(std::max(a.support_mm[c], b.support_mm[c]));
    const double end = mix(to_double(a.support_mm[c]) / of_a.range_mm[c],
                           to_double(b.support_mm[c]) / of_b.range_mm[c], w);
    a.support_mm[c] = static_cast<float>(std::min(end * range[c], limit));
  }
  if (w >= 1) std::swap(scratch.value, scratch.other);
  if (w > 0 && w < 1)
    mix_logs(scratch.value.data(), scratch.other.data(), knots.row(), static_cast<float>(w));
  for (std::size_t i = 0; i < knots.row(); ++i) a.half_log[i] = 0.5f * scratch.value[i];
}

}  // namespace

RowKnots make_row_knots(std::vector<float> knots_mm) {
  RowKnots knots;
  const std::size_t segments = knots_mm.size() - 1;
  knots.start_mm.reserve(3 * segments);
  knots.length_mm.reserve(3 * segments);
  for (std::size_t i = 0; i < 3 * segments; ++i) {
    knots.start_mm.push_back(knots_mm[i / 3]);
    knots.length_mm.push_back(knots_mm[i / 3 + 1] - knots_mm[i / 3]);
  }
  knots.next_mm.assign(knots_mm.begin() + 1, knots_mm.end());
  knots.next_mm.push_back(std::numeric_limits<float>::infinity());
  knots.next_mm[segments - 1] = std::numeric_limits<float>::infinity();
  knots.inverse_length.reserve(segments);
  for (std::size_t k = 0; k < segments; ++k)
    knots.inverse_length.push_back(1 / knots.length_mm[3 * k]);
  knots.knots_mm = std::move(knots_mm);
  return knots;
}

RowProperties measure_row(const RowKnots& knots, const ProfileRow& row, RowScratch& scratch) {
  const std::size_t size = knots.row();
  const float* half_log = row.half_log.data();
  float top[3] = {half_log[0], half_log[1], half_log[2]};
  for (std::size_t i = 3; i < size; i += 3)
    for (std::size_t c = 0; c < 3; ++c) top[c] = std::max(top[c], half_log[i + c]);
  for (std::vector<float>* array : {&scratch.value, &scratch.exponential, &scratch.term})
    array->resize(size);
  float* value = scratch.value.data();
  for (std::size_t i = 0; i < size; i += 3)
    for (std::size_t c = 0; c < 3; ++c) value[i + c] = 2 * (half_log[i + c] - top[c]);
  exp_array(scratch.value.data(), scratch.exponential.data(), size);
  integrate_segments(scratch.value.data(), scratch.exponential.data(), knots.start_mm.data(),
                     knots.length_mm.data(), size - 3, scratch.term.data());
  RowProperties properties;
  for (std::size_t c = 0; c < 3; ++c) {
    properties.integral[c] =
        std::exp(2 * to_double(top[c])) * sum_to_support(knots, scratch, c, row.support_mm[c]);
    properties.range_mm[c] = find_range(knots, &scratch.value[c], row.support_mm[c]);
  }
  return properties;
}

void prevent_rises(ProfileRow& row) {
  float* values = row.half_log.data();
  float low[3] = {values[0], values[1], values[2]};
  for (std::size_t i = 3; i < row.half_log.size(); i += 3)
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], values[i + c]);
      values[i + c] = low[c];
    }
}

void blend_rows(const RowKnots& knots, ProfileRow& a, const ProfileRow& b,
                const PropertyWeights& weights, bool monotone, RowScratch& scratch) {
  if (weights == PropertyWeights{}) return;
  if (weights == PropertyWeights{1, 1, 1}) {
    a = b;
    return;
  }
  const RowProperties of_a = measure_row(knots, a, scratch);
  const RowProperties of_b = measure_row(knots, b, scratch);
  const auto albedo = [&](std::size_t c) {
    return mix(of_a.integral[c], of_b.integral[c], weights.albedo);
  };
  if (weights.range == 0 && weights.shape == 0) {
    for (std::size_t c = 0; c < 3; ++c)
      shift_row(a, c, 0.5 * std::log(albedo(c) / of_a.integral[c]));
  } else {
    std::array<double, 3> range{};
    for (std::size_t c = 0; c < 3; ++c)
      range[c] = mix(of_a.range_mm[c], of_b.range_mm[c], weights.range);
    mix_shapes(knots, a, b, of_a, of_b, range, weights.shape, scratch);
    if (monotone) prevent_rises(a);
    const RowProperties found = measure_row(knots, a, scratch);
    for (std::size_t c = 0; c < 3; ++c)
      shift_row(a, c, 0.5 * std::log(albedo(c) / found.integral[c]));
  }
  if (monotone) prevent_rises(a);
}

}  // namespace parian

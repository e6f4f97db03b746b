// Blends as renderers see them: rows of half_log mixed from the bases' own at every evaluation.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "base/hot.h"
#include "base/parallel.h"
#include "material/field_internal.h"

namespace parian {
namespace {

struct BlendRows {
  std::vector<float> base_half_log;  // [base][knot][channel]; beyond the last knot the last slope
  std::vector<float> support;        // [pixel][channel]
  std::vector<float> log_gain;       // 1/2 ln gain [pixel][channel], or empty
  std::vector<std::uint8_t> bent;    // [pixel]: the tail falls at the minimum decay, not as mixed
  std::vector<std::uint16_t> index;  // [pixel][k]
  std::vector<float> weight;         // [pixel][k], all K
  std::size_t per_pixel = 0, row = 0;
  std::size_t own_knots = 0;  // those of the blend; the others are the tail's
  std::vector<float> knots;   // of the field
};

PARIAN_HOT void add_row(const float* PARIAN_RESTRICT from, float weight, float* PARIAN_RESTRICT to,
                        std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] += weight * from[i];
}

// Bases over the field's knots, the tail by their own last slope without its limit: mixtures of
// these are right wherever the mixture's slope is below the limit.
void fill_bases(const ProfileBlend& blend, BlendRows& rows) {
  const std::size_t knots = rows.knots.size(), own = rows.own_knots;
  rows.base_half_log.resize(blend.bases() * rows.row);
  for (std::size_t j = 0; j < blend.bases(); ++j)
    for (std::size_t c = 0; c < 3; ++c) {
      const float* base = base_profile(blend, j, std::min(static_cast<int>(c), blend.channels - 1));
      float* to = &rows.base_half_log[j * rows.row + c];
      const Profile profile{blend.knots_mm, {base, base + blend.knots_mm.size()}, HUGE_VAL};
      const std::size_t last = blend.knots_mm.size() - 1;
      const double slope = (profile.log_value[last] - profile.log_value[last - 1]) /
                           (blend.knots_mm[last] - blend.knots_mm[last - 1]);
      for (std::size_t k = 0; k < knots; ++k) {
        const auto r = static_cast<double>(rows.knots[k]);
        const double value = k < own ? eval_log_profile(profile, r)
                                     : profile.log_value[last] + slope * (r - blend.knots_mm[last]);
        to[3 * k] = static_cast<float>(0.5 * value);
      }
    }
}

void fill_pixels(const ProfileBlend& blend, BlendRows& rows) {
  const std::size_t pixels = blend.pixels(), per_pixel = rows.per_pixel;
  rows.support.resize(3 * pixels);
  rows.bent.assign(pixels, 0);
  rows.index.resize(per_pixel * pixels);
  rows.weight.resize(per_pixel * pixels);
  if (!blend.gain.empty()) rows.log_gain.resize(3 * pixels);
  const double limit = -min_tail_decay / blend.knots_mm.back();
  parallel_for(static_cast<std::size_t>(blend.height), [&](std::size_t y) {
    for (std::size_t x = 0; x < static_cast<std::size_t>(blend.width); ++x) {
      const std::size_t pixel = y * static_cast<std::size_t>(blend.width) + x;
      get_weights(blend, pixel, &rows.weight[pixel * per_pixel]);
      for (std::size_t k = 0; k < per_pixel; ++k)
        rows.index[pixel * per_pixel + k] = blend.index[k * pixels + pixel];
      for (std::size_t c = 0; c < 3; ++c) {
        const int channel = std::min(static_cast<int>(c), blend.channels - 1);
        const Profile profile =
            get_profile(blend, channel, static_cast<int>(x), static_cast<int>(y));
        rows.support[3 * pixel + c] = static_cast<float>(profile.support_mm);
        const std::size_t last = profile.knots_mm.size() - 1;
        const double slope = (profile.log_value[last] - profile.log_value[last - 1]) /
                             (profile.knots_mm[last] - profile.knots_mm[last - 1]);
        if (slope > limit) rows.bent[pixel] = 1;
        if (!blend.gain.empty())
          rows.log_gain[3 * pixel + c] =
              0.5f * std::log(blend.gain[static_cast<std::size_t>(channel) * pixels + pixel]);
      }
    }
  });
}

// The first `count` floats of the pixel's row.
void add_pixel(const BlendRows& rows, std::size_t pixel, float weight, float* half_log,
               std::size_t count) {
  for (std::size_t k = 0; k < rows.per_pixel; ++k) {
    const std::size_t at = pixel * rows.per_pixel + k;
    if (rows.weight[at] > 0)
      add_row(&rows.base_half_log[rows.index[at] * rows.row], weight * rows.weight[at], half_log,
              count);
  }
}

// With the minimum decay beyond the last knot, where the mixture's slope is less.
void add_bent_pixel(const BlendRows& rows, std::size_t pixel, float weight, float* half_log) {
  add_pixel(rows, pixel, weight, half_log, 3 * rows.own_knots);
  std::array<float, 6> ends{};  // the mixture's at the two last knots
  const std::size_t last = rows.own_knots - 1;
  for (std::size_t k = 0; k < rows.per_pixel; ++k) {
    const std::size_t at = pixel * rows.per_pixel + k;
    add_row(&rows.base_half_log[rows.index[at] * rows.row + 3 * (last - 1)], rows.weight[at],
            ends.data(), ends.size());
  }
  const float end = rows.knots[last];
  for (std::size_t c = 0; c < 3; ++c) {
    const float slope = std::min(static_cast<float>(-0.5 * min_tail_decay) / end,
                                 (ends[3 + c] - ends[c]) / (end - rows.knots[last - 1]));
    for (std::size_t k = rows.own_knots; k < rows.knots.size(); ++k)
      half_log[3 * k + c] += weight * (ends[3 + c] + slope * (rows.knots[k] - end));
  }
}

void eval_blend(const BlendRows& rows, int width, int height, double x, double y, float* half_log,
                float* support) {
  std::fill_n(half_log, rows.row, 0.0f);
  std::fill_n(support, 3, 0.0f);
  std::array<float, 3> shift{};
  for (const Corner& corner : find_corners(width, height, x, y)) {
    if (corner.weight == 0) continue;
    if (rows.bent[corner.pixel])
      add_bent_pixel(rows, corner.pixel, corner.weight, half_log);
    else
      add_pixel(rows, corner.pixel, corner.weight, half_log, rows.row);
    for (std::size_t c = 0; c < 3; ++c) {
      support[c] += corner.weight * rows.support[3 * corner.pixel + c];
      if (!rows.log_gain.empty()) shift[c] += corner.weight * rows.log_gain[3 * corner.pixel + c];
    }
  }
  if (rows.log_gain.empty()) return;
  for (std::size_t i = 0; i < rows.row; ++i) half_log[i] += shift[i % 3];
}

}  // namespace

ProfileField make_blend_field(const ProfileBlend& blend, double support) {
  ProfileField field;
  field.width = blend.width;
  field.height = blend.height;
  field.pixel_pitch_mm = blend.pixel_pitch_mm;
  field.boundary = blend.boundary;
  field.eta = blend.eta;
  field.max_support_mm = static_cast<float>(support);
  field.knots_mm = extend_knots(blend.knots_mm, support);
  field.monotone = true;  // bases do not rise, nor do tails
  const auto rows = std::make_shared<BlendRows>();
  rows->knots = field.knots_mm;
  rows->row = field.row();
  rows->per_pixel = static_cast<std::size_t>(blend.per_pixel);
  const auto last = static_cast<float>(blend.knots_mm.back());
  rows->own_knots = static_cast<std::size_t>(
      std::upper_bound(rows->knots.begin(), rows->knots.end(), last) - rows->knots.begin());
  fill_bases(blend, *rows);
  fill_pixels(blend, *rows);
  field.eval = [rows, width = blend.width, height = blend.height](
                   double x, double y, float* half_log, float* supports) {
    eval_blend(*rows, width, height, x, y, half_log, supports);
  };
  return field;
}

}  // namespace parian

// Similarity of pixels to strokes, checks of strokes, and masks from indicators.
#include "edit/stroke_reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/hot.h"
#include "math/fast_math.h"

namespace parian {
namespace {

// Rounding and the solver's tolerance are not worth a report.
constexpr float clamp_slack = 1e-4F;

// Indicators that sum to less are the solver's rounding more than a stroke's reach.
constexpr float least_reached = 1e-3F;
constexpr std::size_t chunk = 64;

// least[i] = min(least[i], |f_i - point|^2 / sigma + offset) for one chunk, features [dim][chunk]
PARIAN_HOT void lower_to(const float* PARIAN_RESTRICT features, const float* PARIAN_RESTRICT point,
                         std::size_t dims, float inverse, float offset,
                         float* PARIAN_RESTRICT least) {
  float sum[chunk] = {};
  for (std::size_t d = 0; d < dims; ++d) {
    const float p = point[d];
    for (std::size_t i = 0; i < chunk; ++i) {
      const float step = features[d * chunk + i] - p;
      sum[i] += step * step;
    }
  }
  for (std::size_t i = 0; i < chunk; ++i) {
    const float value = sum[i] * inverse + offset;
    least[i] = value < least[i] ? value : least[i];
  }
}

}  // namespace

void check_strokes(const Features& features, const std::vector<StrokePixel>& pixels, int strokes) {
  PARIAN_CHECK(strokes >= 1 && features.dims >= 1);
  PARIAN_CHECK_EQ(features.values.size(),
                  features.pixels() * static_cast<std::size_t>(features.dims));
  bool any = false;
  for (const StrokePixel& p : pixels) {
    PARIAN_CHECK_LT(p.pixel, features.pixels());
    PARIAN_CHECK(p.stroke >= 0 && p.stroke < strokes);
    if (!(p.weight >= 0) || p.weight > 1e6F)
      throw Error({.place = fmt::format("stroke {}, pixel {}", p.stroke, p.pixel),
                   .expected = "a weight in [0, 1e6]",
                   .found = fmt::format("{}", p.weight)});
    any = any || p.weight > 0;
  }
  if (!any)
    throw Error({.place = "strokes",
                 .expected = "at least one pixel with a positive weight",
                 .found = "none"});
}

void clamp_indicators(Propagation& propagation) {
  for (float& v : propagation.indicators) {
    if (v < -clamp_slack || v > 1 + clamp_slack) ++propagation.clamped;
    v = std::clamp(v, 0.0F, 1.0F);
  }
}

StrokeReach sample_strokes(const Features& features, const std::vector<StrokePixel>& pixels,
                           int strokes) {
  const auto dims = static_cast<std::size_t>(features.dims);
  StrokeReach reach;
  reach.points.resize(static_cast<std::size_t>(strokes));
  reach.offsets.resize(static_cast<std::size_t>(strokes));
  for (std::size_t s = 0; s < reach.points.size(); ++s) {
    std::vector<const StrokePixel*> list;
    for (const StrokePixel& p : pixels)
      if (static_cast<std::size_t>(p.stroke) == s && p.weight > 0) list.push_back(&p);
    const std::size_t samples = std::min(reach_samples, list.size());
    for (std::size_t i = 0; i < samples; ++i) {
      const StrokePixel& p = *list[(2 * i + 1) * list.size() / (2 * samples)];
      const float* f = &features.values[p.pixel * dims];
      reach.points[s].insert(reach.points[s].end(), f, f + dims);
      reach.offsets[s].push_back(-std::log(std::min(p.weight, 1.0F)));
    }
  }
  return reach;
}

void measure_reach(const StrokeReach& reach, const Features& features, std::size_t stroke,
                   double sigma, std::size_t begin, std::size_t end, float* z) {
  const auto dims = static_cast<std::size_t>(features.dims);
  std::vector<float> planes(dims * chunk);
  std::array<float, chunk> least{};
  for (std::size_t at = begin; at < end; at += chunk) {
    const std::size_t count = std::min(chunk, end - at);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t d = 0; d < dims; ++d)
        planes[d * chunk + i] = features.values[(at + i) * dims + d];
    least.fill(100);  // e^-100 counts as 0
    for (std::size_t i = 0; i < reach.offsets[stroke].size(); ++i)
      lower_to(planes.data(), &reach.points[stroke][i * dims], dims, static_cast<float>(1 / sigma),
               reach.offsets[stroke][i], least.data());
    for (std::size_t i = 0; i < count; ++i) z[at - begin + i] = -least[i];
  }
  exp_array(z, z, end - begin);
}

std::vector<float> normalise_indicators(const Propagation& propagation,
                                        const std::vector<bool>& positive) {
  PARIAN_CHECK_EQ(positive.size(), static_cast<std::size_t>(propagation.strokes));
  const std::size_t pixels = propagation.indicators.size() / positive.size();
  const bool all = std::find(positive.begin(), positive.end(), false) == positive.end();
  std::vector<float> sum(pixels, 0.0F), mask(pixels, 0.0F);
  for (std::size_t s = 0; s < positive.size(); ++s) {
    for (std::size_t i = 0; i < pixels; ++i) {
      const float e = propagation.indicators[s * pixels + i];
      sum[i] += e;
      if (positive[s]) mask[i] += e;
    }
  }
  for (std::size_t i = 0; i < pixels; ++i) {
    if (all)
      mask[i] = std::min(mask[i], 1.0F);
    else
      mask[i] /= std::max(sum[i], least_reached);
  }
  return mask;
}

}  // namespace parian

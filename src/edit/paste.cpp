#include "edit/paste.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "edit/poisson.h"
#include "image/color.h"

namespace parian {
namespace {

// From the middles of the state's pixels to the pattern's pixels.
struct Placement {
  double xx, xy, yx, yy;
  Point2 center, middle;

  Point2 operator()(double x, double y) const {
    const double dx = x - center.x, dy = y - center.y;
    return {middle.x + xx * dx + xy * dy, middle.y + yx * dx + yy * dy};
  }
};

Placement place(const PasteParams& params, const Pattern& pattern, Point2 center,
                const EditState& state) {
  const double angle = params.rotation_deg * std::numbers::pi / 180;
  const double ratio = state.pixel_pitch_mm / (pattern.pixel_pitch_mm * params.scale);
  const double c = ratio * std::cos(angle), s = ratio * std::sin(angle);
  const double mirror = params.flip ? -1 : 1;
  return {
      mirror * c, mirror * s,
      -s,         c,
      center,     {0.5 * (pattern.min.x + pattern.max.x), 0.5 * (pattern.min.y + pattern.max.y)}};
}

// Bilinear in the pattern's rectangle, whose border goes on beyond it.
struct Sampler {
  const Pattern& pattern;
  int x0, y0, x1, y1;  // pixels that may be read

  explicit Sampler(const Pattern& from) : pattern(from) {
    const auto low = [](double v, int size) {
      return std::clamp(static_cast<int>(std::floor(v)), 0, size - 1);
    };
    x0 = low(from.min.x, from.width);
    y0 = low(from.min.y, from.height);
    x1 = std::max(x0, low(from.max.x - 1e-9, from.width));
    y1 = std::max(y0, low(from.max.y - 1e-9, from.height));
  }

  double operator()(const double* plane, Point2 at) const {
    const double x = std::clamp(at.x - 0.5, 1.0 * x0, 1.0 * x1);
    const double y = std::clamp(at.y - 0.5, 1.0 * y0, 1.0 * y1);
    const int i = std::min(static_cast<int>(x), std::max(x0, x1 - 1));
    const int j = std::min(static_cast<int>(y), std::max(y0, y1 - 1));
    const int i1 = std::min(i + 1, x1), j1 = std::min(j + 1, y1);
    const double fx = x - i, fy = y - j;
    const auto value = [&](int px, int py) {
      return plane[static_cast<std::size_t>(py) * static_cast<std::size_t>(pattern.width) +
                   static_cast<std::size_t>(px)];
    };
    return (1 - fy) * ((1 - fx) * value(i, j) + fx * value(i1, j)) +
           fy * ((1 - fx) * value(i, j1) + fx * value(i1, j1));
  }

  bool covers(Point2 at) const {
    return at.x >= pattern.min.x && at.x < pattern.max.x && at.y >= pattern.min.y &&
           at.y < pattern.max.y;
  }
};

std::vector<std::uint8_t> find_region(const PasteParams& params, const Sampler& sampler,
                                      const Placement& placement, const EditState& state,
                                      const Mask& mask) {
  std::vector<std::uint8_t> region(state.pixels(), 0);
  std::size_t count = 0;
  for (int y = 0; y < state.height; ++y)
    for (int x = 0; x < state.width; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(state.width) +
                            static_cast<std::size_t>(x);
      region[i] = mask.weight[i] > 0 && sampler.covers(placement(x + 0.5, y + 0.5)) ? 1 : 0;
      count += region[i];
    }
  if (count == 0)
    throw Error({.expected = "a pattern that covers some of the selection",
                 .found = "one that covers none of it"});
  if (count == state.pixels() && !params.keep_mean)
    throw Error({.expected = "a selection with a border that gives the values, or 'keep_mean'",
                 .found = "the whole map, whose mean is not determined"});
  return region;
}

// Planes of one property for all channels: target, and the pattern where it lies.
struct Planes {
  std::vector<double> target, pattern;
};

void add_planes(const Plane& values, const Plane& pattern, const Sampler& sampler,
                const Placement& placement, const EditState& state, bool linear, Planes& planes) {
  const auto curve = [linear](double v) { return linear ? v : std::log(v); };
  const std::size_t source_pixels = pattern.size() / static_cast<std::size_t>(state.channels);
  Plane curved(pattern.size());
  std::transform(pattern.begin(), pattern.end(), curved.begin(), curve);
  const std::size_t first = planes.target.size();
  planes.target.resize(first + values.size());
  planes.pattern.resize(first + values.size());
  const auto width = static_cast<std::size_t>(state.width);
  parallel_for_blocks(values.size(), width, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t channel = i / state.pixels(), pixel = i % state.pixels();
      const std::size_t x = pixel % width, y = pixel / width;
      const Point2 at = placement(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
      planes.target[first + i] = curve(values[i]);
      planes.pattern[first + i] = sampler(&curved[channel * source_pixels], at);
    }
  });
}

std::vector<double> solve(const PasteParams& params, const Planes& planes, int count,
                          const std::vector<double>& strength, const EditState& state,
                          const std::vector<std::uint8_t>& region) {
  std::vector<double> gx, gy;
  make_gradients(state.width, state.height, count, planes.pattern, gx, gy);
  for (std::size_t i = 0; i < gx.size(); ++i) {
    gx[i] *= strength[i / state.pixels()];
    gy[i] *= strength[i / state.pixels()];
  }
  if (params.mixed) {
    std::vector<double> tx, ty;
    make_gradients(state.width, state.height, count, planes.target, tx, ty);
    mix_gradients(tx, ty, gx, gy);
  }
  return solve_poisson(state.width, state.height, count, region, planes.target, gx, gy, {});
}

// Towards the solution by the mask, in the domain that was solved in.
Plane take(const PasteParams& params, const Plane& before, const double* target,
           const double* solved, const Mask& mask, const std::vector<std::uint8_t>& region) {
  Plane after = before;
  const std::size_t pixels = region.size();
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (region[i % pixels] == 0) continue;
    const double change = static_cast<double>(mask.weight[i % pixels]) * (solved[i] - target[i]);
    after[i] = params.linear ? before[i] + change : before[i] * std::exp(change);
  }
  return after;
}

}  // namespace

ParamList describe(PasteParams& params) {
  return {{.name = "scale",
           .help = "enlarges the pattern",
           .target = &params.scale,
           .min = 1e-3,
           .max = 1e3},
          {.name = "rotation-deg",
           .help = "turns the pattern clockwise",
           .target = &params.rotation_deg,
           .min = -360,
           .max = 360,
           .unit = "degrees"},
          {.name = "flip", .help = "mirrors the pattern", .target = &params.flip},
          {.name = "mixed",
           .help = "keeps the map's own gradients where they are stronger",
           .target = &params.mixed},
          {.name = "linear",
           .help = "solves for albedo and range, not for their logarithms",
           .target = &params.linear},
          {.name = "keep-mean",
           .help = "allows a selection of the whole map, whose mean stays",
           .target = &params.keep_mean},
          {.name = "albedo",
           .help = "factor on the pattern's gradients of albedo",
           .target = &params.albedo,
           .min = 0,
           .max = 10},
          {.name = "range",
           .help = "factor on the pattern's gradients of range",
           .target = &params.range,
           .min = 0,
           .max = 10}};
}

Pattern make_pattern(const EditState& map) {
  return {map.width,         map.height,       map.channels, map.pixel_pitch_mm,
          albedo_plane(map), range_plane(map), {0, 0},       {1.0 * map.width, 1.0 * map.height}};
}

Pattern make_pattern(const Image& image, double pixel_pitch_mm, int channels) {
  Pattern pattern{image.width, image.height, channels, pixel_pitch_mm,
                  {},          {},           {0, 0},   {1.0 * image.width, 1.0 * image.height}};
  const std::size_t pixels =
      static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  const std::size_t values = pixels * static_cast<std::size_t>(channels);
  pattern.albedo.resize(values);
  pattern.range_mm.resize(values);
  for (std::size_t i = 0; i < pixels; ++i) {
    const float* rgb = &image.values[i * static_cast<std::size_t>(image.channels)];
    const float grey = image.channels >= 3 ? luminance(rgb[0], rgb[1], rgb[2]) : rgb[0];
    for (int c = 0; c < channels; ++c) {
      const float value = channels == 1 || image.channels < 3 ? grey : rgb[c];
      const std::size_t at = static_cast<std::size_t>(c) * pixels + i;
      pattern.albedo[at] = std::max(1e-3, static_cast<double>(value));
      pattern.range_mm[at] = std::max(1e-3, static_cast<double>(grey));
    }
  }
  return pattern;
}

void apply(const PasteParams& params, const Pattern& pattern, Point2 center, EditState& state,
           const Mask& mask, EditReport& report) {
  PARIAN_CHECK_EQ(mask.weight.size(), state.pixels());
  PARIAN_CHECK_EQ(pattern.channels, state.channels);
  const Sampler sampler(pattern);
  const Placement placement = place(params, pattern, center, state);
  const auto region = find_region(params, sampler, placement, state, mask);
  const Plane albedo = albedo_plane(state), range = range_plane(state);
  Planes planes;
  std::vector<double> strength;
  const auto channels = static_cast<std::size_t>(state.channels);
  if (params.albedo > 0) {
    add_planes(albedo, pattern.albedo, sampler, placement, state, params.linear, planes);
    strength.insert(strength.end(), channels, params.albedo);
  }
  if (params.range > 0) {
    add_planes(range, pattern.range_mm, sampler, placement, state, params.linear, planes);
    strength.insert(strength.end(), channels, params.range);
  }
  if (strength.empty()) return;
  const std::vector<double> solved =
      solve(params, planes, static_cast<int>(strength.size()), strength, state, region);
  if (params.albedo > 0)
    set_albedo(state, albedo,
               take(params, albedo, planes.target.data(), solved.data(), mask, region), report);
  if (params.range > 0) {
    const std::size_t first = solved.size() - range.size();
    set_range(state, range,
              take(params, range, &planes.target[first], &solved[first], mask, region), report);
  }
}

}  // namespace parian

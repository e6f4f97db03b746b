#include "edit/geometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/parallel.h"

namespace parian {
namespace {

// index(x, y) of the state for each pixel of the result.
template <typename Index>
EditState gather_by(const EditState& state, int width, int height, const Index& index) {
  std::vector<std::uint32_t> from;
  from.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto [sx, sy] = index(x, y);
      from.push_back(static_cast<std::uint32_t>(sy * state.width + sx));
    }
  return gather_pixels(state, from, width, height);
}

int reflect(int i, int size) {
  const int period = 2 * size;
  i = (i % period + period) % period;
  return i < size ? i : period - 1 - i;
}

// Pixels of the state that make one of the result, and how much of each.
struct Tap {
  std::uint32_t pixel = 0;
  float weight = 0;
};

// A tent over the new pixel: bilinear where it is smaller than the old ones, wider where larger.
void find_taps(const EditState& state, double x, double y, double reach_x, double reach_y,
               std::vector<Tap>& taps) {
  taps.clear();
  const auto first = [](double c, double reach) {
    return static_cast<int>(std::floor(c - 0.5 - reach)) + 1;
  };
  double sum = 0;
  for (int j = first(y, reach_y); j < y - 0.5 + reach_y; ++j)
    for (int i = first(x, reach_x); i < x - 0.5 + reach_x; ++i) {
      const double w =
          (1 - std::abs(i + 0.5 - x) / reach_x) * (1 - std::abs(j + 0.5 - y) / reach_y);
      if (!(w > 1e-9)) continue;
      const int pixel = reflect(j, state.height) * state.width + reflect(i, state.width);
      taps.push_back({static_cast<std::uint32_t>(pixel), static_cast<float>(w)});
      sum += w;
    }
  for (Tap& tap : taps) tap.weight = static_cast<float>(static_cast<double>(tap.weight) / sum);
}

struct Resampled {
  AlignedVector<float> rows;
  Plane albedo, range;
};

// ln P at knots of equal places in units of the range: rows of different pixels have different
// ranges, but their dilations are free, so mixing rows as they stand mixes ln S up to the range's
// ratio; exact where the ranges of the knots agree.
void resample_pixel(const EditState& state, const Plane& albedo, const Plane& range,
                    const std::vector<Tap>& taps, std::size_t pixel, std::size_t pixels,
                    Resampled& out) {
  const std::size_t n = state.knots_mm.size();
  for (std::size_t c = 0; c < static_cast<std::size_t>(state.channels); ++c) {
    double sum_albedo = 0, sum_range = 0;
    for (const Tap& tap : taps) {
      const auto w = static_cast<double>(tap.weight);
      sum_albedo += w * albedo[c * state.pixels() + tap.pixel];
      sum_range += w * range[c * state.pixels() + tap.pixel];
    }
    out.albedo[c * pixels + pixel] = sum_albedo;
    out.range[c * pixels + pixel] = sum_range;
    for (std::size_t k = 0; k < n; ++k) {
      const float* plane = &state.shapes->log_profile[(c * n + k) * state.pixels()];
      float sum = 0;
      for (const Tap& tap : taps) sum += tap.weight * plane[tap.pixel];
      out.rows[(c * n + k) * pixels + pixel] = taps.size() == 1 ? plane[taps[0].pixel] : sum;
    }
  }
}

}  // namespace

std::size_t max_pixels(const EditState& like) {
  const std::size_t bytes = static_cast<std::size_t>(like.channels) *
                            (like.knots_mm.size() * sizeof(float) + 4 * sizeof(double));
  return std::min(max_edit_pixels, max_edit_bytes / bytes);
}

EditState gather_pixels(const EditState& state, const std::vector<std::uint32_t>& index, int width,
                        int height) {
  EditState out = state;
  out.width = width;
  out.height = height;
  PARIAN_CHECK_EQ(index.size(), out.pixels());
  PARIAN_CHECK_LE(out.pixels(), max_pixels(state));
  auto shapes = std::make_shared<ShapePlanes>();
  shapes->log_profile = AlignedVector<float>(out.values() * state.knots_mm.size());
  auto gain = std::make_shared<Plane>(out.values());
  auto dilation = std::make_shared<Plane>(out.values());
  shapes->albedo.resize(out.values());
  shapes->range_mm.resize(out.values());
  const std::size_t pixels = out.pixels();
  const auto gather = [&](const auto& from, auto& to, std::size_t plane) {
    for (std::size_t i = 0; i < pixels; ++i)
      to[plane * pixels + i] = from[plane * state.pixels() + index[i]];
  };
  const auto channels = static_cast<std::size_t>(state.channels);
  parallel_for(channels * state.knots_mm.size(), [&](std::size_t plane) {
    gather(state.shapes->log_profile, shapes->log_profile, plane);
  });
  for (std::size_t c = 0; c < channels; ++c) {
    gather(state.shapes->albedo, shapes->albedo, c);
    gather(state.shapes->range_mm, shapes->range_mm, c);
    gather(*state.gain, *gain, c);
    gather(*state.dilation, *dilation, c);
  }
  out.shapes = std::move(shapes);
  out.gain = std::move(gain);
  out.dilation = std::move(dilation);
  return out;
}

EditState crop(const EditState& state, int x0, int y0, int x1, int y1) {
  PARIAN_CHECK(0 <= x0 && x0 < x1 && x1 <= state.width);
  PARIAN_CHECK(0 <= y0 && y0 < y1 && y1 <= state.height);
  return gather_by(state, x1 - x0, y1 - y0,
                   [&](int x, int y) { return std::pair(x + x0, y + y0); });
}

EditState tile(const EditState& state, int nx, int ny, bool mirror) {
  PARIAN_CHECK(nx > 0 && ny > 0);
  return gather_by(state, nx * state.width, ny * state.height, [&](int x, int y) {
    return mirror ? std::pair(reflect(x, state.width), reflect(y, state.height))
                  : std::pair(x % state.width, y % state.height);
  });
}

EditState flip(const EditState& state, bool horizontal, bool vertical) {
  return gather_by(state, state.width, state.height, [&](int x, int y) {
    return std::pair(horizontal ? state.width - 1 - x : x, vertical ? state.height - 1 - y : y);
  });
}

EditState rotate_quarters(const EditState& state, int quarters) {
  quarters = (quarters % 4 + 4) % 4;
  if (quarters == 0) return state;
  if (quarters == 2) return flip(state, true, true);
  return gather_by(state, state.height, state.width, [&](int x, int y) {
    return quarters == 1 ? std::pair(y, state.height - 1 - x) : std::pair(state.width - 1 - y, x);
  });
}

EditState resample(const EditState& state, int width, int height, const GridMap& map,
                   double pixel_pitch_mm) {
  PARIAN_CHECK(width > 0 && height > 0);
  EditState out = state;
  out.width = width;
  out.height = height;
  out.pixel_pitch_mm = pixel_pitch_mm;
  PARIAN_CHECK_LE(out.pixels(), max_pixels(state));
  Resampled planes;
  planes.rows = AlignedVector<float>(out.values() * state.knots_mm.size());
  planes.albedo.resize(out.values());
  planes.range.resize(out.values());
  const Plane albedo = albedo_plane(state), range = range_plane(state);
  const double reach_x = std::max(1.0, std::abs(map.xx) + std::abs(map.xy));
  const double reach_y = std::max(1.0, std::abs(map.yx) + std::abs(map.yy));
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
    std::vector<Tap> taps;
    for (int x = 0; x < width; ++x) {
      const double cx = x + 0.5, cy = static_cast<double>(y) + 0.5;
      find_taps(state, map.xx * cx + map.xy * cy + map.x0, map.yx * cx + map.yy * cy + map.y0,
                reach_x, reach_y, taps);
      resample_pixel(state, albedo, range, taps,
                     y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x),
                     out.pixels(), planes);
    }
  });
  out.shapes =
      make_shape_planes(std::move(planes.rows), state.knots_mm, out.pixels(), state.channels);
  set_properties(out, planes.albedo, planes.range);
  return out;
}

EditState resample_to_pitch(const EditState& state, double pixel_pitch_mm) {
  const double ratio = pixel_pitch_mm / state.pixel_pitch_mm;
  const auto size = [&](int pixels) {
    return std::max(1, static_cast<int>(std::lround(pixels / ratio)));
  };
  GridMap map;
  map.xx = map.yy = ratio;
  map.x0 = 0.5 * (state.width - ratio * size(state.width));
  map.y0 = 0.5 * (state.height - ratio * size(state.height));
  return resample(state, size(state.width), size(state.height), map, pixel_pitch_mm);
}

EditState rotate(const EditState& state, double degrees) {
  const double quarters = degrees / 90;
  if (quarters == std::floor(quarters))
    return rotate_quarters(state, static_cast<int>(std::fmod(quarters, 4)));
  const double angle = degrees * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
  const double mx = 0.5 * state.width, my = 0.5 * state.height;
  // A new pixel lies where the old one was before the turn: by the inverse rotation.
  return resample(state, state.width, state.height,
                  {c, s, mx - c * mx - s * my, -s, c, my + s * mx - c * my}, state.pixel_pitch_mm);
}

}  // namespace parian

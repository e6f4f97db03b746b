#include "material/plane_eval_internal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/hot.h"
#include "math/fast_math.h"

namespace parian {
namespace {

// out = (a + b) / 2: the same bits when a and b are exchanged.
PARIAN_HOT void mean_rows(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                          float* PARIAN_RESTRICT out, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) out[i] = 0.5f * (a[i] + b[i]);
}

std::size_t pixels_of(const ProfilePlanes& planes) {
  return static_cast<std::size_t>(planes.width) * static_cast<std::size_t>(planes.height);
}

// ln P_x(r) for all pixels, r within the knots.
void eval_inside(const ProfilePlanes& planes, double r_mm, float* out) {
  const auto& knots = *planes.knots_mm;
  const auto found = std::upper_bound(knots.begin(), knots.end(), r_mm) - knots.begin();
  const auto upper =
      static_cast<std::size_t>(std::min<std::ptrdiff_t>(found, std::ssize(knots) - 1));
  const double w = (r_mm - knots[upper - 1]) / (knots[upper] - knots[upper - 1]);
  planes.interpolate(upper - 1, static_cast<float>(w), out);
  if (planes.gain == nullptr) return;
  for (std::size_t i = 0; i < pixels_of(planes); ++i) out[i] += std::log(planes.gain[i]);
}

// The same beyond the last knot: the last slope, at least the minimum decay, up to the support.
void eval_beyond(const ProfilePlanes& planes, double r_mm, float* out) {
  const auto& knots = *planes.knots_mm;
  const std::size_t last = knots.size() - 1, pixels = pixels_of(planes);
  std::vector<float> end(pixels), before(pixels), top(pixels);
  planes.interpolate(last - 1, 1, end.data());
  planes.interpolate(last - 1, 0, before.data());
  planes.top(top.data());
  const double beyond = r_mm - knots[last], width = knots[last] - knots[last - 1];
  const double level = std::log(support_threshold);
  for (std::size_t i = 0; i < pixels; ++i) {
    const double slope =
        std::min(-min_tail_decay / knots[last], static_cast<double>(end[i] - before[i]) / width);
    const double value = static_cast<double>(end[i]) + slope * beyond;
    const bool inside =
        value >= static_cast<double>(top[i]) + level && r_mm <= support_limit * knots[last];
    const double shift = planes.gain == nullptr ? 0 : std::log(static_cast<double>(planes.gain[i]));
    out[i] = inside ? static_cast<float>(value + shift) : -std::numeric_limits<float>::infinity();
  }
}

void eval_plane(const ProfilePlanes& planes, double r_mm, float* out) {
  constexpr double slack = 1 + 1e-9;  // an offset on the last knot is inside
  const double last = planes.knots_mm->back();
  if (planes.dilated) {
    for (int y = 0; y < planes.height; ++y)
      for (int x = 0; x < planes.width; ++x)
        *out++ = static_cast<float>(eval_log_profile(planes.profile(x, y), r_mm));
  } else if (r_mm <= last * slack) {
    eval_inside(planes, std::min(r_mm, last), out);
  } else {
    eval_beyond(planes, r_mm, out);
  }
}

}  // namespace

void eval_planes(const ProfilePlanes& planes, Offset offset, float* slice) {
  std::vector<float> log_p(pixels_of(planes));
  eval_plane(planes, length_px(offset) * planes.pixel_pitch_mm, log_p.data());
  pair_planes(planes.width, planes.height, offset, log_p.data(), slice);
}

void pair_planes(int grid_width, int grid_height, Offset offset, const float* log_p, float* slice) {
  TableHeader grid;
  grid.width = grid_width;
  grid.height = grid_height;
  const PixelRange range = pairs_in_grid(grid, offset);
  std::fill_n(slice, grid.pixels(), std::numeric_limits<float>::quiet_NaN());
  if (range.x0 >= range.x1 || range.y0 >= range.y1) return;
  const auto width = static_cast<std::size_t>(grid_width);
  const auto count = static_cast<std::size_t>(range.x1 - range.x0);
  std::vector<float> log_r(count);
  for (int y = range.y0; y < range.y1; ++y) {
    const std::size_t from =
        static_cast<std::size_t>(y) * width + static_cast<std::size_t>(range.x0);
    const auto to = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(from) +
                                             offset.dy * grid_width + offset.dx);
    mean_rows(&log_p[from], &log_p[to], log_r.data(), count);  // Eq. 3 in logarithms
    exp_array(log_r.data(), slice + from, count);
  }
}

void check_knots(const std::vector<double>& knots, const std::string& name,
                 const std::string& place) {
  if (knots.size() < 2 || knots[0] != 0)
    throw Error(
        {name, place, "two or more knots from 0",
         knots.empty() ? "none" : fmt::format("{} that begin at {}", knots.size(), knots[0])});
  for (std::size_t k = 1; k < knots.size(); ++k)
    if (!(knots[k] > knots[k - 1]) || std::isinf(knots[k]))
      throw Error({name, fmt::format("knots_mm[{}]", k),
                   fmt::format("a finite value > {}", knots[k - 1]), fmt::format("{}", knots[k])});
}

void check_values(const std::vector<float>& values, std::size_t expected, float min,
                  const std::string& name, const std::string& place) {
  if (values.size() != expected)
    throw Error(
        {name, place, fmt::format("{} values", expected), fmt::format("{}", values.size())});
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) || values[i] < min)
      throw Error({name, fmt::format("{}, value {}", place, i),
                   min > 0    ? "a finite value > 0"
                   : min == 0 ? "a finite value >= 0"
                              : "a finite value",
                   fmt::format("{}", values[i])});
}

}  // namespace parian

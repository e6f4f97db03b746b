#include "material/profile_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "base/hot.h"
#include "base/random.h"
#include "math/fast_math.h"

namespace parian {
namespace {

// out = (1 - w) a + w b
PARIAN_HOT void blend_rows(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b, float w,
                           float* PARIAN_RESTRICT out, std::size_t count) {
  const float v = 1 - w;
  for (std::size_t i = 0; i < count; ++i) out[i] = v * a[i] + w * b[i];
}

// out = (a + b) / 2: the same bits when a and b are exchanged.
PARIAN_HOT void mean_rows(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                          float* PARIAN_RESTRICT out, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) out[i] = 0.5f * (a[i] + b[i]);
}

void check_plane(const ProfileMap& map, const std::vector<float>& plane, const std::string& name,
                 const char* dataset, bool optional, std::size_t knots, float min) {
  if (optional && plane.empty()) return;
  const std::size_t expected = static_cast<std::size_t>(map.channels) * knots * map.pixels();
  if (plane.size() != expected)
    throw Error(
        {name, dataset, fmt::format("{} values", expected), fmt::format("{}", plane.size())});
  for (std::size_t i = 0; i < plane.size(); ++i)
    if (!std::isfinite(plane[i]) || plane[i] < min)
      throw Error({name, fmt::format("{}, value {}", dataset, i),
                   min >= 0 ? "a finite value > 0" : "a finite value",
                   fmt::format("{}", plane[i])});
}

// ln P_x(r) for all pixels, when the knots are not dilated and r is within them.
void eval_plane_inside(const ProfileMap& map, int channel, double r_mm, float* out) {
  const auto& knots = map.knots_mm;
  const auto found = std::upper_bound(knots.begin(), knots.end(), r_mm) - knots.begin();
  const auto upper =
      static_cast<std::size_t>(std::min<std::ptrdiff_t>(found, std::ssize(knots) - 1));
  const double w = (r_mm - knots[upper - 1]) / (knots[upper] - knots[upper - 1]);
  blend_rows(knot_plane(map, channel, static_cast<int>(upper) - 1),
             knot_plane(map, channel, static_cast<int>(upper)), static_cast<float>(w), out,
             map.pixels());
  if (map.gain.empty()) return;
  const float* gain = map.gain.data() + static_cast<std::size_t>(channel) * map.pixels();
  for (std::size_t i = 0; i < map.pixels(); ++i) out[i] += std::log(gain[i]);
}

// The same beyond the last knot: the last slope, at least the minimum decay, up to the support.
void eval_plane_beyond(const ProfileMap& map, int channel, double r_mm, float* out) {
  const auto& knots = map.knots_mm;
  const std::size_t last = knots.size() - 1, pixels = map.pixels();
  const float* end = knot_plane(map, channel, static_cast<int>(last));
  const float* before = knot_plane(map, channel, static_cast<int>(last) - 1);
  std::vector<float> top(end, end + pixels);
  for (std::size_t k = 0; k < last; ++k) {
    const float* plane = knot_plane(map, channel, static_cast<int>(k));
    for (std::size_t i = 0; i < pixels; ++i) top[i] = std::max(top[i], plane[i]);
  }
  const double beyond = r_mm - knots[last], width = knots[last] - knots[last - 1];
  const double level = std::log(support_threshold);
  const float* gain =
      map.gain.empty() ? nullptr : map.gain.data() + static_cast<std::size_t>(channel) * pixels;
  for (std::size_t i = 0; i < pixels; ++i) {
    const double slope =
        std::min(-min_tail_decay / knots[last], static_cast<double>(end[i] - before[i]) / width);
    const double value = static_cast<double>(end[i]) + slope * beyond;
    const bool inside =
        value >= static_cast<double>(top[i]) + level && r_mm <= support_limit * knots[last];
    const double shift = gain == nullptr ? 0 : std::log(static_cast<double>(gain[i]));
    out[i] = inside ? static_cast<float>(value + shift) : -std::numeric_limits<float>::infinity();
  }
}

void eval_plane(const ProfileMap& map, int channel, double r_mm, float* out) {
  constexpr double slack = 1 + 1e-9;  // an offset on the last knot is inside
  const double last = map.knots_mm.back();
  if (map.dilation.empty() && r_mm <= last * slack) {
    eval_plane_inside(map, channel, std::min(r_mm, last), out);
  } else if (map.dilation.empty()) {
    eval_plane_beyond(map, channel, r_mm, out);
  } else {
    for (int y = 0; y < map.height; ++y)
      for (int x = 0; x < map.width; ++x)
        *out++ = static_cast<float>(eval_log_profile(get_profile(map, channel, x, y), r_mm));
  }
}

}  // namespace

bool is_held_out(const HoldOut& hold_out, int x, int y, Offset offset) {
  if (!(hold_out.fraction > 0) || offset == Offset{}) return false;
  if (offset.dy < 0 || (offset.dy == 0 && offset.dx < 0)) {  // the pair's end in the half plane
    x += offset.dx;
    y += offset.dy;
    offset = {-offset.dx, -offset.dy};
  }
  const auto pack = [](int a, int b) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32u) |
           static_cast<std::uint32_t>(b);
  };
  const std::uint64_t hash =
      hash_u64(hash_u64(hold_out.seed, pack(offset.dx, offset.dy)), pack(x, y));
  return hash_to_uniform(hash) < hold_out.fraction;
}

void check(const ProfileMap& map, const std::string& name) {
  if (map.width < 1 || map.height < 1 || (map.channels != 1 && map.channels != 3))
    throw Error({name, "dataset 'log_profile'", "[C][K][H][W] with C = 1 or 3",
                 fmt::format("C = {}, H = {}, W = {}", map.channels, map.height, map.width)});
  if (!(map.pixel_pitch_mm > 0) || std::isinf(map.pixel_pitch_mm))
    throw Error({name, "attribute 'pixel_pitch_mm'", "a finite length > 0",
                 fmt::format("{}", map.pixel_pitch_mm)});
  const auto& knots = map.knots_mm;
  if (knots.size() < 2 || knots[0] != 0)
    throw Error({name, "dataset 'knots_mm'", "two or more knots from 0",
                 knots.empty() ? "none" : fmt::format("{} from {}", knots.size(), knots[0])});
  for (std::size_t k = 1; k < knots.size(); ++k)
    if (!(knots[k] > knots[k - 1]) || std::isinf(knots[k]))
      throw Error({name, fmt::format("knots_mm[{}]", k),
                   fmt::format("a finite value > {}", knots[k - 1]), fmt::format("{}", knots[k])});
  const float any = -std::numeric_limits<float>::max();
  const float positive = std::numeric_limits<float>::min();
  check_plane(map, map.log_profile, name, "dataset 'log_profile'", false, knots.size(), any);
  check_plane(map, map.gain, name, "dataset 'gain'", true, 1, positive);
  check_plane(map, map.dilation, name, "dataset 'dilation'", true, 1, positive);
}

ProfileMap make_profile_map(int width, int height, int channels, double pixel_pitch_mm,
                            std::vector<double> knots_mm, float log_profile) {
  ProfileMap map;
  map.width = width;
  map.height = height;
  map.channels = channels;
  map.pixel_pitch_mm = pixel_pitch_mm;
  map.knots_mm = std::move(knots_mm);
  map.log_profile.assign(static_cast<std::size_t>(channels) * map.knots_mm.size() * map.pixels(),
                         log_profile);
  return map;
}

void eval_slice(const ProfileMap& map, int channel, Offset offset, float* slice) {
  TableHeader grid;
  grid.width = map.width;
  grid.height = map.height;
  const PixelRange range = pairs_in_grid(grid, offset);
  std::fill_n(slice, map.pixels(), std::numeric_limits<float>::quiet_NaN());
  if (range.x0 >= range.x1 || range.y0 >= range.y1) return;

  std::vector<float> log_p(map.pixels());
  eval_plane(map, channel, length_px(offset) * map.pixel_pitch_mm, log_p.data());
  const auto width = static_cast<std::size_t>(map.width);
  const auto count = static_cast<std::size_t>(range.x1 - range.x0);
  std::vector<float> log_r(count);
  for (int y = range.y0; y < range.y1; ++y) {
    const std::size_t from =
        static_cast<std::size_t>(y) * width + static_cast<std::size_t>(range.x0);
    const auto to = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(from) +
                                             offset.dy * map.width + offset.dx);
    mean_rows(&log_p[from], &log_p[to], log_r.data(), count);  // Eq. 3 in logarithms
    exp_array(log_r.data(), slice + from, count);
  }
}

}  // namespace parian

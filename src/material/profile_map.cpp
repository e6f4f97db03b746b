#include "material/profile_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/hot.h"
#include "base/random.h"
#include "material/plane_eval_internal.h"

namespace parian {
namespace {

// out = (1 - w) a + w b
PARIAN_HOT void blend_rows(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b, float w,
                           float* PARIAN_RESTRICT out, std::size_t count) {
  const float v = 1 - w;
  for (std::size_t i = 0; i < count; ++i) out[i] = v * a[i] + w * b[i];
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
  check_knots(map.knots_mm, name, "dataset 'knots_mm'");
  const float any = -std::numeric_limits<float>::max();
  const float positive = std::numeric_limits<float>::min();
  const std::size_t plane = static_cast<std::size_t>(map.channels) * map.pixels();
  check_values(map.log_profile, plane * map.knots_mm.size(), any, name, "dataset 'log_profile'");
  if (!map.gain.empty()) check_values(map.gain, plane, positive, name, "dataset 'gain'");
  if (!map.dilation.empty())
    check_values(map.dilation, plane, positive, name, "dataset 'dilation'");
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
  ProfilePlanes planes{.width = map.width,
                       .height = map.height,
                       .pixel_pitch_mm = map.pixel_pitch_mm,
                       .knots_mm = &map.knots_mm,
                       .dilated = !map.dilation.empty()};
  if (!map.gain.empty())
    planes.gain = map.gain.data() + static_cast<std::size_t>(channel) * map.pixels();
  planes.interpolate = [&](std::size_t knot, float w, float* out) {
    blend_rows(knot_plane(map, channel, static_cast<int>(knot)),
               knot_plane(map, channel, static_cast<int>(knot) + 1), w, out, map.pixels());
  };
  planes.top = [&](float* out) {
    std::copy_n(knot_plane(map, channel, 0), map.pixels(), out);
    for (std::size_t k = 1; k < map.knots_mm.size(); ++k) {
      const float* plane = knot_plane(map, channel, static_cast<int>(k));
      for (std::size_t i = 0; i < map.pixels(); ++i) out[i] = std::max(out[i], plane[i]);
    }
  };
  planes.profile = [&](int x, int y) { return get_profile(map, channel, x, y); };
  eval_planes(planes, offset, slice);
}

}  // namespace parian

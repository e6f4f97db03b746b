#include "edit/retarget.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.h"

namespace parian {
namespace {

std::vector<float> narrow(const Plane& values) {
  if (std::all_of(values.begin(), values.end(), [](double v) { return v == 1; })) return {};
  return {values.begin(), values.end()};
}

}  // namespace

ProfileBlend retarget(const ProfileBlend& blend, const EditState& before, const EditState& after) {
  if (after.width != blend.width || after.height != blend.height)
    throw Error({.expected = "edits that keep the grid, as the material is compressed: edit the "
                             "map and compress it again",
                 .found = fmt::format("{} x {} pixels of {} x {}", after.width, after.height,
                                      blend.width, blend.height)});
  if (after.shapes != before.shapes)
    throw Error({.expected = "edits of albedo and range alone, as the material is compressed: edit "
                             "the map and compress it again",
                 .found = "new profile shapes"});
  ProfileBlend edited = blend;
  edited.gain = narrow(*after.gain);
  edited.dilation = narrow(*after.dilation);
  return edited;
}

EditState make_base_state(const ProfileBlend& blend) {
  ProfileMap map = make_profile_map(static_cast<int>(blend.bases()), 1, blend.channels,
                                    blend.pixel_pitch_mm, blend.knots_mm);
  map.boundary = blend.boundary;
  map.eta = blend.eta;
  for (std::size_t b = 0; b < blend.bases(); ++b)
    for (int c = 0; c < blend.channels; ++c)
      for (std::size_t k = 0; k < blend.knots_mm.size(); ++k)
        knot_plane(map, c, static_cast<int>(k))[b] = base_profile(blend, b, c)[k];
  return make_edit_state(map);
}

ProfileBlend retarget_bases(const ProfileBlend& blend, const EditState& bases) {
  if (bases.width != static_cast<int>(blend.bases()) || bases.height != 1)
    throw Error({.expected = fmt::format("edits that keep the {} base materials", blend.bases()),
                 .found = fmt::format("{} x {}", bases.width, bases.height)});
  ProfileBlend edited = blend;
  const std::size_t knots = blend.knots_mm.size();
  for (std::size_t b = 0; b < blend.bases(); ++b)
    for (int c = 0; c < blend.channels; ++c) {
      Profile profile = get_profile(bases, c, static_cast<int>(b), 0);
      profile.support_mm = std::numeric_limits<double>::infinity();  // the tail goes on
      float* out = &edited.base_log_profile[(b * static_cast<std::size_t>(blend.channels) +
                                             static_cast<std::size_t>(c)) *
                                            knots];
      for (std::size_t k = 0; k < knots; ++k) {
        out[k] = static_cast<float>(eval_log_profile(profile, blend.knots_mm[k]));
        if (k > 0) out[k] = std::min(out[k], out[k - 1]);
      }
    }
  if (blend.grid != BlendGrid{}) snap_to_grid(edited, blend.grid);
  return edited;
}

}  // namespace parian

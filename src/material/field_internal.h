// What the fields of the material models share.
#pragma once

#include <array>
#include <vector>

#include "material/profile_field.h"

namespace parian {

// A pixel around a point, with its bilinear weight: centres at integers, clamped to the grid.
struct Corner {
  std::size_t pixel = 0;
  float weight = 0;
};
std::array<Corner, 4> find_corners(int width, int height, double x, double y);

// A map's profile into one that is used again and again.
void get_profile(const ProfileMap& map, int channel, int x, int y, Profile& profile);

inline constexpr double tail_step = 1.12;  // from knot to knot beyond the model's own

// The model's own knots, and a few over the tail so that brackets stay tight there. Of knots that
// floats hardly tell apart the first is kept.
std::vector<float> extend_knots(const std::vector<double>& knots, double support);

// Of a blend without dilation: keeps its bases, indices and weights, not its pixels' profiles.
ProfileField make_blend_field(const ProfileBlend& blend, double support);

}  // namespace parian

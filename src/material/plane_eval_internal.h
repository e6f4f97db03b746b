// R_d at one offset for all pixels, from planes of ln P: what profile maps and blends share.
#pragma once

#include <functional>

#include "material/profile_map.h"

namespace parian {

// One channel of a material with a profile at each pixel of a grid.
struct ProfilePlanes {
  int width = 0, height = 0;
  double pixel_pitch_mm = 1;
  const std::vector<double>* knots_mm = nullptr;
  const float* gain = nullptr;  // [y][x], null: 1
  bool dilated = false;         // then only `profile` is asked
  // (1 - w) ln P(knot) + w ln P(knot + 1) without the gain, all pixels.
  std::function<void(std::size_t knot, float w, float* out)> interpolate;
  std::function<void(float* out)> top;  // the largest ln P of each pixel, without the gain
  std::function<Profile(int x, int y)> profile;
};

void eval_planes(const ProfilePlanes& planes, Offset offset, float* slice);

// R_d of the pairs of pixels at an offset from ln P of all pixels at that distance (Eq. 3); NaN
// outside the grid.
void pair_planes(int width, int height, Offset offset, const float* log_p, float* slice);

// Throws Error with `name` as its file: two or more finite knots that increase from 0.
void check_knots(const std::vector<double>& knots_mm, const std::string& name,
                 const std::string& place);

// Throws Error unless all values are finite and at least `min`, and as many as expected.
void check_values(const std::vector<float>& values, std::size_t expected, float min,
                  const std::string& name, const std::string& place);

}  // namespace parian

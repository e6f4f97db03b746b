// How fast the device adds squares into a float picture, with nothing computed: the limit that
// splatting is judged by.
#pragma once

namespace parian {

struct SplatRate {
  double splats_per_s = 0;
  double pixels_per_s = 0;
};
// `count` squares of side x side pixels into a picture of the size given, 32-bit floats.
SplatRate measure_splat_rate(int width, int height, int count, int side);

}  // namespace parian

// Small blends for tests and the fuzzer.
#pragma once

#include "base/random.h"
#include "material/profile_blend.h"

namespace parian {

// 7 x 5 pixels, 4 knots, random values that pass check().
inline ProfileBlend make_blend(int per_pixel, int bases = 9, int channels = 3) {
  ProfileBlend blend;
  blend.width = 7;
  blend.height = 5;
  blend.channels = channels;
  blend.per_pixel = per_pixel;
  blend.pixel_pitch_mm = 0.5;
  blend.eta = 1.4;
  blend.boundary = Boundary::included;
  blend.knots_mm = {0, 0.5, 1, 2};
  blend.hold_out = {0.1, 12345678901234567890u};
  blend.provenance = "{\"kind\": \"test\"}";
  Rng rng = make_rng(3);
  for (int i = 0; i < bases * channels; ++i) {
    float value = static_cast<float>(sample_normal(rng));
    for (std::size_t k = 0; k < blend.knots_mm.size(); ++k)
      blend.base_log_profile.push_back(value -= static_cast<float>(sample_uniform(rng)));
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(per_pixel) * blend.pixels(); ++i)
    blend.index.push_back(
        static_cast<std::uint16_t>(sample_u32(rng) % static_cast<std::uint32_t>(bases)));
  for (std::size_t i = 0; i < static_cast<std::size_t>(per_pixel - 1) * blend.pixels(); ++i)
    blend.weight.push_back(static_cast<float>(sample_uniform(rng) / per_pixel));
  return blend;
}

}  // namespace parian

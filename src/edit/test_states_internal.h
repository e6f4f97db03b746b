// Random maps for tests: non-increasing profiles on knots that widen, some with short windows.
#pragma once

#include "base/random.h"
#include "edit/edit_state.h"

namespace parian {

inline double random_between(Rng& rng, double from, double to) {
  return from + (to - from) * sample_uniform(rng);
}

inline ProfileMap make_random_map(std::uint64_t seed, int width, int height, int channels,
                                  std::vector<double> knots = {0, 0.5, 1, 1.75, 2.5, 4, 6}) {
  Rng rng = make_rng(seed, 77);
  ProfileMap map = make_profile_map(width, height, channels, 0.5, std::move(knots));
  const double drop = random_between(rng, 0.2, 3.0);
  for (int c = 0; c < channels; ++c)
    for (std::size_t i = 0; i < map.pixels(); ++i) {
      double value = random_between(rng, -4, 0);
      for (int k = 0; k < static_cast<int>(map.knots_mm.size()); ++k) {
        knot_plane(map, c, k)[i] = static_cast<float>(value);
        value -= random_between(rng, 0, drop);
      }
    }
  const std::size_t values = map.pixels() * static_cast<std::size_t>(channels);
  for (std::size_t i = 0; i < values; ++i) {
    map.gain.push_back(static_cast<float>(random_between(rng, 0.3, 3)));
    map.dilation.push_back(static_cast<float>(random_between(rng, 0.7, 2)));
  }
  return map;
}

inline EditState make_random_state(std::uint64_t seed, int width, int height, int channels = 3) {
  return make_edit_state(make_random_map(seed, width, height, channels));
}

// Zero, one and anything between.
inline Mask make_random_mask(std::uint64_t seed, int width, int height) {
  Rng rng = make_rng(seed, 78);
  Mask mask = make_mask(width, height, 0);
  for (float& weight : mask.weight)
    weight = static_cast<float>(std::min(1.0, std::max(0.0, random_between(rng, -0.3, 1.3))));
  return mask;
}

}  // namespace parian

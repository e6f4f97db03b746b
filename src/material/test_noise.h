// Synthetic noise for tables, of tests and benchmarks.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/random.h"
#include "material/bssrdf_table.h"

namespace parian {

// Photon counts of `gain` each, then normal noise of `floor`; the header says so.
inline void add_noise(BssrdfTable& table, double gain, double floor, std::uint64_t seed) {
  const auto channels = static_cast<std::size_t>(table.header.channels);
  table.header.noise_gain.assign(channels, gain);
  table.header.noise_floor.assign(channels, floor);
  Rng rng = make_rng(seed);
  for (float& value : table.reflectance) {
    if (std::isnan(value)) continue;
    double noisy = static_cast<double>(value);
    if (gain > 0) noisy = gain * sample_poisson(rng, noisy / gain);
    value = static_cast<float>(noisy + floor * sample_normal(rng));
  }
}

// The gain when `photons` enter per pixel.
inline double photon_gain(const BssrdfTable& table, double photons) {
  return 1 / (photons * table.header.pixel_pitch_mm * table.header.pixel_pitch_mm);
}

}  // namespace parian

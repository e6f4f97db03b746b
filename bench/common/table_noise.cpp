#include "bench/common/table_noise.h"

#include <cmath>

#include "base/random.h"

namespace parian {

BssrdfTable add_noise(const BssrdfTable& table, double gain, double floor, std::uint64_t seed) {
  BssrdfTable noisy = table;
  const auto channels = static_cast<std::size_t>(table.header.channels);
  noisy.header.noise_gain.assign(channels, gain);
  noisy.header.noise_floor.assign(channels, floor);
  Rng rng = make_rng(seed);
  for (float& value : noisy.reflectance) {
    if (std::isnan(value)) continue;
    double sum = static_cast<double>(value);
    if (gain > 0) sum = gain * sample_poisson(rng, sum / gain);
    value = static_cast<float>(sum + floor * sample_normal(rng));
  }
  return noisy;
}

double photon_gain(const BssrdfTable& table, double photons) {
  return 1 / (photons * table.header.pixel_pitch_mm * table.header.pixel_pitch_mm);
}

}  // namespace parian

#include "base/random.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace parian {

Rng make_rng(std::uint64_t seed, std::uint64_t stream) {
  Rng rng{.state = 0, .increment = (stream << 1u) | 1u};
  sample_u32(rng);
  rng.state += hash_u64(seed);
  sample_u32(rng);
  return rng;
}

std::uint32_t sample_u32(Rng& rng) {
  const std::uint64_t old = rng.state;
  rng.state = old * 6364136223846793005u + rng.increment;
  const auto xorshifted = static_cast<std::uint32_t>(((old >> 18u) ^ old) >> 27u);
  const auto rotation = static_cast<std::uint32_t>(old >> 59u);
  return (xorshifted >> rotation) | (xorshifted << ((-rotation) & 31u));
}

double sample_uniform(Rng& rng) {
  const std::uint64_t high = sample_u32(rng);
  return hash_to_uniform((high << 32u) | sample_u32(rng));
}

double sample_normal(Rng& rng) {
  const double u = 1.0 - sample_uniform(rng);
  const double v = sample_uniform(rng);
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

double sample_poisson(Rng& rng, double mean) {
  if (mean <= 0) return 0;
  if (mean > 50) return std::max(0.0, std::round(mean + std::sqrt(mean) * sample_normal(rng)));
  const double limit = std::exp(-mean);
  double count = -1, product = 1;
  do {
    product *= sample_uniform(rng);
    count += 1;
  } while (product > limit);
  return count;
}

}  // namespace parian

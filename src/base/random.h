// Seeded random numbers. A generator is a value; two with the same seed and stream give the same
// numbers everywhere. hash_u64 is the counter-based form: a number for each key, without a state.
#pragma once

#include <cstdint>

namespace parian {

// PCG-XSH-RR 64/32 (O'Neill 2014).
struct Rng {
  std::uint64_t state = 0;
  std::uint64_t increment = 1;
};

Rng make_rng(std::uint64_t seed, std::uint64_t stream = 0);
std::uint32_t sample_u32(Rng& rng);
// Uniform in [0, 1) with 53 bits.
double sample_uniform(Rng& rng);
// Standard normal (Box-Muller, one of the pair).
double sample_normal(Rng& rng);
// A Poisson count; above a mean of 50 the rounded normal of the same variance.
double sample_poisson(Rng& rng, double mean);

// SplitMix64 finaliser (Steele, Lea, Flood 2014): a bijection with good avalanche.
constexpr std::uint64_t hash_u64(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15u;
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
  return key ^ (key >> 31);
}
constexpr std::uint64_t hash_u64(std::uint64_t a, std::uint64_t b) {
  return hash_u64(hash_u64(a) ^ b);
}
// Maps a hash to [0, 1).
constexpr double hash_to_uniform(std::uint64_t hash) {
  return static_cast<double>(hash >> 11) * 0x1.0p-53;
}

}  // namespace parian

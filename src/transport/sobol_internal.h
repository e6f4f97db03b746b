// Two dimensions of Sobol's sequence with hashed Owen scrambling (Laine and Karras 2011; Burley
// 2020): stratified points, of which any power of two is a (0, m, 2)-net, different for each seed.
#pragma once

#include <cstdint>
#include <vector>

#include "base/random.h"
#include "math/vec.h"

namespace parian {

// Coordinates with their binary digits reversed: the first digit after the point is bit 0.
struct SobolPoint {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
};

inline std::uint32_t reverse_bits(std::uint32_t v) {
  v = ((v >> 1u) & 0x55555555u) | ((v & 0x55555555u) << 1u);
  v = ((v >> 2u) & 0x33333333u) | ((v & 0x33333333u) << 2u);
  v = ((v >> 4u) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4u);
  return __builtin_bswap32(v);
}

// The first `count` points: x is van der Corput's sequence, y has Pascal's matrix modulo 2 as its
// generator (direction numbers v_k = v_{k-1} xor v_{k-1} / 2).
inline std::vector<SobolPoint> make_sobol_points(int count) {
  std::vector<SobolPoint> points(static_cast<std::size_t>(count));
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    std::uint32_t y = 0, v = 1u << 31u;
    for (std::uint32_t bits = i; bits != 0; bits >>= 1u, v ^= v >> 1u)
      if ((bits & 1u) != 0) y ^= v;
    points[i] = {i, reverse_bits(y)};
  }
  return points;
}

struct SobolScramble {
  std::uint32_t x = 0;
  std::uint32_t y = 0;
};
inline SobolScramble make_scramble(std::uint64_t hash) {
  return {static_cast<std::uint32_t>(hash), static_cast<std::uint32_t>(hash >> 32u)};
}

// Each bit of the result depends on the lower bits of `reversed` alone, that is on the digits
// before it: a nested permutation of the digits.
inline float scramble_digits(std::uint32_t reversed, std::uint32_t seed) {
  std::uint32_t v = reversed + seed;
  v ^= v * 0x6c50b47cu;
  v ^= v * 0xb82f1e52u;
  v ^= v * 0xc7afe638u;
  v ^= v * 0x8d22f6e6u;
  return static_cast<float>(reverse_bits(v) >> 8u) * 0x1.0p-24f;  // in [0, 1)
}
inline Vec2 scramble(SobolPoint point, SobolScramble seed) {
  return {scramble_digits(point.x, seed.x), scramble_digits(point.y, seed.y)};
}

}  // namespace parian

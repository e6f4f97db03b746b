// Half-precision floats (IEEE 754 binary16) as storage.
#pragma once

#include <bit>
#include <cstdint>

namespace parian {

// Exact; also for denormal numbers. Infinity and NaN are not kept.
[[gnu::always_inline]] inline float half_to_float(std::uint16_t half) {
  const std::uint32_t sign = static_cast<std::uint32_t>(half & 0x8000u) << 16u;
  const std::uint32_t magnitude = static_cast<std::uint32_t>(half & 0x7fffu) << 13u;
  // The exponents differ by 112: a product also takes care of denormals.
  const float value = std::bit_cast<float>(magnitude) * 0x1.0p112f;
  return std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) | sign);
}

// To the nearest, ties to even. |value| < 65520.
inline std::uint16_t float_to_half(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  const auto sign = static_cast<std::uint16_t>((bits >> 16u) & 0x8000u);
  const std::uint32_t magnitude = bits & 0x7fffffffu;
  if (magnitude < 0x38800000u) {  // below 2^-14: adding 1/2 leaves multiples of 2^-24
    const float shifted = std::bit_cast<float>(magnitude) + 0.5f;
    return static_cast<std::uint16_t>(
        sign | (std::bit_cast<std::uint32_t>(shifted) - std::bit_cast<std::uint32_t>(0.5f)));
  }
  const std::uint32_t odd = (magnitude >> 13u) & 1u;
  const std::uint32_t rounded = magnitude + 0xfffu + odd - (112u << 23u);
  return static_cast<std::uint16_t>(sign | (rounded >> 13u));
}

}  // namespace parian

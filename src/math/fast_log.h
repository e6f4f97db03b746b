// The logarithm of fast_math.h for use inside other vectorised loops.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

namespace parian {

// ln x = e ln 2 + ln m with m in [1/sqrt 2, sqrt 2). With s = (m - 1) / (m + 1),
// ln m = 2 (s + s^3/3 + s^5/5 + ...); s^2 <= 0.0295, so the terms to s^9 leave less than 1e-9.
[[gnu::always_inline]] inline float fast_log(float x) {
  constexpr float ln2_high = 0.693359375f, ln2_low = -2.12194440e-4f;
  const auto bits = std::bit_cast<std::uint32_t>(x);
  const std::int32_t exponent = std::bit_cast<std::int32_t>(bits - 0x3f3504f3u) >> 23;
  const float m = std::bit_cast<float>(bits - (std::bit_cast<std::uint32_t>(exponent) << 23u));
  const auto e = static_cast<float>(exponent);
  const float s = (m - 1) / (m + 1);
  const float s2 = s * s;
  const float series = s2 * (0.6666667f + s2 * (0.4f + s2 * (0.2857143f + s2 * 0.2222222f)));
  const float value = e * ln2_high + (2 * s + (s * series + e * ln2_low));
  const float low =
      x >= 0 ? -std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
  return x >= std::numeric_limits<float>::min() ? value : low;
}

}  // namespace parian

// The logarithm of fast_math.h, and an exponential, for use inside other vectorised loops: on
// float, or on GCC's vectors of floats with the vector of integers of the same size.
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>

namespace parian {

// Of x >= 2^-126. ln x = e ln 2 + ln m with m in [1/sqrt 2, sqrt 2). With s = (m - 1) / (m + 1),
// ln m = 2 (s + s^3/3 + s^5/5 + ...); s^2 <= 0.0295, so the terms to s^9 leave less than 1e-9.
template <typename Float, typename Int>
[[gnu::always_inline]] inline Float log_of_normal(Float x) {
  constexpr float ln2_high = 0.693359375f, ln2_low = -2.12194440e-4f;
  const Int bits = __builtin_bit_cast(Int, x);
  const Int exponent = (bits - 0x3f3504f3) >> 23;
  const Float m = __builtin_bit_cast(Float, bits - (exponent << 23));
  Float e;
  if constexpr (std::is_floating_point_v<Float>)
    e = static_cast<Float>(exponent);
  else
    e = __builtin_convertvector(exponent, Float);
  const Float s = (m - 1.0f) / (m + 1.0f);
  const Float s2 = s * s;
  const Float series = s2 * (0.6666667f + s2 * (0.4f + s2 * (0.2857143f + s2 * 0.2222222f)));
  return e * ln2_high + (2.0f * s + (s * series + e * ln2_low));
}

[[gnu::always_inline]] inline float fast_log(float x) {
  const float value = log_of_normal<float, std::int32_t>(x);
  const float low =
      x >= 0 ? -std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
  return x >= std::numeric_limits<float>::min() ? value : low;
}

// e^x of |x| <= 87: 2^k e^f with |f| <= ln 2 / 2; Taylor to f^6 leaves 2e-7 relative.
template <typename Float, typename Int>
[[gnu::always_inline]] inline Float exp_of_small(Float x) {
  constexpr float log2_e = 1.44269504f, ln2_high = 0.693359375f, ln2_low = -2.12194440e-4f;
  constexpr float round = 12582912.0f;  // 1.5 * 2^23: adding it rounds to an integer
  const Float shifted = x * log2_e + round;
  const Float k = shifted - round;
  const Float f = (x - k * ln2_high) - k * ln2_low;
  const Float p =
      1.0f +
      f * (1.0f + f * (0.5f + f * (0.16666667f +
                                   f * (0.041666668f + f * (0.0083333338f + f * 0.0013888889f)))));
  const Int power = __builtin_bit_cast(Int, shifted) << 23;
  return __builtin_bit_cast(Float, __builtin_bit_cast(Int, p) + power);
}

}  // namespace parian

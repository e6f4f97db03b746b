#include "math/fast_math.h"

#include <bit>
#include <cstdint>
#include <limits>

#include "base/hot.h"
#include "math/fast_log.h"

namespace parian {

PARIAN_HOT void log_array(const float* PARIAN_RESTRICT in, float* PARIAN_RESTRICT out,
                          std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) out[i] = fast_log(in[i]);
}

// e^x = 2^k e^f with |f| <= ln 2 / 2; Taylor to f^7 leaves 6e-9 relative.
PARIAN_HOT void exp_array(const float* PARIAN_RESTRICT in, float* PARIAN_RESTRICT out,
                          std::size_t count) {
  constexpr float log2_e = 1.44269504f, ln2_high = 0.693359375f, ln2_low = -2.12194440e-4f;
  constexpr float round = 12582912.0f;  // 1.5 * 2^23: adding it rounds to an integer
  for (std::size_t i = 0; i < count; ++i) {
    const float x = in[i];
    float clamped = x < -87.0f ? -87.0f : x;
    clamped = clamped > 88.0f ? 88.0f : clamped;
    const float shifted = clamped * log2_e + round;
    const float k = shifted - round;
    const float f = (clamped - k * ln2_high) - k * ln2_low;
    const float p =
        1 + f * (1 + f * (0.5f +
                          f * (0.16666667f + f * (0.041666668f +
                                                  f * (0.0083333338f +
                                                       f * (0.0013888889f + f * 1.9841270e-4f))))));
    const std::uint32_t power = std::bit_cast<std::uint32_t>(shifted) << 23u;
    const float value = std::bit_cast<float>(std::bit_cast<std::uint32_t>(p) + power);
    out[i] = x < -87.0f ? 0.0f : (x == x ? value : x);
  }
}

}  // namespace parian

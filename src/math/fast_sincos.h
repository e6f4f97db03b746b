// Sine and cosine of a full turn for use inside vectorised loops, beside fast_log.h: plain
// arithmetic without branches, the same bits for every instruction set.
#pragma once

namespace parian {

struct SinCos {
  float sin, cos;
};

// sin and cos of 2 pi u for u in [0, 1]; absolute error <= 3e-7. With t = u - 1/2, both follow from
// the half angle pi t in [-pi/2, pi/2], whose Taylor series need no case distinction.
[[gnu::always_inline]] inline SinCos fast_sincos_turn(float u) {
  const float x = (u - 0.5f) * 3.14159265f;
  const float x2 = x * x;
  const float s =
      x * (1 + x2 * (-0.16666667f +
                     x2 * (8.3333333e-3f +
                           x2 * (-1.9841270e-4f + x2 * (2.7557319e-6f + x2 * -2.5052108e-8f)))));
  const float c =
      1 + x2 * (-0.5f +
                x2 * (0.041666668f +
                      x2 * (-1.3888889e-3f +
                            x2 * (2.4801587e-5f + x2 * (-2.7557319e-7f + x2 * 2.0876757e-9f)))));
  return {-2 * s * c, 2 * s * s - 1};
}

}  // namespace parian

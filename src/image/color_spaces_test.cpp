#include "image/color_spaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"

namespace parian {
namespace {

void expect_near(const Color& a, const Color& b, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance);
}

// The inverse of linear_to_lab (CIE 15).
Color lab_to_linear(const Color& lab) {
  const Color white = linear_to_xyz({1, 1, 1});
  const double y = (lab[0] + 16) / 116;
  const Color roots{y + lab[1] / 500, y, y - lab[2] / 200};
  Color xyz;
  for (std::size_t i = 0; i < 3; ++i)
    xyz[i] = white[i] *
             (roots[i] > 6.0 / 29 ? std::pow(roots[i], 3) : 108.0 / 841 * (roots[i] - 4.0 / 29));
  return xyz_to_linear(xyz);
}

TEST(ColorSpaces, ReferenceColours) {
  expect_near(linear_to_xyz({1, 1, 1}), {0.9505, 1.0, 1.0891}, 1e-4);
  expect_near(linear_to_lab({1, 1, 1}), {100, 0, 0}, 1e-9);
  expect_near(linear_to_lab({0, 0, 0}), {0, 0, 0}, 1e-9);
  expect_near(linear_to_lab({1, 0, 0}), {53.24, 80.09, 67.20}, 0.02);
  expect_near(linear_to_lab({0, 1, 0}), {87.73, -86.18, 83.18}, 0.02);
  expect_near(linear_to_lab({0, 0, 1}), {32.30, 79.19, -107.86}, 0.02);
  expect_near(linear_to_oklab({1, 1, 1}), {1, 0, 0}, 1e-6);
  expect_near(linear_to_oklab({1, 0, 0}), {0.627955, 0.224863, 0.125846}, 2e-6);
  // Ottosson's table of XYZ and OKLab, to three digits.
  expect_near(linear_to_oklab(xyz_to_linear({0.950, 1.000, 1.089})), {1.000, 0.000, 0.000}, 1e-3);
  expect_near(linear_to_oklab(xyz_to_linear({1, 0, 0})), {0.450, 1.236, -0.019}, 1e-3);
  expect_near(linear_to_oklab(xyz_to_linear({0, 1, 0})), {0.922, -0.671, 0.263}, 1e-3);
  expect_near(linear_to_oklab(xyz_to_linear({0, 0, 1})), {0.153, -1.415, -0.449}, 1e-3);
}

TEST(ColorSpaces, RoundTripsAlsoOutsideTheGamut) {
  Rng rng = make_rng(1);
  for (int i = 0; i < 500; ++i) {
    Color rgb;
    for (double& value : rgb) value = 4 * sample_uniform(rng) - 1;
    expect_near(xyz_to_linear(linear_to_xyz(rgb)), rgb, 1e-12);
    expect_near(lab_to_linear(linear_to_lab(rgb)), rgb, 1e-10);
    const Color oklab = linear_to_oklab(rgb);
    expect_near(oklab_to_linear(oklab), rgb, 1e-10);
    const Color lch = oklab_to_oklch(oklab);
    expect_near({lch[0], lch[1] * std::cos(lch[2]), lch[1] * std::sin(lch[2])}, oklab, 1e-12);
  }
}

TEST(ColorSpaces, GreysHaveNoChroma) {
  for (double grey : {0.001, 0.18, 0.5, 2.0}) {
    EXPECT_NEAR(oklab_to_oklch(linear_to_oklab({grey, grey, grey}))[1], 0, 1e-14);
    EXPECT_EQ(oklab_to_oklch(linear_to_oklab({grey, grey, grey}))[2], 0);
    const Color lab = linear_to_lab({grey, grey, grey});
    EXPECT_NEAR(lab[1], 0, 1e-9);
    EXPECT_NEAR(lab[2], 0, 1e-9);
  }
}

TEST(ColorSpaces, PossibleChromaReachesTheGamutsEdge) {
  Rng rng = make_rng(2);
  int outside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Color oklab{0.1 + sample_uniform(rng), 0.6 * sample_uniform(rng) - 0.3,
                      0.6 * sample_uniform(rng) - 0.3};
    const double part = find_possible_chroma(oklab);
    const auto least = [&](double t) {
      const Color rgb = oklab_to_linear({oklab[0], t * oklab[1], t * oklab[2]});
      return std::min({rgb[0], rgb[1], rgb[2]});
    };
    EXPECT_GE(least(part), -1e-15);
    if (part == 1) continue;
    ++outside;
    EXPECT_LT(least(part + 1e-6), 0);
  }
  EXPECT_GT(outside, 500);
  EXPECT_LT(outside, 1950);
}

}  // namespace
}  // namespace parian

#include "image/color_spaces.h"

#include <cmath>

namespace parian {
namespace {

using Matrix = std::array<Color, 3>;

constexpr Color multiply(const Matrix& m, const Color& v) {
  Color product{};
  for (std::size_t i = 0; i < 3; ++i) product[i] = m[i][0] * v[0] + m[i][1] * v[1] + m[i][2] * v[2];
  return product;
}

constexpr Matrix invert(const Matrix& m) {
  const auto minor = [&](std::size_t i, std::size_t j) {
    const std::size_t a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return m[a][c] * m[b][d] - m[a][d] * m[b][c];
  };
  const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
  Matrix inverse{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) inverse[j][i] = minor(i, j) / determinant;
  return inverse;
}

// Rec. 709 primaries and D65, x = 0.3127, y = 0.3290.
constexpr Matrix xyz_from_linear{{{0.4123907992659595, 0.3575843393838780, 0.1804807884018343},
                                  {0.2126390058715104, 0.7151686787677559, 0.0721923153607337},
                                  {0.0193308187155918, 0.1191947797946259, 0.9505321522496608}}};
constexpr Matrix linear_from_xyz = invert(xyz_from_linear);

// Each row plus what its last element lacks of this sum.
constexpr Matrix complete_sums(Matrix m, const Color& sums) {
  for (std::size_t i = 0; i < 3; ++i) m[i][2] = sums[i] - m[i][0] - m[i][1];
  return m;
}

// OKLab: cone responses from linear Rec. 709, and L, a, b from their cube roots. The published
// constants leave greys a chroma of 4e-8; completed in their last digits they leave none.
constexpr Matrix cones_from_linear = complete_sums({{{0.4122214708, 0.5363325363, 0.0514459929},
                                                     {0.2119034982, 0.6806995451, 0.1073969566},
                                                     {0.0883024619, 0.2817188376, 0.6299787005}}},
                                                   {1, 1, 1});
constexpr Matrix linear_from_cones = invert(cones_from_linear);
constexpr Matrix oklab_from_roots = complete_sums({{{0.2104542553, 0.7936177850, -0.0040720468},
                                                    {1.9779984951, -2.4285922050, 0.4505937099},
                                                    {0.0259040371, 0.7827717662, -0.8086757660}}},
                                                  {1, 0, 0});
constexpr Matrix roots_from_oklab = invert(oklab_from_roots);

constexpr Color white = multiply(xyz_from_linear, {1, 1, 1});

// CIE 15: the cube root, linear below (6/29)^3, and so also for negative values.
double lab_curve(double t) {
  constexpr double d = 6.0 / 29;
  return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4.0 / 29;
}

// The coefficients of sum_k m_k (p_k + t q_k)^3 in t: a channel at the part t of the chroma.
std::array<double, 4> expand_cubes(const Color& m, const Color& p, const Color& q) {
  std::array<double, 4> sum{};
  for (std::size_t k = 0; k < 3; ++k) {
    sum[0] += m[k] * p[k] * p[k] * p[k];
    sum[1] += 3 * m[k] * p[k] * p[k] * q[k];
    sum[2] += 3 * m[k] * p[k] * q[k] * q[k];
    sum[3] += m[k] * q[k] * q[k] * q[k];
  }
  return sum;
}

double evaluate(const std::array<double, 4>& cubic, double t) {
  return cubic[0] + t * (cubic[1] + t * (cubic[2] + t * cubic[3]));
}

// Below `high`, where the cubic is negative, a place where it is not and just beyond is.
double find_sign_change(const std::array<double, 4>& cubic, double high) {
  double low = 0;
  for (int i = 0; i < 32; ++i) {
    const double middle = 0.5 * (low + high);
    (evaluate(cubic, middle) < 0 ? high : low) = middle;
  }
  return low;
}

}  // namespace

Color linear_to_xyz(const Color& rgb) {
  return multiply(xyz_from_linear, rgb);
}

Color xyz_to_linear(const Color& xyz) {
  return multiply(linear_from_xyz, xyz);
}

Color linear_to_lab(const Color& rgb) {
  const Color xyz = linear_to_xyz(rgb);
  const double x = lab_curve(xyz[0] / white[0]), y = lab_curve(xyz[1] / white[1]),
               z = lab_curve(xyz[2] / white[2]);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Color linear_to_oklab(const Color& rgb) {
  const Color cones = multiply(cones_from_linear, rgb);
  return multiply(oklab_from_roots,
                  {std::cbrt(cones[0]), std::cbrt(cones[1]), std::cbrt(cones[2])});
}

Color oklab_to_linear(const Color& oklab) {
  Color roots = multiply(roots_from_oklab, oklab);
  for (double& root : roots) root = root * root * root;
  return multiply(linear_from_cones, roots);
}

double find_possible_chroma(const Color& oklab) {
  const Color p = multiply(roots_from_oklab, {oklab[0], 0, 0});
  const Color q = multiply(roots_from_oklab, {0, oklab[1], oklab[2]});
  std::array<std::array<double, 4>, 3> cubics{};
  for (std::size_t i = 0; i < 3; ++i) cubics[i] = expand_cubes(linear_from_cones[i], p, q);
  double part = 1;
  // One channel's edge may lie where another, inside again at the full chroma, is negative.
  for (bool moved = true; moved;) {
    moved = false;
    for (const auto& cubic : cubics) {
      if (!(evaluate(cubic, part) < 0)) continue;
      part = find_sign_change(cubic, part);
      moved = part > 0;
    }
  }
  return part;
}

Color oklab_to_oklch(const Color& oklab) {
  const double chroma = std::hypot(oklab[1], oklab[2]);
  return {oklab[0], chroma, chroma > 1e-9 ? std::atan2(oklab[2], oklab[1]) : 0};
}

}  // namespace parian

// sum_segments and finish_shapes for one instruction set, in namespace PARIAN_MEASURE_SPACE:
// vectors keep their running values in registers, which loops over arrays do not.
#include <bit>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "edit/shape_kernels.h"

namespace parian::PARIAN_MEASURE_SPACE {
namespace {

using Lanes = double __attribute__((vector_size(32)));
using WholeLanes = std::int64_t __attribute__((vector_size(32)));
constexpr std::size_t lanes = 4;

// e^x = 2^k e^f with |f| <= ln 2 / 2 and the polynomial of degree 10 that is nearest to e^f there:
// 2e-16 and rounding. For |x| < 700; beyond as at the end.
[[gnu::always_inline]] inline Lanes exp_lanes(Lanes x) {
  constexpr double log2_e = 1.4426950408889634, ln2 = 0.6931471805599453;
  constexpr double round = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
  Lanes clamped = x < -700.0 ? Lanes{} - 700.0 : x;
  clamped = clamped > 700.0 ? Lanes{} + 700.0 : clamped;
  const Lanes shifted = clamped * log2_e + round;
  const Lanes f = clamped - (shifted - round) * ln2;
  const Lanes f2 = f * f, f4 = f2 * f2;  // by halves, so that little waits for the one before
  const Lanes low =
      (1.0 + f * 1.0000000000000067) + f2 * (0.50000000000000056 + f * 0.16666666666554405);
  const Lanes middle = (0.041666666666573143 + f * 0.0083333333856677825) +
                       f2 * (0.0013888888932488598 + f * 0.00019841170270440068);
  const Lanes high =
      (2.4801504346997687e-5 + f * 2.7640180796209851e-6) + f2 * 2.7626357241447223e-7;
  const Lanes p = low + f4 * (middle + f4 * high);
  const WholeLanes power = std::bit_cast<WholeLanes>(shifted) << 52;
  return std::bit_cast<Lanes>(std::bit_cast<WholeLanes>(p) + power);
}

// int exp(y) r dr over the segment of length h about radius m where y rises by beta and P = e^y
// from p0 to p1: h (m I0 + h I1), I0 = int_{-1/2}^{1/2} P(t) dt = (p1 - p0) / beta and
// I1 = int t P dt = ((p0 + p1) / 2 - I0) / beta; near beta = 0 their series, 6e-14 or better.
[[gnu::always_inline]] inline Lanes integrate_lanes(Lanes m, Lanes h, Lanes beta, Lanes p0,
                                                    Lanes p1) {
  const Lanes z = beta * beta;
  const WholeLanes small = z < 0.0025;
  const Lanes inverse = 1.0 / (small ? Lanes{} + 1.0 : beta);
  const Lanes middle = 0.5 * (p0 + p1);
  const Lanes series0 = middle * (1.0 + z * (-1.0 / 12 + z * (1.0 / 120 + z * (-17.0 / 20160))));
  const Lanes series1 = middle * beta * (1.0 / 12 + z * (-1.0 / 120 + z * (17.0 / 20160)));
  const Lanes i0 = small ? series0 : (p1 - p0) * inverse;
  const Lanes i1 = small ? series1 : (middle - i0) * inverse;
  return h * (m * i0 + h * i1);
}

[[gnu::always_inline]] inline Lanes load_lanes(const float* from) {
  return Lanes{static_cast<double>(from[0]), static_cast<double>(from[1]),
               static_cast<double>(from[2]), static_cast<double>(from[3])};
}

[[gnu::always_inline]] inline Lanes load_lanes(const double* from) {
  Lanes row;
  std::memcpy(&row, from, sizeof row);
  return row;
}

}  // namespace

void sum_segments(const float* rows, std::size_t stride, const double* radius, std::size_t knots,
                  ShapeSums* sums) {
  // The exponentials of some knots first, then their segments: a chain through both is longer than
  // processors look ahead.
  constexpr std::size_t some = 32;
  for (std::size_t i = 0; i < shape_lanes; i += lanes) {
    Lanes y[some + 1], p[some + 1], sum{};
    y[0] = load_lanes(rows + i);
    p[0] = exp_lanes(y[0]);
    for (std::size_t first = 1; first < knots; first += some) {
      const std::size_t count = first + some < knots ? some : knots - first;
      for (std::size_t k = 1; k <= count; ++k) {
        y[k] = load_lanes(rows + (first + k - 1) * stride + i);
        p[k] = exp_lanes(y[k]);
      }
      for (std::size_t k = 1; k <= count; ++k) {
        const double a = radius[first + k - 2], b = radius[first + k - 1];
        sum += integrate_lanes(Lanes{} + 0.5 * (a + b), Lanes{} + (b - a), y[k] - y[k - 1],
                               p[k - 1], p[k]);
      }
      y[0] = y[count];
      p[0] = p[count];
    }
    std::memcpy(&sums->value[i], &p[0], sizeof p[0]);
    std::memcpy(&sums->integral[i], &sum, sizeof sum);
  }
}

void finish_shapes(const float* before, const float* end, double last_radius, double last_length,
                   const ShapeCrossings* crossings, ShapeSums* sums) {
  const double least = -min_tail_decay / last_radius, limit = (support_limit - 1) * last_radius;
  const double inverse_length = 1 / last_length;
  for (std::size_t i = 0; i < shape_lanes; i += lanes) {
    const Lanes y = load_lanes(end + i);
    const Lanes last_slope = (y - load_lanes(before + i)) * inverse_length;
    const Lanes slope = last_slope < least ? last_slope : Lanes{} + least;
    const Lanes level = load_lanes(crossings->top + i) - log_of_support;
    Lanes tail = (level - y) / slope;
    tail = tail < limit ? tail : Lanes{} + limit;
    tail = y > level ? tail : Lanes{};
    const Lanes beta = slope * tail, p0 = load_lanes(sums->value + i);
    const Lanes more =
        integrate_lanes(last_radius + 0.5 * tail, tail, beta, p0, p0 * exp_lanes(beta));
    const Lanes total = 2 * std::numbers::pi * (load_lanes(sums->integral + i) + more);
    std::memcpy(&sums->integral[i], &total, sizeof total);
    std::memcpy(&sums->tail[i], &tail, sizeof tail);
  }
}

}  // namespace parian::PARIAN_MEASURE_SPACE

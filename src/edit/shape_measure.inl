// sum_segments and finish_shapes for one instruction set, in namespace PARIAN_VECTOR_SPACE with
// vectors of PARIAN_VECTOR_BYTES: they keep their running values in registers, which loops over
// arrays do not.
#include <bit>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "edit/shape_kernels.h"

namespace parian::PARIAN_VECTOR_SPACE {
namespace {

using Lanes = double __attribute__((vector_size(PARIAN_VECTOR_BYTES)));
using WholeLanes = std::int64_t __attribute__((vector_size(PARIAN_VECTOR_BYTES)));
using HalfLanes = float __attribute__((vector_size(PARIAN_VECTOR_BYTES / 2)));
constexpr std::size_t lanes = PARIAN_VECTOR_BYTES / sizeof(double);

// What vectors of one instruction set do at once and the compiler would take apart.
#if defined(__AVX512F__)
[[gnu::always_inline]] inline Lanes widen_lanes(HalfLanes x) { return _mm512_cvtps_pd(x); }
[[gnu::always_inline]] inline Lanes least_of(Lanes a, Lanes b) { return _mm512_min_pd(a, b); }
[[gnu::always_inline]] inline Lanes largest_of(Lanes a, Lanes b) { return _mm512_max_pd(a, b); }
[[gnu::always_inline]] inline bool any_below(Lanes a, double limit) {
  return _mm512_cmp_pd_mask(a, _mm512_set1_pd(limit), _CMP_LT_OQ) != 0;
}
#else
[[gnu::always_inline]] inline Lanes widen_lanes(HalfLanes x) {
  return __builtin_convertvector(x, Lanes);
}
[[gnu::always_inline]] inline Lanes least_of(Lanes a, Lanes b) { return a < b ? a : b; }
[[gnu::always_inline]] inline Lanes largest_of(Lanes a, Lanes b) { return a > b ? a : b; }
[[gnu::always_inline]] inline bool any_below(Lanes a, double limit) {
#if defined(__AVX2__)
  return _mm256_movemask_pd(_mm256_cmp_pd(a, _mm256_set1_pd(limit), _CMP_LT_OQ)) != 0;
#else
  const WholeLanes below = a < limit;
  std::int64_t any = 0;
  for (std::size_t i = 0; i < lanes; ++i) any |= below[i];
  return any != 0;
#endif
}
#endif

// The same value in all lanes.
[[gnu::always_inline]] inline Lanes fill_lanes(double x) { return x - Lanes{}; }

// e^x = 2^k e^f with |f| <= ln 2 / 2 and the polynomial of degree 10 that is nearest to e^f there:
// 2e-16 and rounding. For |x| < 700; beyond as at the end.
[[gnu::always_inline]] inline Lanes exp_lanes(Lanes x) {
  constexpr double log2_e = 1.4426950408889634, ln2 = 0.6931471805599453;
  constexpr double round = 6755399441055744.0;  // 1.5 * 2^52: adding it rounds to an integer
  const Lanes clamped = least_of(largest_of(x, fill_lanes(-700)), fill_lanes(700));
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
  constexpr double limit = 0.0025;
  const Lanes z = beta * beta, middle = 0.5 * (p0 + p1);
  const Lanes inverse = 1.0 / beta;
  Lanes i0 = (p1 - p0) * inverse;
  Lanes i1 = (middle - i0) * inverse;
  if (any_below(z, limit)) {
    const WholeLanes small = z < limit;
    const Lanes series0 = 1.0 + z * (-1.0 / 12 + z * (1.0 / 120 + z * (-17.0 / 20160)));
    const Lanes series1 = 1.0 / 12 + z * (-1.0 / 120 + z * (17.0 / 20160));
    i0 = small ? middle * series0 : i0;
    i1 = small ? middle * beta * series1 : i1;
  }
  return h * (m * i0 + h * i1);
}

[[gnu::always_inline]] inline Lanes load_lanes(const float* from) {
  HalfLanes row;
  std::memcpy(&row, from, sizeof row);
  return widen_lanes(row);
}

[[gnu::always_inline]] inline Lanes load_lanes(const double* from) {
  Lanes row;
  std::memcpy(&row, from, sizeof row);
  return row;
}

}  // namespace

void sum_segments(const float* rows, std::size_t stride, const double* radius, std::size_t knots,
                  ShapeSums* sums) {
  // Knot by knot, and the exponentials of all lanes before their segments: a chain through both is
  // longer than processors look ahead.
  constexpr std::size_t vectors = shape_lanes / lanes;
  Lanes y[vectors], p[vectors], rise[vectors], next[vectors], sum[vectors]{};
  for (std::size_t i = 0; i < vectors; ++i) {
    y[i] = load_lanes(rows + i * lanes);
    p[i] = exp_lanes(y[i]);
  }
  for (std::size_t k = 1; k < knots; ++k) {
    const float* row = rows + k * stride;
    for (std::size_t i = 0; i < vectors; ++i) {
      const Lanes here = load_lanes(row + i * lanes);
      next[i] = exp_lanes(here);
      rise[i] = here - y[i];
      y[i] = here;
    }
    const Lanes middle = fill_lanes(0.5 * (radius[k - 1] + radius[k])),
                length = fill_lanes(radius[k] - radius[k - 1]);
    for (std::size_t i = 0; i < vectors; ++i) {
      sum[i] += integrate_lanes(middle, length, rise[i], p[i], next[i]);
      p[i] = next[i];
    }
  }
  std::memcpy(sums->value, p, sizeof p);
  std::memcpy(sums->integral, sum, sizeof sum);
}

void finish_shapes(const float* before, const float* end, double last_radius, double last_length,
                   const ShapeCrossings* crossings, ShapeSums* sums) {
  const double least = -min_tail_decay / last_radius, limit = (support_limit - 1) * last_radius;
  const double inverse_length = 1 / last_length;
  for (std::size_t i = 0; i < shape_lanes; i += lanes) {
    const Lanes y = load_lanes(end + i);
    const Lanes last_slope = (y - load_lanes(before + i)) * inverse_length;
    const Lanes slope = least_of(last_slope, fill_lanes(least));
    const Lanes level = load_lanes(crossings->top + i) - log_of_support;
    Lanes tail = (level - y) / slope;
    tail = least_of(tail, fill_lanes(limit));
    tail = y > level ? tail : Lanes{};
    const Lanes beta = slope * tail, p0 = load_lanes(sums->value + i);
    const Lanes more =
        integrate_lanes(last_radius + 0.5 * tail, tail, beta, p0, p0 * exp_lanes(beta));
    const Lanes total = 2 * std::numbers::pi * (load_lanes(sums->integral + i) + more);
    std::memcpy(&sums->integral[i], &total, sizeof total);
    std::memcpy(&sums->tail[i], &tail, sizeof tail);
  }
}

}  // namespace parian::PARIAN_VECTOR_SPACE

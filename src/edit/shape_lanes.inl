// Vectors of one instruction set, of PARIAN_VECTOR_BYTES, in namespace PARIAN_VECTOR_SPACE: they
// keep running values in registers, which loops over arrays do not. Nothing of the standard library
// is called: its functions would exist once, for one of the instruction sets.
namespace parian::PARIAN_VECTOR_SPACE {
namespace {

using Lanes = double __attribute__((vector_size(PARIAN_VECTOR_BYTES)));
using WholeLanes = std::int64_t __attribute__((vector_size(PARIAN_VECTOR_BYTES)));
using HalfLanes = float __attribute__((vector_size(PARIAN_VECTOR_BYTES / 2)));
constexpr std::size_t lanes = PARIAN_VECTOR_BYTES / sizeof(double);
// Several at once, which the compiler takes apart again: a chain of operations on one alone is
// longer than processors look ahead.
constexpr std::size_t group = 8;
using LaneGroup = double __attribute__((vector_size(group * PARIAN_VECTOR_BYTES)));
using WholeLaneGroup = std::int64_t __attribute__((vector_size(group * PARIAN_VECTOR_BYTES)));

// What vectors of one instruction set do at once and the compiler would take apart.
#if PARIAN_VECTOR_BYTES == 64
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
#if defined(PARIAN_VECTOR_VARIANTS) && defined(__AVX2__)
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

using FloatLanes = float __attribute__((vector_size(PARIAN_VECTOR_BYTES)));
using IntLanes = std::int32_t __attribute__((vector_size(PARIAN_VECTOR_BYTES)));
constexpr std::size_t float_lanes = PARIAN_VECTOR_BYTES / sizeof(float);
using FloatRow = float __attribute__((vector_size(shape_lanes * sizeof(float))));
using IntRow = std::int32_t __attribute__((vector_size(shape_lanes * sizeof(float))));

[[gnu::always_inline]] inline FloatLanes load_floats(const float* from) {
  FloatLanes row;
  std::memcpy(&row, from, sizeof row);
  return row;
}

[[gnu::always_inline]] inline FloatLanes fill_floats(float x) { return x - FloatLanes{}; }

}  // namespace
}  // namespace parian::PARIAN_VECTOR_SPACE

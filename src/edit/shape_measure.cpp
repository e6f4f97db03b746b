// The measuring kernels of shape_kernels.h for the baseline and for AVX2, chosen at run time. Both
// give the same bits: contraction is off everywhere.
#include "edit/shape_kernels.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(PARIAN_NO_CLONES)
#define PARIAN_MEASURE_HAS_AVX2 1
#endif

// Vectors wider than the baseline's registers are passed between functions that are always inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

#define PARIAN_MEASURE_SPACE measure_baseline
#include "edit/shape_measure.inl"
#undef PARIAN_MEASURE_SPACE

#ifdef PARIAN_MEASURE_HAS_AVX2
#pragma GCC push_options
#pragma GCC target("avx2")
#define PARIAN_MEASURE_SPACE measure_avx2
#include "edit/shape_measure.inl"
#undef PARIAN_MEASURE_SPACE
#pragma GCC pop_options
#endif

namespace parian {

#ifdef PARIAN_MEASURE_HAS_AVX2
namespace {
bool use_avx2() {
  static const bool supported = __builtin_cpu_supports("avx2") != 0;
  return supported;
}
}  // namespace
#define PARIAN_MEASURE_CALL(function, ...) \
  (use_avx2() ? measure_avx2::function(__VA_ARGS__) : measure_baseline::function(__VA_ARGS__))
#else
#define PARIAN_MEASURE_CALL(function, ...) measure_baseline::function(__VA_ARGS__)
#endif

void sum_segments(const float* rows, std::size_t stride, const double* radius, std::size_t knots,
                  ShapeSums* sums) {
  PARIAN_MEASURE_CALL(sum_segments, rows, stride, radius, knots, sums);
}
void finish_shapes(const float* before, const float* end, double last_radius, double last_length,
                   const ShapeCrossings* crossings, ShapeSums* sums) {
  PARIAN_MEASURE_CALL(finish_shapes, before, end, last_radius, last_length, crossings, sums);
}

}  // namespace parian

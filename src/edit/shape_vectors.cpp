// The kernels of shape_kernels.h that are written in vectors, for the baseline, AVX2 and AVX-512,
// chosen at run time. All give the same bits: contraction is off everywhere, and what a lane does
// depends on no other.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "edit/shape_kernels.h"
#include "math/fast_log.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(PARIAN_NO_CLONES)
#define PARIAN_VECTOR_VARIANTS 1
#include <immintrin.h>
#endif

// Vectors wider than the baseline's registers are passed between functions that are always inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

#define PARIAN_VECTOR_SPACE vectors_baseline
#define PARIAN_VECTOR_BYTES 32
#include "edit/shape_vectors.inl"
#include "edit/shape_measure.inl"
#include "edit/shape_sample.inl"
#undef PARIAN_VECTOR_SPACE

#ifdef PARIAN_VECTOR_VARIANTS
#pragma GCC push_options
#pragma GCC target("avx2")
#define PARIAN_VECTOR_SPACE vectors_avx2
#include "edit/shape_vectors.inl"
#include "edit/shape_measure.inl"
#include "edit/shape_sample.inl"
#undef PARIAN_VECTOR_SPACE
#pragma GCC pop_options
#undef PARIAN_VECTOR_BYTES

#pragma GCC push_options
#pragma GCC target("avx512f")
#define PARIAN_VECTOR_SPACE vectors_avx512
#define PARIAN_VECTOR_BYTES 64
#include "edit/shape_vectors.inl"
#include "edit/shape_measure.inl"
#include "edit/shape_sample.inl"
#undef PARIAN_VECTOR_SPACE
#pragma GCC pop_options
#endif
#undef PARIAN_VECTOR_BYTES

namespace parian {

#ifdef PARIAN_VECTOR_VARIANTS
namespace {
enum class Variant { baseline, avx2, avx512 };
Variant find_variant() {
  if (__builtin_cpu_supports("avx512f") != 0) return Variant::avx512;
  return __builtin_cpu_supports("avx2") != 0 ? Variant::avx2 : Variant::baseline;
}
Variant variant() {
  static const Variant found = find_variant();
  return found;
}
}  // namespace
#define PARIAN_VECTOR_CALL(function, ...)                                                 \
  switch (variant()) {                                                                    \
    case Variant::avx512:                                                                 \
      return vectors_avx512::function(__VA_ARGS__);                                       \
    case Variant::avx2:                                                                   \
      return vectors_avx2::function(__VA_ARGS__);                                         \
    case Variant::baseline:                                                               \
      return vectors_baseline::function(__VA_ARGS__);                                     \
  }
#else
#define PARIAN_VECTOR_CALL(function, ...) return vectors_baseline::function(__VA_ARGS__)
#endif

void sum_segments(const float* rows, std::size_t stride, const double* radius, std::size_t knots,
                  ShapeSums* sums) {
  PARIAN_VECTOR_CALL(sum_segments, rows, stride, radius, knots, sums);
}
void find_crossings(const float* rows, std::size_t stride, std::size_t knots,
                    ShapeCrossings* crossings) {
  PARIAN_VECTOR_CALL(find_crossings, rows, stride, knots, crossings);
}
void finish_shapes(const float* before, const float* end, double last_radius, double last_length,
                   const ShapeCrossings* crossings, ShapeSums* sums) {
  PARIAN_VECTOR_CALL(finish_shapes, before, end, last_radius, last_length, crossings, sums);
}

void sample_shapes(const ShapeRows& rows, const float* scale, float* out) {
  PARIAN_VECTOR_CALL(sample_shapes, rows, scale, out);
}

void mix_shapes(const float* a, const float* a_shift, const float* b, const float* b_shift,
                const float* w, std::size_t knots, float* out) {
  PARIAN_VECTOR_CALL(mix_shapes, a, a_shift, b, b_shift, w, knots, out);
}

}  // namespace parian

// The kernels of shape_kernels.h that are written in vectors, for the baseline, AVX2 and AVX-512,
// chosen at run time. All give the same bits: contraction is off everywhere, and what a lane does
// depends on no other.
#include <bit>
#include <cstdint>
#include <cstring>
#include <numbers>

#include "edit/shape_variants_internal.h"
#include "math/fast_log.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(PARIAN_NO_CLONES)
#define PARIAN_VECTOR_VARIANTS 1
#include <immintrin.h>
// Its intrinsics leave operands unset that they do not use.
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

// Vectors wider than the baseline's registers are passed between functions that are always inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

#define PARIAN_VECTOR_SPACE vectors_baseline
#define PARIAN_VECTOR_BYTES 32
#include "edit/shape_lanes.inl"
#include "edit/shape_measure.inl"
#include "edit/shape_sample.inl"
#undef PARIAN_VECTOR_SPACE

#ifdef PARIAN_VECTOR_VARIANTS
#pragma GCC push_options
#pragma GCC target("avx2")
#define PARIAN_VECTOR_SPACE vectors_avx2
#include "edit/shape_lanes.inl"
#include "edit/shape_measure.inl"
#include "edit/shape_sample.inl"
#undef PARIAN_VECTOR_SPACE
#pragma GCC pop_options
#undef PARIAN_VECTOR_BYTES

#pragma GCC push_options
#pragma GCC target("avx512f")
#define PARIAN_VECTOR_SPACE vectors_avx512
#define PARIAN_VECTOR_BYTES 64
#include "edit/shape_lanes.inl"
#include "edit/shape_measure.inl"
#include "edit/shape_sample.inl"
#undef PARIAN_VECTOR_SPACE
#pragma GCC pop_options
#endif
#undef PARIAN_VECTOR_BYTES

namespace parian {

std::vector<ShapeVariant> supported_shape_variants() {
  std::vector<ShapeVariant> variants{vectors_baseline::variant("baseline")};
#ifdef PARIAN_VECTOR_VARIANTS
  if (__builtin_cpu_supports("avx2") != 0) variants.push_back(vectors_avx2::variant("avx2"));
  if (__builtin_cpu_supports("avx512f") != 0) variants.push_back(vectors_avx512::variant("avx512"));
#endif
  return variants;
}

namespace {
const ShapeVariant& fastest() {
  static const ShapeVariant variant = supported_shape_variants().back();
  return variant;
}
}  // namespace

void sum_segments(const float* rows, std::size_t stride, const double* radius, std::size_t knots,
                  ShapeSums* sums) {
  fastest().sum(rows, stride, radius, knots, sums);
}

void find_crossings(const float* rows, std::size_t stride, std::size_t knots,
                    ShapeCrossings* crossings) {
  fastest().cross(rows, stride, knots, crossings);
}

void finish_shapes(const float* before, const float* end, double last_radius, double last_length,
                   const ShapeCrossings* crossings, ShapeSums* sums) {
  fastest().finish(before, end, last_radius, last_length, crossings, sums);
}

void sample_shapes(const ShapeRows& rows, const float* scale, float* out) {
  fastest().sample(rows, scale, out);
}

void mix_shapes(const float* a, const float* a_shift, const float* b, const float* b_shift,
                const float* w, std::size_t knots, float* out) {
  fastest().mix(a, a_shift, b, b_shift, w, knots, out);
}

}  // namespace parian

// The kernels for AVX2 with conversions of half floats in hardware.
#include "transport/transport_kernels_variants.h"

#ifdef PARIAN_TRANSPORT_HAS_F16C
#include <immintrin.h>

#pragma GCC diagnostic ignored "-Wpsabi"
#pragma GCC push_options
#pragma GCC target("avx2,f16c")

namespace {
[[gnu::always_inline]] inline void load_halves(const std::uint16_t* from, parian::Floats& to) {
  const __m256 value = _mm256_cvtph_ps(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
  std::memcpy(&to, &value, sizeof to);
}
}  // namespace

#define PARIAN_KERNEL_SPACE transport_f16c
#include "transport/transport_kernels.inl"
#pragma GCC pop_options
#endif

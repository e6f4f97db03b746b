// Transforms compiled for AVX2. Only pocketfft itself is: the standard headers come first, with the
// baseline target, so that no shared inline function needs more than the processor has.
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "math/fft_variants.h"

#define POCKETFFT_NO_MULTITHREADING
// pocketfft calls aligned_alloc with sizes that are no multiple of the alignment, which C++17 does
// not allow; its fallback over malloc is as good.
#define _LIBCPP_HAS_NO_ALIGNED_ALLOCATION  // NOLINT(bugprone-reserved-identifier)
// Vectors never cross a boundary between translation units.
#pragma GCC diagnostic ignored "-Wpsabi"
#ifdef PARIAN_FFT_HAS_AVX2
#pragma GCC push_options
#pragma GCC target("avx2")
// GCC 12 does not define this after the pragma; pocketfft takes its vector width from it.
#ifndef __AVX__
#define __AVX__ 1
#define PARIAN_UNDEFINE_AVX
#endif
#define pocketfft pocketfft_avx2
#define PARIAN_FFT_SPACE fft_avx2
#include <gemmi/third_party/pocketfft_hdronly.h>

#include "math/fft_kernels.inl"
#ifdef PARIAN_UNDEFINE_AVX
#undef __AVX__
#endif
#pragma GCC pop_options
#endif

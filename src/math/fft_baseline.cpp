// Transforms compiled for the baseline instruction set.
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
#define PARIAN_FFT_SPACE fft_baseline
#include <gemmi/third_party/pocketfft_hdronly.h>

#include "math/fft_kernels.inl"

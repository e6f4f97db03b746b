// The compiled variants of the transforms, between fft.cpp and fft_<variant>.cpp only.
#pragma once

#include "math/fft.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(PARIAN_NO_CLONES)
#define PARIAN_FFT_HAS_AVX2 1
#endif

#define PARIAN_DECLARE_FFT(space)                                                      \
  namespace parian::space {                                                            \
  void forward_float(const FftGrid& grid, const float* plane, int width, int height,   \
                     float* spectrum);                                                 \
  void forward_double(const FftGrid& grid, const double* plane, int width, int height, \
                      double* spectrum);                                               \
  void inverse_float(const FftGrid& grid, float* spectrum, float* plane);              \
  void inverse_double(const FftGrid& grid, double* spectrum, double* plane);           \
  }

PARIAN_DECLARE_FFT(fft_baseline)
PARIAN_DECLARE_FFT(fft_avx2)

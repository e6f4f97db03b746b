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
// Vectors never cross a boundary between translation units.
#pragma GCC diagnostic ignored "-Wpsabi"
#define PARIAN_FFT_SPACE fft_baseline
#include <gemmi/third_party/pocketfft_hdronly.h>

#include "math/fft_kernels.inl"

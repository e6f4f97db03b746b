// Orthonormal wavelets on a periodic row of values, for comparison: Haar and Daubechies' with four
// taps, which Xu et al. 2007 compare their basis with (Fig. 1).
#pragma once

#include <cstddef>
#include <vector>

namespace parian {

enum class Wavelet { haar, daubechies_4 };

// What is left of `values` (a power of two of them) when only the `count` coarsest coefficients
// are kept.
std::vector<double> keep_coarse(std::vector<double> values, Wavelet wavelet, std::size_t count);

}  // namespace parian

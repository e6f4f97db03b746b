// Exponential and logarithm over arrays, in plain arithmetic that compilers vectorise: the same
// bits for every instruction set. Errors are stated against the exact value.
#pragma once

#include <cstddef>

namespace parian {

// out[i] = ln(in[i]); absolute error <= 2e-7 max(1, |ln|). NaN for NaN and for values < 0,
// -infinity for 0. Denormals count as 0.
void log_array(const float* in, float* out, std::size_t count);

// out[i] = e^(in[i]); relative error <= 2e-7 for in >= -87, 0 below. NaN stays NaN.
void exp_array(const float* in, float* out, std::size_t count);

}  // namespace parian

// Rows of residuals for noisy tables (noise_step.h).
#pragma once

#include <cstddef>

namespace parian {

// Variance of a value R: floor^2 + gain R.
struct PairNoise {
  float floor = 0, gain = 0;
};

// Of the model's own misfit in ln R, which no measurement makes smaller.
inline constexpr float model_error = 0.3f;

// For values R and ln R* of the model at the same pairs: the weight w and the residual z in ln R of
// noise_step.h; both 0 where R is NaN. For any finite values.
void eval_noise_residuals(const float* value, const float* log_model, const PairNoise& noise,
                          std::size_t count, float* weight, float* residual);

}  // namespace parian

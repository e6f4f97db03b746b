#include "fit/noise_kernels.h"

#include <algorithm>

#include "base/hot.h"
#include "math/fast_math.h"

namespace parian {
namespace {

constexpr std::size_t strip = 256;  // stays in first-level cache
// Relative variance v = variance / R*^2 at which half of the residual is logarithmic.
constexpr float half_logarithmic = 0.05f;
constexpr float largest_variance = 1e18f;  // its square is finite
constexpr float least_log_model = -80.0f, largest_log_model = 80.0f;

PARIAN_HOT void clamp_logs(const float* PARIAN_RESTRICT in, float* PARIAN_RESTRICT out,
                           std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float low = in[i] > least_log_model ? in[i] : least_log_model;
    out[i] = low < largest_log_model ? low : largest_log_model;
  }
}

// In: R* in `model`. Out: t = R / R* in `ratio`, v, and what the logarithm is taken of: t, but not
// less than min(25 v, 1/4): noise hardly reaches below.
PARIAN_HOT void eval_ratios(const float* PARIAN_RESTRICT value, const float* PARIAN_RESTRICT model,
                            float floor2, float gain, float* PARIAN_RESTRICT ratio,
                            float* PARIAN_RESTRICT variance, float* PARIAN_RESTRICT least,
                            float* PARIAN_RESTRICT argument, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float inverse = 1 / model[i];
    const float v = (floor2 * inverse + gain) * inverse;
    variance[i] = v < largest_variance ? v : largest_variance;
    const float t = value[i] * inverse;
    ratio[i] = t;
    const float t0 = 25 * variance[i];
    least[i] = t0 < 1e-6f ? 1e-6f : (t0 < 0.25f ? t0 : 0.25f);
    argument[i] = t > least[i] ? t : least[i];
  }
}

PARIAN_HOT void combine(const float* PARIAN_RESTRICT value, const float* PARIAN_RESTRICT ratio,
                        const float* PARIAN_RESTRICT variance, const float* PARIAN_RESTRICT least,
                        const float* PARIAN_RESTRICT log_argument, float* PARIAN_RESTRICT weight,
                        float* PARIAN_RESTRICT residual, std::size_t count) {
  constexpr float s2 = model_error * model_error;
  constexpr float per_half = 1 / half_logarithmic;
  for (std::size_t i = 0; i < count; ++i) {
    const float v = variance[i], t = ratio[i];
    const float linear = t - 1;
    const float below = t < least[i] ? (t - least[i]) / least[i] : 0.0f;
    const float logarithmic = log_argument[i] + below + 0.5f * v;  // E ln(1 + noise) = -v/2
    const float x = v * per_half;
    const float z = linear + (logarithmic - linear) / (1 + x * x);
    const bool known = value[i] == value[i];
    weight[i] = known ? s2 / (s2 + v) : 0.0f;
    residual[i] = known ? z : 0.0f;
  }
}

}  // namespace

void eval_noise_residuals(const float* value, const float* log_model, const PairNoise& noise,
                          std::size_t count, float* weight, float* residual) {
  float model[strip], ratio[strip], variance[strip], least[strip], argument[strip], logs[strip];
  for (std::size_t i = 0; i < count; i += strip) {
    const std::size_t n = std::min(strip, count - i);
    clamp_logs(log_model + i, argument, n);
    exp_array(argument, model, n);
    eval_ratios(value + i, model, noise.floor * noise.floor, noise.gain, ratio, variance, least,
                argument, n);
    log_array(argument, logs, n);
    combine(value + i, ratio, variance, least, logs, weight + i, residual + i, n);
  }
}

}  // namespace parian

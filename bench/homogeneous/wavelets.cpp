#include "bench/homogeneous/wavelets.h"

#include <algorithm>
#include <cmath>

namespace parian {
namespace {

std::vector<double> taps_of(Wavelet wavelet) {
  if (wavelet == Wavelet::haar) return {std::sqrt(0.5), std::sqrt(0.5)};
  const double root = std::sqrt(3.0), scale = 1 / (4 * std::sqrt(2.0));
  return {(1 + root) * scale, (3 + root) * scale, (3 - root) * scale, (1 - root) * scale};
}

// The first n values become n / 2 means and n / 2 details, or back.
void step(std::vector<double>& values, std::size_t n, const std::vector<double>& low, bool back) {
  std::vector<double> out(n, 0);
  for (std::size_t i = 0; i < n / 2; ++i)
    for (std::size_t t = 0; t < low.size(); ++t) {
      const double high = (t % 2 == 0 ? 1 : -1) * low[low.size() - 1 - t];
      const std::size_t at = (2 * i + t) % n;
      if (back) {
        out[at] += low[t] * values[i] + high * values[n / 2 + i];
      } else {
        out[i] += low[t] * values[at];
        out[n / 2 + i] += high * values[at];
      }
    }
  std::copy(out.begin(), out.end(), values.begin());
}

}  // namespace

std::vector<double> keep_coarse(std::vector<double> values, Wavelet wavelet, std::size_t count) {
  const std::vector<double> low = taps_of(wavelet);
  for (std::size_t n = values.size(); n >= low.size(); n /= 2) step(values, n, low, false);
  std::fill(values.begin() + static_cast<std::ptrdiff_t>(std::min(count, values.size())),
            values.end(), 0.0);
  std::size_t coarsest = values.size();
  while (coarsest / 2 >= low.size()) coarsest /= 2;
  for (std::size_t n = coarsest; n <= values.size(); n *= 2) step(values, n, low, true);
  return values;
}

}  // namespace parian

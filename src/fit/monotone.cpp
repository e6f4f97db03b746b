#include "fit/monotone.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "math/isotonic.h"

namespace parian {
namespace {

constexpr std::size_t pixel_block = 1024;

// A distance at which pairs lie, and how many ordered pairs of a pixel do.
struct Ring {
  std::size_t segment = 0;
  double fraction = 0, count = 0;
};

std::vector<Ring> make_rings(const ReducedSystem& system) {
  std::map<std::pair<int, double>, double> counts;
  for (std::size_t i = 0; i < system.offsets.size(); ++i)
    counts[{system.segment[i], system.fraction[i]}] += system.pair_count[i];
  std::vector<Ring> rings;
  rings.reserve(counts.size());
  for (const auto& [place, count] : counts)
    rings.push_back({static_cast<std::size_t>(place.first), place.second, count});
  return rings;
}

// ln of the albedo of a uniform sample with this profile: the sum of P over a pixel's pairs.
double log_albedo(const std::vector<Ring>& rings, const std::vector<double>& values) {
  // Relative to the maximum, so that nothing under- or overflows.
  const double top = *std::max_element(values.begin(), values.end());
  double sum = 0;
  for (const auto& [k, f, count] : rings)
    sum += count * std::exp((1 - f) * values[k] + f * values[k + 1] - top);
  return top + std::log(sum);
}

std::vector<double> pair_weights_of_knots(const ReducedSystem& system) {
  std::vector<double> weights(system.knots());
  for (std::size_t i = 0; i < system.offsets.size(); ++i) {
    const auto k = static_cast<std::size_t>(system.segment[i]);
    const double f = system.fraction[i];
    weights[k] += system.pair_count[i] * (1 - f) * (1 - f);
    weights[k + 1] += system.pair_count[i] * f * f;
  }
  const double largest = *std::max_element(weights.begin(), weights.end());
  for (double& weight : weights)
    weight = std::max(weight, 1e-6 * largest);  // knots that no pair sees
  return weights;
}

}  // namespace

std::size_t project_monotone(const ReducedSystem& system, std::vector<double>& p) {
  const std::size_t pixels = system.pixels(), knots = system.knots();
  const std::vector<double> weights = pair_weights_of_knots(system);
  const std::vector<Ring> rings = make_rings(system);
  std::atomic<std::size_t> touched{0};
  parallel_for_blocks(pixels, pixel_block, [&](std::size_t begin, std::size_t end) {
    std::vector<double> values(knots);
    for (std::size_t x = begin; x < end; ++x) {
      for (std::size_t k = 0; k < knots; ++k) values[k] = p[k * pixels + x];
      const std::vector<double> before = values;
      if (!make_non_increasing(values, weights)) continue;
      ++touched;
      const double shift = log_albedo(rings, before) - log_albedo(rings, values);
      for (std::size_t k = 0; k < knots; ++k) p[k * pixels + x] = values[k] + shift;
    }
  });
  return touched;
}

}  // namespace parian

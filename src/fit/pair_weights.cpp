#include "fit/pair_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"

namespace parian {
namespace {

double distance_weight(PairWeight weight, Offset offset) {
  if (weight != PairWeight::inverse_quadratic) return 1;
  return 1 / (1.0 + static_cast<double>(offset.dx) * offset.dx +
              static_cast<double>(offset.dy) * offset.dy);
}

}  // namespace

std::vector<WeightTerm> make_weight_terms(const ReducedSystem& system,
                                          const ReducedParams& params) {
  std::vector<WeightTerm> terms = params.weights;
  if (terms.empty()) {
    terms.resize(1);
    for (Offset offset : system.offsets)
      terms[0].phi.push_back(distance_weight(params.weight, offset));
    return terms;
  }
  for (WeightTerm& term : terms) {
    PARIAN_CHECK(term.u.empty() || term.u.size() == system.pixels());
    std::vector<double> phi;
    phi.reserve(system.table_index.size());
    for (int index : system.table_index)
      phi.push_back(term.phi.at(static_cast<std::size_t>(index)));
    term.phi = std::move(phi);
  }
  return terms;
}

bool has_pair_weights(const ReducedSystem& system) {
  if (system.weights.size() != 1) return true;
  return !system.weights[0].u.empty();
}

std::vector<std::uint32_t> unmeasured_pixels(const ReducedSystem& system) {
  std::vector<std::uint32_t> pixels;
  for (std::uint32_t x = 0; x < system.pixels(); ++x)
    if (std::all_of(system.weights.begin(), system.weights.end(),
                    [&](const WeightTerm& term) { return !term.u.empty() && term.u[x] == 0; }))
      pixels.push_back(x);
  return pixels;
}

bool is_masked(const ReducedSystem& system, Offset offset, std::size_t pixel) {
  const auto partner = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(pixel) +
                                                offset.dy * system.width + offset.dx);
  return std::all_of(system.weights.begin(), system.weights.end(), [&](const WeightTerm& term) {
    return !term.u.empty() && (term.u[pixel] == 0 || term.u[partner] == 0);
  });
}

void fill_pair_weights(const ReducedSystem& system, const TableHeader& header, std::size_t i, int y,
                       const float* slice, float* weight) {
  const Offset offset = system.offsets[i];
  const PixelRange range = pairs_in_grid(header, offset);
  std::fill_n(weight, system.width, 0.0f);
  if (y < range.y0 || y >= range.y1) return;
  const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(system.width);
  for (int x = range.x0; x < range.x1; ++x) {
    const std::size_t pixel = row + static_cast<std::size_t>(x);
    const auto partner = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(pixel) +
                                                  offset.dy * system.width + offset.dx);
    double sum = 0;
    if (slice == nullptr || slice[pixel] >= std::numeric_limits<float>::min()) {
      for (const WeightTerm& term : system.weights)
        sum += term.u.empty() ? term.phi[i]
                              : term.phi[i] * static_cast<double>(term.u[pixel]) *
                                    static_cast<double>(term.u[partner]);
    }
    weight[x] = static_cast<float>(sum);
  }
}

}  // namespace parian

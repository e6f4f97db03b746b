// The translation-invariant part of H, inverted per spatial frequency.
#include <algorithm>
#include <cmath>

#include "base/hot.h"
#include "base/parallel.h"
#include "fit/hessian.h"
#include "fit/hessian_internal.h"

namespace parian {
namespace {

constexpr std::size_t frequency_block = 256;
// Relative to the diagonal: keeps the factors finite where no offset sees a knot (algorithms: the
// (pi, pi) mode), and well above single-precision rounding. Only the preconditioner has it.
constexpr double ridge = 1e-5;

// here -= l1 back1 + c2 inverse back2 (spectra, real factors)
PARIAN_HOT void eliminate(float* PARIAN_RESTRICT here, const float* PARIAN_RESTRICT back1,
                          const float* PARIAN_RESTRICT back2, const float* PARIAN_RESTRICT l1,
                          const float* PARIAN_RESTRICT inverse, float c2, std::size_t count) {
  constexpr std::size_t lanes = spectrum_lanes<float>;
  for (std::size_t f = 0; f < count; f += lanes)
    for (std::size_t part = 0; part < 2 * lanes; part += lanes)
      for (std::size_t l = 0; l < lanes; ++l)
        here[2 * f + part + l] -=
            l1[f + l] * back1[2 * f + part + l] + c2 * inverse[f + l] * back2[2 * f + part + l];
}

PARIAN_HOT void scale_by(float* PARIAN_RESTRICT here, const float* PARIAN_RESTRICT factor,
                         std::size_t count) {
  constexpr std::size_t lanes = spectrum_lanes<float>;
  for (std::size_t f = 0; f < count; f += lanes)
    for (std::size_t part = 0; part < 2 * lanes; part += lanes)
      for (std::size_t l = 0; l < lanes; ++l) here[2 * f + part + l] *= factor[f + l];
}

// mean(u^2) of each weight term: how much of its interior rows is left on average.
std::vector<double> mean_squares(const ReducedSystem& system) {
  std::vector<double> means;
  for (const WeightTerm& term : system.weights) {
    double sum = 0;
    for (float u : term.u) sum += static_cast<double>(u) * static_cast<double>(u);
    means.push_back(term.u.empty() ? 1.0 : sum / static_cast<double>(term.u.size()));
  }
  return means;
}

// A(f) = D_interior + K(f) + lambda^2 L^T L, L D L^T factors for frequencies [begin, end).
void factor_block(const ReducedSystem& system, const Hessian& hessian,
                  const std::vector<double>& scale, std::size_t begin, std::size_t end,
                  Preconditioner& factors) {
  const std::size_t knots = hessian.knots, size = hessian.grid.frequencies<float>();
  const CurvatureBands bands = curvature_bands(system);
  const auto kernel = [&](std::size_t j, std::size_t f) {
    double sum = 0;
    for (std::size_t q = 0; q < scale.size(); ++q)
      sum += scale[q] * (static_cast<double>(hessian.kernels_single[q][j * size]) +
                         static_cast<double>(hessian.kernels_single[q][j * size + f]));
    return sum;
  };
  double largest = 0;
  for (std::size_t k = 0; k < knots; ++k)
    largest = std::max(largest, kernel(2 * k, 0) + bands.main[k]);
  std::vector<double> d(knots), l1(knots + 2), l2(knots + 2);
  for (std::size_t f = begin; f < end; ++f) {
    for (std::size_t k = 0; k < knots; ++k) {
      double pivot = kernel(2 * k, f) + bands.main[k];
      pivot += ridge * (pivot + 1e-3 * largest);
      const double floor = 0.5 * ridge * (pivot + 1e-3 * largest);
      if (k > 0) pivot -= l1[k] * l1[k] * d[k - 1];
      if (k > 1) pivot -= l2[k] * l2[k] * d[k - 2];
      d[k] = std::max(pivot, floor);
      const double next = k + 1 < knots ? kernel(2 * k + 1, f) + bands.first[k] : 0;
      l1[k + 1] = (next - (k > 0 ? l2[k + 1] * l1[k] * d[k - 1] : 0)) / d[k];
      l2[k + 2] = (k + 2 < knots ? bands.second[k] : 0) / d[k];
      factors.inverse_diagonal[k * size + f] = static_cast<float>(1 / d[k]);
      factors.lower1[k * size + f] = static_cast<float>(l1[k]);
    }
  }
}

void solve_block(const Preconditioner& factors, std::size_t size, std::size_t knots,
                 float* spectrum, std::size_t begin, std::size_t count) {
  static constexpr float zeros[2 * frequency_block] = {};
  const auto plane = [&](std::size_t k) { return spectrum + 2 * (k * size + begin); };
  const auto inverse = [&](std::size_t k) { return &factors.inverse_diagonal[k * size + begin]; };
  const auto lower = [&](std::size_t k) { return &factors.lower1[k * size + begin]; };
  for (std::size_t k = 1; k < knots; ++k) {
    const bool two = k > 1;
    eliminate(plane(k), plane(k - 1), two ? plane(k - 2) : zeros, lower(k),
              two ? inverse(k - 2) : zeros, two ? factors.second[k - 2] : 0, count);
  }
  for (std::size_t k = knots; k-- > 0;) {
    scale_by(plane(k), inverse(k), count);
    if (k + 1 == knots) continue;
    const bool two = k + 2 < knots;
    eliminate(plane(k), plane(k + 1), two ? plane(k + 2) : zeros, lower(k + 1), inverse(k),
              two ? factors.second[k] : 0, count);
  }
}

}  // namespace

Preconditioner make_preconditioner(const ReducedSystem& system, const Hessian& hessian) {
  const std::size_t size = hessian.grid.frequencies<float>(), total = size * hessian.knots;
  const CurvatureBands bands = curvature_bands(system);
  Preconditioner factors{std::vector<float>(total),
                         std::vector<float>(total),
                         {bands.second.begin(), bands.second.end()}};
  const std::vector<double> scale = mean_squares(system);
  parallel_for_blocks(size, frequency_block, [&](std::size_t begin, std::size_t end) {
    factor_block(system, hessian, scale, begin, end, factors);
  });
  return factors;
}

void apply_preconditioner(const Preconditioner& preconditioner, const Hessian& hessian,
                          const float* r, float* z, HessianWorkspace& workspace,
                          const PlaneHooks& hooks) {
  const FftGrid& grid = hessian.grid;
  const std::size_t size = grid.frequencies<float>(), knots = hessian.knots, pixels = grid.pixels();
  if (workspace.spectrum.size() < knots * size) workspace.spectrum.resize(knots * size);
  auto* spectrum = reinterpret_cast<float*>(workspace.spectrum.data());
  parallel_for(knots, [&](std::size_t k) {
    if (hooks.before) hooks.before(k);
    forward_fft(grid, r + k * pixels, spectrum + 2 * k * size);
  });
  parallel_for_blocks(size, frequency_block, [&](std::size_t begin, std::size_t end) {
    solve_block(preconditioner, size, knots, spectrum, begin, end - begin);
  });
  parallel_for(knots, [&](std::size_t k) {
    inverse_fft(grid, spectrum + 2 * k * size, z + k * pixels);
    if (hooks.after) hooks.after(k);
  });
}

}  // namespace parian

// The translation-invariant part of H, inverted per spatial frequency.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

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
// Of H's diagonal relative to an interior pixel's: masked pixels have none.
constexpr double least_diagonal = 0.05;

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

PARIAN_HOT void multiply(const float* PARIAN_RESTRICT in, const float* PARIAN_RESTRICT factor,
                         float* PARIAN_RESTRICT out, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) out[i] = factor[i] * in[i];
}
PARIAN_HOT void multiply_by(float* PARIAN_RESTRICT values, const float* PARIAN_RESTRICT factor,
                            std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) values[i] *= factor[i];
}

// Adds the squares of `values` times `inverse` to the sums of each lane.
PARIAN_HOT void add_squares(const float* PARIAN_RESTRICT values,
                            const float* PARIAN_RESTRICT inverse,
                            const float* PARIAN_RESTRICT weight, double* PARIAN_RESTRICT sums,
                            std::size_t count) {
  constexpr std::size_t lanes = spectrum_lanes<float>;
  for (std::size_t f = 0; f < count; f += lanes) {
    for (std::size_t l = 0; l < lanes; ++l) {
      const float re = values[2 * f + l], im = values[2 * f + lanes + l];
      sums[l] += static_cast<double>(weight[f + l] * inverse[f + l] * (re * re + im * im));
    }
  }
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

// M = S A^-1 S with S^2 = A's diagonal / H's, so that M H has the diagonal of an interior pixel
// everywhere: towards the edges, where pixels have ever fewer pairs, A alone is up to 4 times H.
std::vector<float> make_scale(const ReducedSystem& system, const Hessian& hessian,
                              const std::vector<double>& means) {
  const std::size_t stored = hessian.block_rows * static_cast<std::size_t>(hessian.grid.width);
  const std::size_t size = hessian.grid.frequencies<float>();
  const CurvatureBands bands = curvature_bands(system);
  std::vector<float> scale(hessian.knots * stored);
  parallel_for(hessian.knots, [&](std::size_t k) {
    double interior = 0;
    for (std::size_t q = 0; q < means.size(); ++q)
      interior += means[q] * static_cast<double>(hessian.kernels_single[q][2 * k * size]);
    const double least = least_diagonal * interior + 1e-30;
    for (std::size_t i = k * stored; i < (k + 1) * stored; ++i)
      scale[i] =
          static_cast<float>(std::sqrt((interior + bands.main[k] + 1e-30) /
                                       (std::max(hessian.diagonal[i], least) + bands.main[k])));
  });
  return scale;
}

// sum += factor (at_zero + values)
PARIAN_HOT void add_shifted(double factor, double at_zero, const float* PARIAN_RESTRICT values,
                            double* PARIAN_RESTRICT sum, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    sum[i] += factor * (at_zero + static_cast<double>(values[i]));
}

// One knot's step of the factorisation for a block of frequencies.
struct FactorStep {
  double diagonal = 0, next = 0;       // the curvature's part of A(k, k) and A(k, k + 1)
  double second = 0, second_next = 0;  // A(k - 2, k), A(k - 1, k + 1)
  double least = 0;                    // see `ridge`
};
// In: kernel sums of (k, k) and (k, k + 1); d1, d2, l1: D(k - 1), D(k - 2), L(k, k - 1), which
// become those of k + 1.
PARIAN_HOT void factor_knot(const FactorStep* step, const double* PARIAN_RESTRICT kernel,
                            const double* PARIAN_RESTRICT kernel_next, double* PARIAN_RESTRICT d1,
                            double* PARIAN_RESTRICT d2, double* PARIAN_RESTRICT l1,
                            float* PARIAN_RESTRICT inverse, float* PARIAN_RESTRICT lower,
                            std::size_t count) {
  const FactorStep s = *step;
  for (std::size_t i = 0; i < count; ++i) {
    const double raw = kernel[i] + s.diagonal;
    const double pivot = raw + ridge * (raw + s.least);
    const double floor = 0.5 * ridge * (pivot + s.least);
    const double left = (pivot - l1[i] * l1[i] * d1[i]) - s.second * s.second / d2[i];
    const double d = left > floor ? left : floor;
    const double inverse_d = 1 / d;
    inverse[i] = static_cast<float>(inverse_d);
    lower[i] = static_cast<float>(l1[i]);
    l1[i] = (kernel_next[i] + s.next - s.second_next * l1[i]) * inverse_d;
    d2[i] = d1[i];
    d1[i] = d;
  }
}

// A(f) = D_interior + K(f) + lambda^2 L^T L, L D L^T factors for frequencies [begin, end).
void factor_block(const ReducedSystem& system, const Hessian& hessian,
                  const std::vector<double>& scale, std::size_t begin, std::size_t end,
                  Preconditioner& factors) {
  const std::size_t knots = hessian.knots, size = hessian.grid.frequencies<float>(),
                    count = end - begin;
  const CurvatureBands bands = curvature_bands(system);
  const auto at_zero = [&](std::size_t j, std::size_t q) {
    return static_cast<double>(hessian.kernels_single[q][j * size]);
  };
  const auto sum_kernels = [&](std::size_t j, double* sum) {
    std::fill_n(sum, count, 0.0);
    for (std::size_t q = 0; q < scale.size(); ++q)
      add_shifted(scale[q], at_zero(j, q), &hessian.kernels_single[q][j * size + begin], sum,
                  count);
  };
  double largest = 0;
  for (std::size_t k = 0; k < knots; ++k) {
    double sum = bands.main[k];
    for (std::size_t q = 0; q < scale.size(); ++q) sum += 2 * scale[q] * at_zero(2 * k, q);
    largest = std::max(largest, sum);
  }
  double kernel[frequency_block], next[frequency_block] = {}, d1[frequency_block],
                                  d2[frequency_block], l1[frequency_block] = {};
  std::fill_n(d1, count, 1.0);
  std::fill_n(d2, count, 1.0);
  for (std::size_t k = 0; k < knots; ++k) {
    const bool last = k + 1 == knots;
    sum_kernels(2 * k, kernel);
    if (!last) sum_kernels(2 * k + 1, next);
    const FactorStep step{bands.main[k], bands.first[k], k > 1 ? bands.second[k - 2] : 0,
                          k > 0 ? bands.second[k - 1] : 0, 1e-3 * largest};
    factor_knot(&step, kernel, next, d1, d2, l1, &factors.inverse_diagonal[k * size + begin],
                &factors.lower1[k * size + begin], count);
  }
}

// In place: A^-1 of the spectra for `count` frequencies. Returns their part of r^T A^-1 r, which is
// |L^-1 r|^2 weighted with the inverse diagonal (Parseval).
double solve_block(const Preconditioner& factors, std::size_t size, std::size_t knots,
                   float* spectrum, std::size_t begin, std::size_t count) {
  static constexpr float zeros[2 * frequency_block] = {};
  const auto plane = [&](std::size_t k) { return spectrum + 2 * (k * size + begin); };
  const auto inverse = [&](std::size_t k) { return &factors.inverse_diagonal[k * size + begin]; };
  const auto lower = [&](std::size_t k) { return &factors.lower1[k * size + begin]; };
  double sums[spectrum_lanes<float>] = {};
  for (std::size_t k = 0; k < knots; ++k) {
    const bool two = k > 1;
    if (k > 0)
      eliminate(plane(k), plane(k - 1), two ? plane(k - 2) : zeros, lower(k),
                two ? inverse(k - 2) : zeros, two ? factors.second[k - 2] : 0, count);
    add_squares(plane(k), inverse(k), &factors.parseval[begin], sums, count);
  }
  for (std::size_t k = knots; k-- > 0;) {
    scale_by(plane(k), inverse(k), count);
    if (k + 1 == knots) continue;
    const bool two = k + 2 < knots;
    eliminate(plane(k), plane(k + 1), two ? plane(k + 2) : zeros, lower(k + 1), inverse(k),
              two ? factors.second[k] : 0, count);
  }
  return std::accumulate(std::begin(sums), std::end(sums), 0.0);
}

// Calls body(first pixel, S of the row) for the rows of plane k.
template <typename Body>
void for_scale_rows(const Preconditioner& preconditioner, const Hessian& hessian, std::size_t k,
                    const Body& body) {
  const auto width = static_cast<std::size_t>(hessian.grid.width);
  const float* scale = &preconditioner.scale[k * hessian.block_rows * width];
  for (std::size_t y = 0; y < hessian.block_row.size(); ++y)
    body(y * width, scale + hessian.block_row[y] * width);
}

float* spectrum_of_plane(const Hessian& hessian, std::size_t k, HessianWorkspace& workspace) {
  return reinterpret_cast<float*>(workspace.spectrum.data()) +
         2 * k * hessian.grid.frequencies<float>();
}

}  // namespace

Preconditioner make_preconditioner(const ReducedSystem& system, const Hessian& hessian) {
  const std::size_t size = hessian.grid.frequencies<float>(), total = size * hessian.knots;
  const CurvatureBands bands = curvature_bands(system);
  const std::vector<double> means = mean_squares(system);
  Preconditioner factors{make_scale(system, hessian, means),
                         AlignedVector<float>(total),
                         AlignedVector<float>(total),
                         {bands.second.begin(), bands.second.end()},
                         AlignedVector<float>(size)};
  fill_parseval_weights(hessian.grid, factors.parseval.data());
  parallel_for_blocks(size, frequency_block, [&](std::size_t begin, std::size_t end) {
    factor_block(system, hessian, means, begin, end, factors);
  });
  return factors;
}

double apply_preconditioner(const Preconditioner& preconditioner, const Hessian& hessian,
                            const float* r, HessianWorkspace& workspace,
                            const std::function<void(std::size_t)>& before) {
  const FftGrid& grid = hessian.grid;
  const std::size_t size = grid.frequencies<float>(), knots = hessian.knots, pixels = grid.pixels();
  if (workspace.spectrum.size() < knots * size) workspace.spectrum.resize(knots * size);
  parallel_for(knots, [&](std::size_t k) {
    if (before) before(k);
    AlignedVector<float> scaled(pixels);
    for_scale_rows(preconditioner, hessian, k, [&](std::size_t at, const float* scale) {
      multiply(r + k * pixels + at, scale, &scaled[at], static_cast<std::size_t>(grid.width));
    });
    forward_fft(grid, scaled.data(), spectrum_of_plane(hessian, k, workspace));
  });
  return parallel_sum(size, frequency_block, [&](std::size_t begin, std::size_t end) {
    return solve_block(preconditioner, size, knots, spectrum_of_plane(hessian, 0, workspace), begin,
                       end - begin);
  });
}

void finish_preconditioner(const Preconditioner& preconditioner, const Hessian& hessian,
                           std::size_t k, HessianWorkspace& workspace, float* z) {
  inverse_fft(hessian.grid, spectrum_of_plane(hessian, k, workspace), z);
  for_scale_rows(preconditioner, hessian, k, [&](std::size_t at, const float* scale) {
    multiply_by(z + at, scale, static_cast<std::size_t>(hessian.grid.width));
  });
}

}  // namespace parian

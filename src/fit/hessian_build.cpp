// Kernels and block diagonal of a Hessian.
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "fit/hessian.h"
#include "fit/hessian_internal.h"

namespace parian {
namespace {

// c_k(|d|) c_l(|d|) of offset i for plane j of Hessian::kernels.
double hat_product(const ReducedSystem& system, std::size_t i, std::size_t j) {
  const int k = static_cast<int>(j / 2);
  const double f = system.fraction[i];
  if (j % 2 == 1) return system.segment[i] == k ? (1 - f) * f : 0;
  if (system.segment[i] == k) return (1 - f) * (1 - f);
  return system.segment[i] == k - 1 ? f * f : 0;
}

// Calls add(d, K_kl(d)) with K_kl(d) = m phi c_k c_l for the listed offsets and their opposites.
template <typename Add>
void for_each_tap(const ReducedSystem& system, const WeightTerm& term, std::size_t j,
                  const Add& add) {
  for (std::size_t i = 0; i < system.offsets.size(); ++i) {
    const double value = system.pair_count[i] * term.phi[i] * hat_product(system, i, j);
    if (value == 0) continue;
    add(system.offsets[i], value);
    add(Offset{-system.offsets[i].dx, -system.offsets[i].dy}, value);
  }
}

// Real spectrum of K_kl: K is even.
template <typename Real>
void transform_kernel(const ReducedSystem& system, const WeightTerm& term, const FftGrid& grid,
                      std::size_t j, Real* kernel) {
  const auto width = static_cast<std::size_t>(grid.padded_width);
  std::vector<Real> taps(width * static_cast<std::size_t>(grid.padded_height));
  for_each_tap(system, term, j, [&](Offset d, double value) {
    const int x = d.dx < 0 ? d.dx + grid.padded_width : d.dx;
    const int y = d.dy < 0 ? d.dy + grid.padded_height : d.dy;
    taps[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] +=
        static_cast<Real>(value);
  });
  AlignedVector<Real> spectrum(2 * grid.frequencies<Real>());
  forward_fft_padded(grid, taps.data(), spectrum.data());
  constexpr std::size_t lanes = spectrum_lanes<Real>;
  for (std::size_t f = 0; f < grid.frequencies<Real>(); ++f)
    kernel[f] = spectrum[f / lanes * 2 * lanes + f % lanes];
}

// K * 1 inside the grid: sums of K over the rectangle of offsets that stay inside, from a
// summed-area table. target += the result.
void add_box_sums(const ReducedSystem& system, const WeightTerm& term, Offset reach, std::size_t j,
                  const std::vector<int>& rows, double* target) {
  const int wide = 2 * reach.dx + 2, high = 2 * reach.dy + 2;
  std::vector<double> sums(static_cast<std::size_t>(wide) * static_cast<std::size_t>(high));
  const auto at_table = [&](int x, int y) -> double& {
    return sums[static_cast<std::size_t>(y) * static_cast<std::size_t>(wide) +
                static_cast<std::size_t>(x)];
  };
  for_each_tap(system, term, j, [&](Offset d, double value) {
    at_table(d.dx + reach.dx + 1, d.dy + reach.dy + 1) += value;
  });
  for (int y = 1; y < high; ++y)
    for (int x = 1; x < wide; ++x)
      at_table(x, y) += at_table(x - 1, y) + at_table(x, y - 1) - at_table(x - 1, y - 1);
  for (int y : rows) {
    const int y0 = std::max(-y, -reach.dy) + reach.dy;
    const int y1 = std::min(system.height - 1 - y, reach.dy) + reach.dy + 1;
    for (int x = 0; x < system.width; ++x) {
      const int x0 = std::max(-x, -reach.dx) + reach.dx;
      const int x1 = std::min(system.width - 1 - x, reach.dx) + reach.dx + 1;
      *target++ += at_table(x1, y1) - at_table(x0, y1) - at_table(x1, y0) + at_table(x0, y0);
    }
  }
}

// u (K * u) for a term with pixel factors. target += the result.
void add_masked_sums(const ReducedSystem& system, const WeightTerm& term, const FftGrid& grid,
                     const AlignedVector<double>& u_spectrum, std::size_t j, double* target) {
  std::vector<double> kernel(grid.frequencies<double>()), block(system.pixels());
  transform_kernel(system, term, grid, j, kernel.data());
  AlignedVector<double> spectrum(u_spectrum);
  constexpr std::size_t lanes = spectrum_lanes<double>;
  for (std::size_t i = 0; i < spectrum.size(); ++i)
    spectrum[i] *= kernel[i / (2 * lanes) * lanes + i % lanes];
  inverse_fft(grid, spectrum.data(), block.data());
  for (std::size_t x = 0; x < block.size(); ++x)
    target[x] += static_cast<double>(term.u[x]) * block[x];
}

void add_term(const ReducedSystem& system, const WeightTerm& term, Offset reach,
              const std::vector<int>& rows, bool exact, Hessian& hessian) {
  const FftGrid& grid = hessian.grid;
  const std::size_t planes = 2 * hessian.knots - 1;
  const std::size_t size = grid.frequencies<float>(), exact_size = grid.frequencies<double>();
  AlignedVector<double> u_spectrum(term.u.empty() ? 0 : 2 * exact_size);
  if (!term.u.empty()) {
    const std::vector<double> u(term.u.begin(), term.u.end());
    forward_fft(grid, u.data(), u_spectrum.data());
  }
  std::vector<float>& single = hessian.kernels_single.emplace_back(planes * size);
  if (exact) hessian.kernels.emplace_back(planes * exact_size);
  parallel_for(planes, [&](std::size_t j) {
    transform_kernel(system, term, grid, j, &single[j * size]);
    if (exact) transform_kernel(system, term, grid, j, &hessian.kernels.back()[j * exact_size]);
    double* target = (j % 2 == 0 ? hessian.diagonal : hessian.coupling).data() +
                     j / 2 * hessian.block_rows * static_cast<std::size_t>(system.width);
    if (term.u.empty()) {
      add_box_sums(system, term, reach, j, rows, target);
    } else {
      add_masked_sums(system, term, grid, u_spectrum, j, target);
    }
  });
}

ProductMethod choose_method(const ReducedSystem& system, const FftGrid& grid) {
  if (system.restream != nullptr) return ProductMethod::explicit_;
  // Measured: about as many nanoseconds per pair as per padded pixel and transform.
  const double pairs =
      static_cast<double>(system.offsets.size()) * static_cast<double>(system.pixels());
  const double transforms = 2.0 * static_cast<double>(system.knots() * system.weights.size()) * 2 *
                            static_cast<double>(grid.frequencies<float>());
  return pairs < transforms ? ProductMethod::explicit_ : ProductMethod::fft;
}

// Rows whose blocks differ, and which of them each row has.
std::vector<int> place_block_rows(const ReducedSystem& system, Offset reach, Hessian& hessian) {
  const bool weighted = std::any_of(system.weights.begin(), system.weights.end(),
                                    [](const WeightTerm& term) { return !term.u.empty(); });
  std::vector<int> rows;
  for (int y = 0; y < system.height; ++y) {
    const bool inner = y > reach.dy && y <= system.height - 1 - reach.dy;  // as the row above
    if (weighted || !inner || rows.empty()) rows.push_back(y);
    hessian.block_row.push_back(static_cast<std::uint32_t>(rows.size() - 1));
  }
  hessian.block_rows = rows.size();
  return rows;
}

}  // namespace

CurvatureBands curvature_bands(const ReducedSystem& system) {
  const std::size_t knots = system.knots();
  CurvatureBands bands{std::vector<double>(knots), std::vector<double>(knots),
                       std::vector<double>(knots)};
  for (std::size_t k = 0; k + 2 < knots; ++k) {
    const auto [l, m, r] = second_difference(system.knots_mm, k);
    const double s = system.lambda * system.lambda;
    bands.main[k] += s * l * l;
    bands.main[k + 1] += s * m * m;
    bands.main[k + 2] += s * r * r;
    bands.first[k] += s * l * m;
    bands.first[k + 1] += s * m * r;
    bands.second[k] += s * l * r;
  }
  for (std::size_t k = 0; k < system.slope_weight.size(); ++k) {
    bands.main[k] += system.slope_weight[k];
    bands.main[k + 1] += system.slope_weight[k];
    bands.first[k] -= system.slope_weight[k];
  }
  return bands;
}

Hessian make_hessian(const ReducedSystem& system, ProductMethod method, bool exact) {
  Offset reach;
  for (Offset offset : system.offsets) {
    reach.dx = std::max(reach.dx, std::abs(offset.dx));
    reach.dy = std::max(reach.dy, std::abs(offset.dy));
  }
  Hessian hessian;
  hessian.grid = make_fft_grid(system.width, system.height, reach.dx, reach.dy);
  hessian.knots = system.knots();
  hessian.method =
      method == ProductMethod::automatic ? choose_method(system, hessian.grid) : method;
  const std::vector<int> rows = place_block_rows(system, reach, hessian);
  const std::size_t plane = rows.size() * static_cast<std::size_t>(system.width);
  hessian.diagonal.assign(hessian.knots * plane, 0.0);
  hessian.coupling.assign((hessian.knots - 1) * plane, 0.0);
  const bool by_convolution = hessian.method == ProductMethod::fft;
  for (const WeightTerm& term : system.weights)
    add_term(system, term, reach, rows, exact && by_convolution, hessian);
  hessian.diagonal_single.assign(hessian.diagonal.begin(), hessian.diagonal.end());
  hessian.coupling_single.assign(hessian.coupling.begin(), hessian.coupling.end());
  return hessian;
}

bool shares_hessian(const ReducedSystem& system, const ReducedSystem& other) {
  if (system.restream != nullptr || other.restream != nullptr) return false;
  if (system.width != other.width || system.height != other.height ||
      system.knots_mm != other.knots_mm || system.slope_weight != other.slope_weight ||
      system.offsets != other.offsets || system.pair_count != other.pair_count ||
      system.weights.size() != other.weights.size())
    return false;
  for (std::size_t q = 0; q < system.weights.size(); ++q)
    if (system.weights[q].u != other.weights[q].u || system.weights[q].phi != other.weights[q].phi)
      return false;
  return true;
}

}  // namespace parian

// Products with the Hessian by convolution: kernels, block diagonal, curvature.
#include "fit/hessian.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/hot.h"
#include "base/parallel.h"
#include "fit/hessian_internal.h"

namespace parian {
namespace {

constexpr std::size_t frequency_block = 512;

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
                  double* target) {
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
  for (int y = 0; y < system.height; ++y) {
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

void add_term(const ReducedSystem& system, const WeightTerm& term, Offset reach, bool exact,
              Hessian& hessian) {
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
    double* target =
        (j % 2 == 0 ? hessian.diagonal : hessian.coupling).data() + j / 2 * system.pixels();
    if (term.u.empty()) {
      add_box_sums(system, term, reach, j, target);
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

template <typename Real>
struct Blocks {
  const Real *diagonal, *coupling;
};
template <typename Real>
Blocks<Real> blocks_of(const Hessian& hessian) {
  if constexpr (sizeof(Real) == sizeof(float)) {
    return {hessian.diagonal_single.data(), hessian.coupling_single.data()};
  } else {
    return {hessian.diagonal.data(), hessian.coupling.data()};
  }
}
template <typename Real>
const Real* kernels_of(const Hessian& hessian, std::size_t q) {
  if constexpr (sizeof(Real) == sizeof(float)) {
    return hessian.kernels_single[q].data();
  } else {
    return hessian.kernels[q].data();
  }
}

// In place, for each frequency: the tridiagonal matrix of kernel values times the vector over
// knots.
template <typename Real>
void multiply_frequencies(const Real* kernels, std::size_t size, std::size_t knots, Real* spectrum,
                          std::size_t begin, std::size_t end) {
  static constexpr Real zeros[2 * frequency_block] = {};
  Real previous[2 * frequency_block];
  const std::size_t count = end - begin;
  std::fill_n(previous, 2 * count, Real(0));
  for (std::size_t k = 0; k < knots; ++k) {
    Real* here = spectrum + 2 * (k * size + begin);
    const bool last = k + 1 == knots;
    const Real* above = last ? zeros : spectrum + 2 * ((k + 1) * size + begin);
    const Real* diagonal = kernels + 2 * k * size + begin;
    const Real* up = last ? diagonal : kernels + (2 * k + 1) * size + begin;
    const Real* down = k == 0 ? diagonal : kernels + (2 * k - 1) * size + begin;
    multiply_block(here, above, previous, diagonal, up, down, last ? 0 : 1, k == 0 ? 0 : 1, count);
  }
}

template <typename Real>
Real* spectrum_of(HessianWorkspace& workspace, std::size_t values) {
  const std::size_t doubles = (values * sizeof(Real) + sizeof(double) - 1) / sizeof(double);
  if (workspace.spectrum.size() < doubles) workspace.spectrum.resize(doubles);
  return reinterpret_cast<Real*>(workspace.spectrum.data());
}

template <typename Real>
void multiply_plane(const float* u, const Real* in, Real* out, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<Real>(u[i]) * in[i];
}

double mean_of(const double* values, std::size_t count) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) sum += values[i];
  return sum / static_cast<double>(count);
}

// out_k += ((D + lambda^2 L^T L) p)_k; without blocks only the curvature.
template <typename Real>
void add_local(const CurvatureBands& bands, const Blocks<Real>& blocks, std::size_t knots,
               std::size_t pixels, std::size_t k, const Real* p, Real* out) {
  const bool up = k + 1 < knots, down = k > 0, up2 = k + 2 < knots, down2 = k > 1;
  LocalRow row;
  row.c0 = bands.main[k];
  row.up = up ? bands.first[k] : 0;
  row.down = down ? bands.first[k - 1] : 0;
  row.up2 = up2 ? bands.second[k] : 0;
  row.down2 = down2 ? bands.second[k - 2] : 0;
  row.use_up = up ? 1 : 0;
  row.use_down = down ? 1 : 0;
  const auto plane = [&](bool exists, std::size_t neighbour) {
    return p + (exists ? neighbour : k) * pixels;  // a plane that does not exist has factor 0
  };
  const Real* diagonal = blocks.diagonal + k * pixels;
  add_local_row(row, diagonal, up ? blocks.coupling + k * pixels : diagonal,
                down ? blocks.coupling + (k - 1) * pixels : diagonal, plane(true, k),
                plane(up, k + 1), plane(down, k - 1), plane(up2, k + 2), plane(down2, k - 2),
                out + k * pixels, pixels);
}

// out += lambda^2 L^T L p
template <typename Real>
void add_curvature(const ReducedSystem& system, const Real* p, Real* out) {
  const CurvatureBands bands = curvature_bands(system);
  const std::size_t pixels = system.pixels(), knots = system.knots();
  parallel_for(knots, [&](std::size_t k) {
    for (std::size_t l = k > 1 ? k - 2 : 0; l < std::min(knots, k + 3); ++l) {
      const std::size_t low = std::min(k, l), apart = std::max(k, l) - low;
      const double value = apart == 0   ? bands.main[low]
                           : apart == 1 ? bands.first[low]
                                        : bands.second[low];
      const auto factor = static_cast<Real>(value);
      for (std::size_t i = 0; i < pixels; ++i) out[k * pixels + i] += factor * p[l * pixels + i];
    }
  });
}

// out (+)= u (K * (u p)) for one weight term; the last one adds what is local. Hooks run with the
// first term's input and the last term's output.
template <typename Real>
void convolve(const ReducedSystem& system, const Hessian& hessian, std::size_t q, const Real* p,
              Real* out, HessianWorkspace& workspace, const PlaneHooks& hooks) {
  const FftGrid& grid = hessian.grid;
  const std::size_t size = grid.frequencies<Real>(), pixels = system.pixels(),
                    knots = hessian.knots;
  const std::vector<float>& u = system.weights[q].u;
  Real* spectrum = spectrum_of<Real>(workspace, 2 * knots * size);
  const bool first = q == 0, last = q + 1 == system.weights.size();
  parallel_for(knots, [&](std::size_t k) {
    if (first && hooks.before) hooks.before(k);
    if (u.empty()) return forward_fft(grid, p + k * pixels, spectrum + 2 * k * size);
    std::vector<Real> masked(pixels);
    multiply_plane(u.data(), p + k * pixels, masked.data(), pixels);
    forward_fft(grid, masked.data(), spectrum + 2 * k * size);
  });
  parallel_for_blocks(size, frequency_block, [&](std::size_t begin, std::size_t end) {
    multiply_frequencies(kernels_of<Real>(hessian, q), size, knots, spectrum, begin, end);
  });
  const CurvatureBands bands = curvature_bands(system);
  parallel_for(knots, [&](std::size_t k) {
    Real* target = out + k * pixels;
    if (first && u.empty()) {
      inverse_fft(grid, spectrum + 2 * k * size, target);
    } else {
      std::vector<Real> plane(pixels);
      inverse_fft(grid, spectrum + 2 * k * size, plane.data());
      if (!u.empty()) multiply_plane(u.data(), plane.data(), plane.data(), pixels);
      for (std::size_t i = 0; i < pixels; ++i) target[i] = first ? plane[i] : target[i] + plane[i];
    }
    if (last) add_local(bands, blocks_of<Real>(hessian), knots, pixels, k, p, out);
    if (last && hooks.after) hooks.after(k);
  });
}

template <typename Real>
void apply(const ReducedSystem& system, const Hessian& hessian, const Real* p, Real* out,
           HessianWorkspace& workspace, const PlaneHooks& hooks = {}) {
  PARIAN_CHECK_EQ(hessian.knots, system.knots());
  const bool by_convolution = hessian.method == ProductMethod::fft;
  const bool together = by_convolution && !has_missing(system);
  const auto run = [&](const std::function<void(std::size_t)>& hook) {
    if (hook && !together) parallel_for(hessian.knots, hook);
  };
  run(hooks.before);
  if (by_convolution) {
    if constexpr (sizeof(Real) == sizeof(double)) PARIAN_CHECK(!hessian.kernels.empty());
    for (std::size_t q = 0; q < system.weights.size(); ++q)
      convolve(system, hessian, q, p, out, workspace, together ? hooks : PlaneHooks{});
    subtract_missing(system, p, out);
  } else {
    std::fill_n(out, system.unknowns(), Real(0));
    add_pairs(system, p, out);
    add_curvature(system, p, out);
  }
  run(hooks.after);
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
  hessian.diagonal.assign(system.unknowns(), 0.0);
  hessian.coupling.assign(system.unknowns() - system.pixels(), 0.0);
  const bool by_convolution = hessian.method == ProductMethod::fft;
  for (const WeightTerm& term : system.weights)
    add_term(system, term, reach, exact && by_convolution, hessian);
  hessian.diagonal_single.assign(hessian.diagonal.begin(), hessian.diagonal.end());
  hessian.coupling_single.assign(hessian.coupling.begin(), hessian.coupling.end());
  return hessian;
}

bool shares_hessian(const ReducedSystem& system, const ReducedSystem& other) {
  if (system.restream != nullptr || other.restream != nullptr) return false;
  if (system.width != other.width || system.height != other.height ||
      system.knots_mm != other.knots_mm || system.offsets != other.offsets ||
      system.pair_count != other.pair_count || system.weights.size() != other.weights.size())
    return false;
  for (std::size_t q = 0; q < system.weights.size(); ++q)
    if (system.weights[q].u != other.weights[q].u || system.weights[q].phi != other.weights[q].phi)
      return false;
  return true;
}

void apply_hessian(const ReducedSystem& system, const Hessian& hessian, const double* p,
                   double* out, HessianWorkspace& workspace) {
  apply(system, hessian, p, out, workspace);
}
void apply_hessian(const ReducedSystem& system, const Hessian& hessian, const float* p, float* out,
                   HessianWorkspace& workspace, const PlaneHooks& hooks) {
  apply(system, hessian, p, out, workspace, hooks);
}

void apply_hessian_to_constant(const ReducedSystem& system, const Hessian& hessian,
                               const std::vector<double>& profile, double* out,
                               HessianWorkspace& workspace) {
  const std::size_t pixels = system.pixels(), knots = hessian.knots;
  PARIAN_CHECK_EQ(profile.size(), knots);
  std::vector<double> field(system.unknowns());
  for (std::size_t k = 0; k < knots; ++k)
    std::fill_n(field.begin() + static_cast<std::ptrdiff_t>(k * pixels), pixels, profile[k]);
  if (system.restream != nullptr)
    return apply_hessian(system, hessian, field.data(), out, workspace);
  // Per term C p = u (K * (u p)) = D p for a p that does not depend on x: H p = 2 D p + curvature.
  const CurvatureBands bands = curvature_bands(system);
  parallel_for(knots, [&](std::size_t k) {
    double* target = out + k * pixels;
    const double* diagonal = &hessian.diagonal[k * pixels];
    const double* up = k + 1 < knots ? &hessian.coupling[k * pixels] : nullptr;
    const double* down = k > 0 ? &hessian.coupling[(k - 1) * pixels] : nullptr;
    double curvature = bands.main[k] * profile[k];
    if (k + 1 < knots) curvature += bands.first[k] * profile[k + 1];
    if (k > 0) curvature += bands.first[k - 1] * profile[k - 1];
    if (k + 2 < knots) curvature += bands.second[k] * profile[k + 2];
    if (k > 1) curvature += bands.second[k - 2] * profile[k - 2];
    for (std::size_t i = 0; i < pixels; ++i) {
      double sum = diagonal[i] * profile[k];
      if (up != nullptr) sum += up[i] * profile[k + 1];
      if (down != nullptr) sum += down[i] * profile[k - 1];
      target[i] = 2 * sum + curvature;
    }
  });
  subtract_missing(system, field.data(), out);
}

namespace {

template <typename Real>
double eval_energy_around_mean(const ReducedSystem& system, const Hessian& hessian,
                               const double* p) {
  const std::size_t pixels = system.pixels();
  const std::vector<double>& b = system.right_hand_side;
  HessianWorkspace workspace;
  std::vector<double> mean;
  for (std::size_t k = 0; k < hessian.knots; ++k) mean.push_back(mean_of(p + k * pixels, pixels));
  std::vector<double> product(system.unknowns());
  apply_hessian_to_constant(system, hessian, mean, product.data(), workspace);
  std::vector<Real> delta(system.unknowns()), delta_product(system.unknowns());
  parallel_for_blocks(system.unknowns(), pixels, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      delta[i] = static_cast<Real>(p[i] - mean[begin / pixels]);
  });
  apply(system, hessian, delta.data(), delta_product.data(), workspace);
  const double difference =
      parallel_sum(system.unknowns(), pixels, [&](std::size_t begin, std::size_t end) {
        const double m = mean[begin / pixels];
        double sum = 0;
        for (std::size_t i = begin; i < end; ++i)
          sum += m * (0.5 * product[i] - b[i]) + (p[i] - m) * (product[i] - b[i]) +
                 0.5 * static_cast<double>(delta[i]) * static_cast<double>(delta_product[i]);
        return sum;
      });
  return system.constant + difference;
}

}  // namespace

double eval_energy(const ReducedSystem& system, const Hessian& hessian, const double* p) {
  const bool exact = hessian.method == ProductMethod::explicit_ || !hessian.kernels.empty();
  return exact ? eval_energy_around_mean<double>(system, hessian, p)
               : eval_energy_around_mean<float>(system, hessian, p);
}

}  // namespace parian

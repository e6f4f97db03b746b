// Products with the Hessian by convolution, and energies.
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

template <typename Real>
struct Blocks {
  const Real *diagonal, *coupling;
  const std::uint32_t* row;
  std::size_t rows, width;
};
template <typename Real>
Blocks<Real> blocks_of(const Hessian& hessian) {
  const auto width = static_cast<std::size_t>(hessian.grid.width);
  if constexpr (sizeof(Real) == sizeof(float)) {
    return {hessian.diagonal_single.data(), hessian.coupling_single.data(),
            hessian.block_row.data(), hessian.block_rows, width};
  } else {
    return {hessian.diagonal.data(), hessian.coupling.data(), hessian.block_row.data(),
            hessian.block_rows, width};
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
  const std::size_t stored = blocks.rows * blocks.width;
  for (std::size_t y = 0; y < pixels / blocks.width; ++y) {
    const std::size_t at = y * blocks.width, from = blocks.row[y] * blocks.width;
    const Real* diagonal = blocks.diagonal + k * stored + from;
    const Real* coupling = blocks.coupling + k * stored + from;
    add_local_row(row, diagonal, up ? coupling : diagonal, down ? coupling - stored : diagonal,
                  plane(true, k) + at, plane(up, k + 1) + at, plane(down, k - 1) + at,
                  plane(up2, k + 2) + at, plane(down2, k - 2) + at, out + k * pixels + at,
                  blocks.width);
  }
}

template <typename Real>
void add_bands(const ReducedSystem& system, const Real* p, Real* out) {
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
    add_bands(system, p, out);
  }
  run(hooks.after);
}

}  // namespace

void add_curvature(const ReducedSystem& system, const float* p, float* out) {
  add_bands(system, p, out);
}
void add_curvature(const ReducedSystem& system, const double* p, double* out) {
  add_bands(system, p, out);
}

void apply_hessian(const ReducedSystem& system, const Hessian& hessian, const double* p,
                   double* out, HessianWorkspace& workspace) {
  apply(system, hessian, p, out, workspace);
}
void apply_hessian(const ReducedSystem& system, const Hessian& hessian, const float* p, float* out,
                   HessianWorkspace& workspace, const PlaneHooks& hooks) {
  apply(system, hessian, p, out, workspace, hooks);
}

std::vector<double> make_constant_field(const ReducedSystem& system,
                                        const std::vector<double>& profile) {
  std::vector<double> field(system.unknowns());
  for (std::size_t k = 0; k < profile.size(); ++k)
    std::fill_n(field.begin() + static_cast<std::ptrdiff_t>(k * system.pixels()), system.pixels(),
                profile[k]);
  return field;
}

void apply_hessian_to_constant(const ReducedSystem& system, const Hessian& hessian,
                               const std::vector<double>& profile, double* out,
                               HessianWorkspace& workspace) {
  const std::size_t pixels = system.pixels(), knots = hessian.knots;
  PARIAN_CHECK_EQ(profile.size(), knots);
  std::vector<double> field;
  if (system.restream != nullptr || has_missing(system))
    field = make_constant_field(system, profile);
  if (system.restream != nullptr)
    return apply_hessian(system, hessian, field.data(), out, workspace);
  // Per term C p = u (K * (u p)) = D p for a p that does not depend on x: H p = 2 D p + curvature.
  const CurvatureBands bands = curvature_bands(system);
  const Blocks<double> blocks = blocks_of<double>(hessian);
  const std::size_t stored = blocks.rows * blocks.width;
  parallel_for(knots, [&](std::size_t k) {
    const auto at_knot = [&](std::size_t l) { return l < knots ? profile[l] : 0.0; };
    double curvature = bands.main[k] * profile[k] + bands.first[k] * at_knot(k + 1) +
                       bands.second[k] * at_knot(k + 2);
    if (k > 0) curvature += bands.first[k - 1] * profile[k - 1];
    if (k > 1) curvature += bands.second[k - 2] * profile[k - 2];
    double* target = out + k * pixels;
    for (std::size_t y = 0; y < pixels / blocks.width; ++y) {
      const std::size_t from = k * stored + blocks.row[y] * blocks.width;
      for (std::size_t x = 0; x < blocks.width; ++x) {
        double sum = blocks.diagonal[from + x] * profile[k];
        if (k + 1 < knots) sum += blocks.coupling[from + x] * profile[k + 1];
        if (k > 0) sum += blocks.coupling[from + x - stored] * profile[k - 1];
        *target++ = 2 * sum + curvature;
      }
    }
  });
  if (!field.empty()) subtract_missing(system, field.data(), out);
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

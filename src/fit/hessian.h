// The matrix H of a reduced system: products with vectors, energies, and the inverse of its
// translation-invariant part as preconditioner.
#pragma once

#include <functional>
#include <vector>

#include "base/aligned.h"
#include "fit/reduced_system.h"
#include "math/fft.h"

namespace parian {

enum class ProductMethod {
  automatic,
  fft,       // convolutions: cost independent of the radius
  explicit_  // pair by pair: small radii, restreamed weights, and the oracle of the tests
};

// Spectra of the ring kernels and the block diagonal. Depends on geometry and weights alone, so
// channels with equal weights share one. Immutable, usable from several threads.
struct Hessian {
  ProductMethod method = ProductMethod::fft;
  FftGrid grid;
  std::size_t knots = 0;
  // The block diagonal. Rows of pixels with the same blocks are stored once: without pixel weights
  // all rows that are farther than the reach from both edges.
  std::vector<std::uint32_t> block_row;  // [y]: which stored row
  std::size_t block_rows = 0;
  std::vector<double> diagonal;  // [k][row][x]: u (K_kk * u), summed over terms
  std::vector<double> coupling;  // [k][row][x]: the same for (k, k+1); knots - 1 planes
  std::vector<float> diagonal_single, coupling_single;
  // Per weight term: real spectra of the kernels 2 phi c_k c_l, planes in the order
  // (0,0), (0,1), (1,1), (1,2), ... of (k,l). Those in double precision only on request.
  std::vector<std::vector<float>> kernels_single;
  std::vector<std::vector<double>> kernels;
};

// `exact`: products with vectors of doubles are possible by convolution too. Energies never need
// them.
Hessian make_hessian(const ReducedSystem& system, ProductMethod method = ProductMethod::automatic,
                     bool exact = true);
// Whether a Hessian that was made for `other` serves `system` as well.
bool shares_hessian(const ReducedSystem& system, const ReducedSystem& other);

// Memory that products reuse: allocate once per solve.
struct HessianWorkspace {
  AlignedVector<double> spectrum;
};

// What a solver does with single planes while they are in cache: before(k) prepares plane k of the
// input, after(k) uses plane k of the output. Called once for each plane, from several threads.
struct PlaneHooks {
  std::function<void(std::size_t k)> before, after;
};

// out = H p, also with the regulariser; p and out are distinct.
void apply_hessian(const ReducedSystem& system, const Hessian& hessian, const double* p,
                   double* out, HessianWorkspace& workspace);
void apply_hessian(const ReducedSystem& system, const Hessian& hessian, const float* p, float* out,
                   HessianWorkspace& workspace, const PlaneHooks& hooks = {});

// The field with that profile at every pixel.
std::vector<double> make_constant_field(const ReducedSystem& system,
                                        const std::vector<double>& profile);

// The same for the field that has the value profile[k] at all pixels, without a convolution.
void apply_hessian_to_constant(const ReducedSystem& system, const Hessian& hessian,
                               const std::vector<double>& profile, double* out,
                               HessianWorkspace& workspace);

// E(p). With p = m + delta, m its mean over the pixels, E(p) = E(m) + g(m)^T delta +
// 1/2 delta^T H delta: without exact products only the last, small term has single precision.
double eval_energy(const ReducedSystem& system, const Hessian& hessian, const double* p);

// Approximate inverse M = S A^-1 S of H. A is H with its block diagonal frozen at the interior
// value: per spatial frequency one banded matrix over knots, factored once (L D L^T). S is diagonal
// and makes up for the pairs that pixels near an edge, or masked ones, do not have.
struct Preconditioner {
  std::vector<float> scale;               // [k][row][x], rows as in Hessian: S
  AlignedVector<float> inverse_diagonal;  // [k][frequency]
  AlignedVector<float> lower1;            // [k][frequency]: L(k, k-1)
  std::vector<float> second;              // [k]: L(k, k-2) = second[k-2] inverse_diagonal[k-2]
  AlignedVector<float> parseval;          // [frequency]: weights of squares
};
Preconditioner make_preconditioner(const ReducedSystem& system, const Hessian& hessian);
// Returns r^T M r and leaves M r as spectra in the workspace; before(k) prepares plane k of r.
double apply_preconditioner(const Preconditioner& preconditioner, const Hessian& hessian,
                            const float* r, HessianWorkspace& workspace,
                            const std::function<void(std::size_t k)>& before = {});
// Plane k of M r after that, once for each k; the product that follows may reuse the workspace for
// plane k then.
void finish_preconditioner(const Preconditioner& preconditioner, const Hessian& hessian,
                           std::size_t k, HessianWorkspace& workspace, float* z);

}  // namespace parian

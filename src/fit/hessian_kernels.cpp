// Vectorised inner loops of Hessian products. The loops are templates that are inlined into the
// cloned functions, one for each precision.
#include "base/hot.h"
#include "fit/hessian_internal.h"

namespace parian {
namespace {

// One knot of (D + lambda^2 L^T L) p.
template <typename Real>
[[gnu::always_inline]] inline void add_local_values(
    const LocalRow& row, const Real* PARIAN_RESTRICT diagonal,
    const Real* PARIAN_RESTRICT coupling_up, const Real* PARIAN_RESTRICT coupling_down,
    const Real* PARIAN_RESTRICT here, const Real* PARIAN_RESTRICT up,
    const Real* PARIAN_RESTRICT down, const Real* PARIAN_RESTRICT up2,
    const Real* PARIAN_RESTRICT down2, Real* PARIAN_RESTRICT out, std::size_t count) {
  const auto c0 = static_cast<Real>(row.c0), c1 = static_cast<Real>(row.up),
             b1 = static_cast<Real>(row.down);
  const auto c2 = static_cast<Real>(row.up2), b2 = static_cast<Real>(row.down2);
  const auto use_up = static_cast<Real>(row.use_up), use_down = static_cast<Real>(row.use_down);
  for (std::size_t i = 0; i < count; ++i)
    out[i] += (diagonal[i] + c0) * here[i] + (use_up * coupling_up[i] + c1) * up[i] +
              (use_down * coupling_down[i] + b1) * down[i] + c2 * up2[i] + b2 * down2[i];
}

// Counts are multiples of the lanes: spectra come in whole blocks.
template <typename Real>
[[gnu::always_inline]] inline void multiply_values(
    Real* PARIAN_RESTRICT here, const Real* PARIAN_RESTRICT above, Real* PARIAN_RESTRICT previous,
    const Real* PARIAN_RESTRICT diagonal, const Real* PARIAN_RESTRICT up,
    const Real* PARIAN_RESTRICT down, Real use_up, Real use_down, std::size_t count) {
  constexpr std::size_t lanes = spectrum_lanes<Real>;
  for (std::size_t f = 0; f < count; f += lanes) {
    for (std::size_t part = 2 * f; part < 2 * f + 2 * lanes; part += lanes) {
      Real product[lanes], old[lanes];
      for (std::size_t l = 0; l < lanes; ++l) {
        old[l] = here[part + l];
        product[l] = diagonal[f + l] * old[l] + use_up * up[f + l] * above[part + l] +
                     use_down * down[f + l] * previous[part + l];
      }
      for (std::size_t l = 0; l < lanes; ++l) here[part + l] = product[l];
      for (std::size_t l = 0; l < lanes; ++l) previous[part + l] = old[l];
    }
  }
}

PARIAN_HOT void local_row_float(const LocalRow* row, const float* const* in, float* out,
                                std::size_t count) {
  add_local_values(*row, in[0], in[1], in[2], in[3], in[4], in[5], in[6], in[7], out, count);
}
PARIAN_HOT void local_row_double(const LocalRow* row, const double* const* in, double* out,
                                 std::size_t count) {
  add_local_values(*row, in[0], in[1], in[2], in[3], in[4], in[5], in[6], in[7], out, count);
}
PARIAN_HOT void multiply_float(float* PARIAN_RESTRICT here, const float* PARIAN_RESTRICT above,
                               float* PARIAN_RESTRICT previous, const float* diagonal,
                               const float* up, const float* down, float use_up, float use_down,
                               std::size_t count) {
  multiply_values(here, above, previous, diagonal, up, down, use_up, use_down, count);
}
PARIAN_HOT void multiply_double(double* PARIAN_RESTRICT here, const double* PARIAN_RESTRICT above,
                                double* PARIAN_RESTRICT previous, const double* diagonal,
                                const double* up, const double* down, double use_up,
                                double use_down, std::size_t count) {
  multiply_values(here, above, previous, diagonal, up, down, use_up, use_down, count);
}

}  // namespace

void add_local_row(const LocalRow& row, const float* diagonal, const float* coupling_up,
                   const float* coupling_down, const float* here, const float* up,
                   const float* down, const float* up2, const float* down2, float* out,
                   std::size_t count) {
  const float* in[] = {diagonal, coupling_up, coupling_down, here, up, down, up2, down2};
  local_row_float(&row, in, out, count);
}
void add_local_row(const LocalRow& row, const double* diagonal, const double* coupling_up,
                   const double* coupling_down, const double* here, const double* up,
                   const double* down, const double* up2, const double* down2, double* out,
                   std::size_t count) {
  const double* in[] = {diagonal, coupling_up, coupling_down, here, up, down, up2, down2};
  local_row_double(&row, in, out, count);
}
void multiply_block(float* here, const float* above, float* previous, const float* diagonal,
                    const float* up, const float* down, double use_up, double use_down,
                    std::size_t count) {
  multiply_float(here, above, previous, diagonal, up, down, static_cast<float>(use_up),
                 static_cast<float>(use_down), count);
}
void multiply_block(double* here, const double* above, double* previous, const double* diagonal,
                    const double* up, const double* down, double use_up, double use_down,
                    std::size_t count) {
  multiply_double(here, above, previous, diagonal, up, down, use_up, use_down, count);
}

}  // namespace parian

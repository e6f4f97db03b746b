// Vectorised inner loops of Hessian products.
#include "base/hot.h"
#include "fit/hessian_internal.h"

namespace parian {
namespace {

// One knot of (D + lambda^2 L^T L) p; expanded for both precisions, as clones cannot be templates.
#define PARIAN_LOCAL_ROW(Real)                                                            \
  const auto c0 = static_cast<Real>(row->c0), up1 = static_cast<Real>(row->up),           \
             down1 = static_cast<Real>(row->down), c2 = static_cast<Real>(row->up2),      \
             d2 = static_cast<Real>(row->down2), use_up = static_cast<Real>(row->use_up), \
             use_down = static_cast<Real>(row->use_down);                                 \
  for (std::size_t i = 0; i < count; ++i)                                                 \
    out[i] += (diagonal[i] + c0) * here[i] + (use_up * cu[i] + up1) * up[i] +             \
              (use_down * cd[i] + down1) * down[i] + c2 * up2[i] + d2 * down2[i];

PARIAN_HOT void local_row_float(const LocalRow* row, const float* PARIAN_RESTRICT diagonal,
                                const float* PARIAN_RESTRICT cu, const float* PARIAN_RESTRICT cd,
                                const float* PARIAN_RESTRICT here, const float* PARIAN_RESTRICT up,
                                const float* PARIAN_RESTRICT down, const float* PARIAN_RESTRICT up2,
                                const float* PARIAN_RESTRICT down2, float* PARIAN_RESTRICT out,
                                std::size_t count){PARIAN_LOCAL_ROW(float)}

PARIAN_HOT
    void local_row_double(const LocalRow* row, const double* PARIAN_RESTRICT diagonal,
                          const double* PARIAN_RESTRICT cu, const double* PARIAN_RESTRICT cd,
                          const double* PARIAN_RESTRICT here, const double* PARIAN_RESTRICT up,
                          const double* PARIAN_RESTRICT down, const double* PARIAN_RESTRICT up2,
                          const double* PARIAN_RESTRICT down2, double* PARIAN_RESTRICT out,
                          std::size_t count){PARIAN_LOCAL_ROW(double)}
#define PARIAN_MULTIPLY(Real)                                               \
  for (std::size_t i = 0; i < count; ++i) {                                 \
    const Real d = diagonal[i], u = use_up * up[i], l = use_down * down[i]; \
    for (std::size_t part = 2 * i; part < 2 * i + 2; ++part) {              \
      const Real old = here[part];                                          \
      here[part] = d * old + u * above[part] + l * previous[part];          \
      previous[part] = old;                                                 \
    }                                                                       \
  }

PARIAN_HOT
    void multiply_float(float* PARIAN_RESTRICT here, const float* PARIAN_RESTRICT above,
                        float* PARIAN_RESTRICT previous, const float* PARIAN_RESTRICT diagonal,
                        const float* PARIAN_RESTRICT up, const float* PARIAN_RESTRICT down,
                        float use_up, float use_down, std::size_t count){PARIAN_MULTIPLY(float)}

PARIAN_HOT
    void multiply_double(double* PARIAN_RESTRICT here, const double* PARIAN_RESTRICT above,
                         double* PARIAN_RESTRICT previous, const double* PARIAN_RESTRICT diagonal,
                         const double* PARIAN_RESTRICT up, const double* PARIAN_RESTRICT down,
                         double use_up, double use_down, std::size_t count) {
  PARIAN_MULTIPLY(double)
}

}  // namespace

void add_local_row(const LocalRow& row, const float* diagonal, const float* coupling_up,
                   const float* coupling_down, const float* here, const float* up,
                   const float* down, const float* up2, const float* down2, float* out,
                   std::size_t count) {
  local_row_float(&row, diagonal, coupling_up, coupling_down, here, up, down, up2, down2, out,
                  count);
}
void add_local_row(const LocalRow& row, const double* diagonal, const double* coupling_up,
                   const double* coupling_down, const double* here, const double* up,
                   const double* down, const double* up2, const double* down2, double* out,
                   std::size_t count) {
  local_row_double(&row, diagonal, coupling_up, coupling_down, here, up, down, up2, down2, out,
                   count);
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

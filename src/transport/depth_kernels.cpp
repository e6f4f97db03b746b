#include "transport/depth_kernels.h"

#include <cmath>

#include "base/hot.h"

namespace parian {
namespace {

struct Refractions {
  const float *x, *y, *z;
  float *ratio, *flux_x, *flux_y, *flux_z;
};

// Snell's law and Fresnel's transmission, as in refract_entry and fresnel_transmission.
PARIAN_HOT void refract(const Refractions& r, std::size_t count, Vec3 light, float eta) {
  const float *PARIAN_RESTRICT x = r.x, *PARIAN_RESTRICT y = r.y, *PARIAN_RESTRICT z = r.z;
  float *PARIAN_RESTRICT ratio = r.ratio, *PARIAN_RESTRICT flux_x = r.flux_x,
                         *PARIAN_RESTRICT flux_y = r.flux_y, *PARIAN_RESTRICT flux_z = r.flux_z;
  const float inverse = 1 / eta;
  for (std::size_t i = 0; i < count; ++i) {
    const float square = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    const float scale = 1 / std::sqrt(square > 1e-30f ? square : 1e-30f);
    const float projected = (x[i] * light.x + y[i] * light.y + z[i] * light.z) * scale;
    const float cosine = projected < 1 ? projected : 1.0f;
    const float rest = 1 - (1 - cosine * cosine) * (inverse * inverse);
    const bool enters = cosine > 0 && rest > 0;
    const float inside = std::sqrt(enters ? rest : 1.0f);
    const float s = 1 / (cosine + eta * inside), p = 1 / (eta * cosine + inside);
    const float through = 2 * eta * cosine * inside * (s * s + p * p);
    const float transmission = enters ? through : 0.0f;
    const float along = transmission * (inside - cosine * inverse) * scale,
                kept = transmission * inverse;
    ratio[i] = enters ? cosine / inside : 0.0f;
    flux_x[i] = kept * light.x + along * x[i];
    flux_y[i] = kept * light.y + along * y[i];
    flux_z[i] = kept * light.z + along * z[i];
  }
}

}  // namespace

EntryRow make_entry_row(std::size_t width) {
  EntryRow row;
  for (auto& part : row.normal) part.resize(width);
  for (auto& part : row.flux) part.resize(width);
  row.column.resize(width);
  row.length_ratio.resize(width);
  return row;
}

void refract_entries(EntryRow& row, Vec3 to_light, float eta, DepthTexel* texels) {
  refract({row.normal[0].data(), row.normal[1].data(), row.normal[2].data(),
           row.length_ratio.data(), row.flux[0].data(), row.flux[1].data(), row.flux[2].data()},
          row.count, to_light, eta);
  for (std::size_t i = 0; i < row.count; ++i) {
    DepthTexel& texel = texels[row.column[i]];
    texel.length_ratio = row.length_ratio[i];
    for (std::size_t c = 0; c < 3; ++c) texel.flux[c] = row.flux[c][i];
  }
}

}  // namespace parian

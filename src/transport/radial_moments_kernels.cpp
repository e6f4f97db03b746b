#include "transport/radial_moments_kernels.h"

#include <cmath>

#include "base/hot.h"

namespace parian {
namespace {

PARIAN_HOT void find_spreads(const float* PARIAN_RESTRICT x, const float* PARIAN_RESTRICT y,
                             const float* PARIAN_RESTRICT z, const float* PARIAN_RESTRICT xx,
                             const float* PARIAN_RESTRICT yy, const float* PARIAN_RESTRICT zz,
                             const float* PARIAN_RESTRICT xy, const float* PARIAN_RESTRICT yz,
                             const float* PARIAN_RESTRICT zx, std::size_t count,
                             const float* PARIAN_RESTRICT target, float* PARIAN_RESTRICT ux,
                             float* PARIAN_RESTRICT uy, float* PARIAN_RESTRICT uz,
                             float* PARIAN_RESTRICT near_mm, float* PARIAN_RESTRICT far_mm,
                             float* PARIAN_RESTRICT half_inverse_spread) {
  const float tx = target[0], ty = target[1], tz = target[2];
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - tx, dy = y[i] - ty, dz = z[i] - tz;
    const float d = std::sqrt(dx * dx + dy * dy + dz * dz), inverse = 1 / (d + 1e-20f);
    const float a = dx * inverse, b = dy * inverse, c = dz * inverse;
    const float along = a * (a * xx[i] + 2 * b * xy[i]) + b * (b * yy[i] + 2 * c * yz[i]) +
                        c * (c * zz[i] + 2 * a * zx[i]);
    const float variance = along > 0 ? along : 0.0f;
    const float across = xx[i] + yy[i] + zz[i] - variance;
    const float mean = d + 0.5f * across * inverse;
    const float spread = std::sqrt(variance) + 1e-6f * d;
    near_mm[i] = mean - spread;
    far_mm[i] = mean + spread;
    half_inverse_spread[i] = 0.5f / (spread + 1e-20f);
    ux[i] = a;
    uy[i] = b;
    uz[i] = c;
  }
}

PARIAN_HOT void find_intervals(const int* PARIAN_RESTRICT interval_of_bin,
                               const float* PARIAN_RESTRICT end, const float* PARIAN_RESTRICT start,
                               const float* PARIAN_RESTRICT inverse_length, float bins_per_mm,
                               float reach, int pieces, std::size_t count,
                               float* PARIAN_RESTRICT distance, int* PARIAN_RESTRICT interval,
                               float* PARIAN_RESTRICT t) {
  const int last = pieces - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const float r = distance[i];
    const bool inside = r <= reach;
    const float positive = r > 0 ? r : 0.0f;
    const float x = inside ? positive : reach;
    int k = interval_of_bin[static_cast<int>(x * bins_per_mm)];
    k += x >= end[k] ? 1 : 0;  // a bin holds at most one knot
    k = k < last ? k : last;
    interval[i] = inside ? k : pieces;
    t[i] = (x - start[k]) * inverse_length[k];
  }
}

}  // namespace

void find_places(const IntervalTable* table, std::size_t count, const Places* places) {
  find_intervals(table->interval_of_bin.data(), table->end.data(), table->start.data(),
                 table->inverse_length.data(), table->bins_per_mm, table->reach,
                 static_cast<int>(table->end.size()), count, places->distance, places->interval,
                 places->t);
}

void find_node_distances(const float* const* field, std::size_t count, const float* target,
                         const NodeView* view) {
  find_spreads(field[0], field[1], field[2], field[3], field[4], field[5], field[6], field[7],
               field[8], count, target, view->x, view->y, view->z, view->near_mm, view->far_mm,
               view->half_inverse_spread);
}

PARIAN_HOT void find_sample_distances(const float* const* position, std::size_t count,
                                      const float* target, float* PARIAN_RESTRICT distance_mm) {
  const float* PARIAN_RESTRICT x = position[0];
  const float* PARIAN_RESTRICT y = position[1];
  const float* PARIAN_RESTRICT z = position[2];
  const float tx = target[0], ty = target[1], tz = target[2];
  for (std::size_t i = 0; i < count; ++i) {
    const float dx = x[i] - tx, dy = y[i] - ty, dz = z[i] - tz;
    distance_mm[i] = std::sqrt(dx * dx + dy * dy + dz * dz);
  }
}

void add_nodes(const NodeView* view, const Places* near, const Places* far,
               const ChannelOffsets* offset, const Flux* flux, std::size_t count, int degree,
               Flux (*near_sum)[3], Flux (*far_sum)[3]) {
  const Flux zero{}, one = {1, 1, 1, 1}, half = {0.5f, 0.5f, 0.5f, 0.5f};
  for (std::size_t i = 0; i < count; ++i) {
    // The part of a channel's flux that goes to the far point keeps the channel's own mean.
    const Flux shift =
        view->x[i] * offset[i].x + view->y[i] * offset[i].y + view->z[i] * offset[i].z;
    Flux part = half + view->half_inverse_spread[i] * shift;
    part = part > zero ? part : zero;
    part = part < one ? part : one;
    const Flux far_flux = part * flux[i];
    add_moment(near->interval[i], near->t[i], flux[i] - far_flux, degree, near_sum);
    add_moment(far->interval[i], far->t[i], far_flux, degree, far_sum);
  }
}

}  // namespace parian

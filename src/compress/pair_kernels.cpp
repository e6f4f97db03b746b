#include "compress/pair_kernels.h"

#include <cstring>

#include "base/hot.h"
#include "math/fast_math.h"

namespace parian {
namespace {

using Lanes = float __attribute__((vector_size(32)));

[[gnu::always_inline]] inline void accumulate(const float* from, Lanes& sum) {
  Lanes value;
  std::memcpy(&value, from, sizeof(Lanes));
  sum += value;
}

PARIAN_HOT void interpolate_half(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                                 float fraction, float* PARIAN_RESTRICT out, std::size_t count) {
  const float right = 0.5f * fraction, left = 0.5f - right;
  for (std::size_t i = 0; i < count; ++i) out[i] = left * a[i] + right * b[i];
}

}  // namespace

PARIAN_HOT void sum_ring(const float* plane, const std::ptrdiff_t* shifts, std::size_t count,
                         float* out, std::size_t width) {
  for (std::size_t x = 0; x < width; x += ring_block) {
    Lanes sums[4] = {};
    for (std::size_t i = 0; i < count; ++i) {
      const float* from = plane + x + shifts[i];
      accumulate(from, sums[0]);
      accumulate(from + 8, sums[1]);
      accumulate(from + 16, sums[2]);
      accumulate(from + 24, sums[3]);
    }
    std::memcpy(out + x, sums, sizeof(sums));
  }
}

void eval_root_profile(const float* a, const float* b, float fraction, float* out,
                       std::size_t count) {
  interpolate_half(a, b, fraction, out, count);
  exp_array(out, out, count);
}

PARIAN_HOT void fill_pair_planes(const float* PARIAN_RESTRICT g, const float* PARIAN_RESTRICT s,
                                 const float* PARIAN_RESTRICT weight,
                                 const float* PARIAN_RESTRICT albedo, std::size_t count,
                                 const PairPlanes& out) {
  float* PARIAN_RESTRICT to_g = out.g;
  float* PARIAN_RESTRICT dd = out.dd;
  float* PARIAN_RESTRICT ds = out.ds;
  float* PARIAN_RESTRICT ss = out.ss;
  float* PARIAN_RESTRICT wdd = out.wdd;
  float* PARIAN_RESTRICT wds = out.wds;
  float* PARIAN_RESTRICT wss = out.wss;
  float* PARIAN_RESTRICT ag = out.ag;
  for (std::size_t i = 0; i < count; ++i) {
    const float d = g[i] - s[i], w = weight[i];
    to_g[i] = g[i];
    dd[i] = d * d;
    ds[i] = d * s[i];
    ss[i] = s[i] * s[i];
    wdd[i] = w * (d * d);
    wds[i] = w * (d * s[i]);
    wss[i] = w * (s[i] * s[i]);
    ag[i] = albedo[i] * g[i];
  }
}

// With d = g - s the residual of a pair is R' - R = g_x g_y - s_x s_y = g_x d_y + d_x s_y: nothing
// cancels where the model is close to its target.
PARIAN_HOT void combine_ring(const float* PARIAN_RESTRICT g, const float* PARIAN_RESTRICT s,
                             const float* PARIAN_RESTRICT weight,
                             const float* PARIAN_RESTRICT albedo, const float* const* sums,
                             std::size_t count, float* PARIAN_RESTRICT gradient,
                             float* PARIAN_RESTRICT error) {
  const float* PARIAN_RESTRICT sum_g = sums[0];
  const float* PARIAN_RESTRICT dd = sums[1];
  const float* PARIAN_RESTRICT ds = sums[2];
  const float* PARIAN_RESTRICT ss = sums[3];
  const float* PARIAN_RESTRICT wdd = sums[4];
  const float* PARIAN_RESTRICT wds = sums[5];
  const float* PARIAN_RESTRICT wss = sums[6];
  const float* PARIAN_RESTRICT ag = sums[7];
  for (std::size_t i = 0; i < count; ++i) {
    const float gx = g[i], dx = g[i] - s[i];
    // sum_y (R' - R) g_y, without and with the partner's weight
    const float own = gx * (dd[i] + ds[i]) + dx * (ds[i] + ss[i]);
    const float partner = gx * (wdd[i] + wds[i]) + dx * (wds[i] + wss[i]);
    gradient[i] = gx * (weight[i] * own + partner + 0.5f * (albedo[i] * sum_g[i] + ag[i]));
    error[i] += gx * (gx * dd[i] + 2 * (dx * ds[i])) + dx * dx * ss[i];
  }
}

namespace {

PARIAN_HOT void eval_miss(const float* PARIAN_RESTRICT table, const float* PARIAN_RESTRICT model,
                          std::size_t count, float* PARIAN_RESTRICT miss) {
  for (std::size_t i = 0; i < count; ++i) {
    const float difference = model[i] - table[i];
    miss[i] = table[i] == table[i] ? difference : 0.0f;
  }
}

PARIAN_HOT void add_product(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                            float factor, std::size_t count, float* PARIAN_RESTRICT to) {
  for (std::size_t i = 0; i < count; ++i) to[i] += factor * (a[i] * b[i]);
}

}  // namespace

void add_residual(const float* table, const float* model, const float* trust, const float* weight_x,
                  const float* weight_y, float share, std::size_t count, float* albedo_x,
                  float* albedo_y, float* squared_x, float* squared_y, float* linear_x,
                  float* linear_y, float* miss) {
  eval_miss(table, model, count, miss);
  add_scaled(miss, -share, albedo_x, count);
  if (albedo_y != nullptr) add_scaled(miss, -share, albedo_y, count);
  add_product(miss, miss, share, count, squared_x);
  if (squared_y != nullptr) add_product(miss, miss, share, count, squared_y);
  // F has w_x m^2 at x and w_y m^2 at y; d ln R / d ln P is 1/2 at either end, 1 for x = y.
  for (std::size_t i = 0; i < count; ++i) miss[i] *= share * trust[i] * model[i];
  add_product(miss, weight_x, 1, count, linear_x);
  add_product(miss, weight_y, 1, count, linear_x);
  if (linear_y == linear_x) return;
  add_product(miss, weight_x, 1, count, linear_y);
  add_product(miss, weight_y, 1, count, linear_y);
}

PARIAN_HOT void add_scaled(const float* PARIAN_RESTRICT from, float factor,
                           float* PARIAN_RESTRICT to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] += factor * from[i];
}

}  // namespace parian

// Hessian products pair by pair: for small radii, weights that no convolution can express, and the
// rows of missing pairs.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/hot.h"
#include "base/parallel.h"
#include "fit/hessian_internal.h"
#include "fit/pair_weights.h"

namespace parian {
namespace {

constexpr int tile_rows = 32;

TableHeader grid_of(const ReducedSystem& system) {
  TableHeader grid;
  grid.width = system.width;
  grid.height = system.height;
  return grid;
}

// s = w [(1 - f) (a(x) + a(x + d)) + f (b(x) + b(x + d))]
PARIAN_HOT void sum_ends_float(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT ad,
                               const float* PARIAN_RESTRICT b, const float* PARIAN_RESTRICT bd,
                               const float* PARIAN_RESTRICT w, float f, float* PARIAN_RESTRICT s,
                               std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    s[i] = w[i] * ((1 - f) * (a[i] + ad[i]) + f * (b[i] + bd[i]));
}
PARIAN_HOT void sum_ends_double(const double* PARIAN_RESTRICT a, const double* PARIAN_RESTRICT ad,
                                const double* PARIAN_RESTRICT b, const double* PARIAN_RESTRICT bd,
                                const float* PARIAN_RESTRICT w, double f, double* PARIAN_RESTRICT s,
                                std::size_t count) {
  for (std::size_t i = 0; i < count; ++i)
    s[i] = static_cast<double>(w[i]) * ((1 - f) * (a[i] + ad[i]) + f * (b[i] + bd[i]));
}
PARIAN_HOT void add_scaled_float(float* PARIAN_RESTRICT out, const float* PARIAN_RESTRICT s,
                                 float factor, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) out[i] += factor * s[i];
}
PARIAN_HOT void add_scaled_double(double* PARIAN_RESTRICT out, const double* PARIAN_RESTRICT s,
                                  double factor, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) out[i] += factor * s[i];
}

void sum_ends(const float* a, const float* ad, const float* b, const float* bd, const float* w,
              double f, float* s, std::size_t n) {
  sum_ends_float(a, ad, b, bd, w, static_cast<float>(f), s, n);
}
void sum_ends(const double* a, const double* ad, const double* b, const double* bd, const float* w,
              double f, double* s, std::size_t n) {
  sum_ends_double(a, ad, b, bd, w, f, s, n);
}
void add_scaled(float* out, const float* s, double factor, std::size_t n) {
  add_scaled_float(out, s, static_cast<float>(factor), n);
}
void add_scaled(double* out, const double* s, double factor, std::size_t n) {
  add_scaled_double(out, s, factor, n);
}

template <typename Real>
struct RowBuffers {
  std::vector<float> slice, weight;
  std::vector<Real> s;
};

// NaN for the pairs of a re-read slice that were left out of the fit.
void drop_held_out(const ReducedSystem& system, Offset offset, std::vector<float>& slice) {
  if (!(system.hold_out.fraction > 0)) return;
  for (int y = 0; y < system.height; ++y)
    for (int x = 0; x < system.width; ++x)
      if (is_held_out(system.hold_out, x, y, offset))
        slice[static_cast<std::size_t>(y) * static_cast<std::size_t>(system.width) +
              static_cast<std::size_t>(x)] = std::numeric_limits<float>::quiet_NaN();
}

template <typename Real>
void add_offset(const ReducedSystem& system, const TableHeader& grid, std::size_t i, int y_begin,
                int y_end, const Real* p, Real* out, RowBuffers<Real>& buffers) {
  const Offset offset = system.offsets[i];
  const PixelRange range = pairs_in_grid(grid, offset);
  if (range.x0 >= range.x1) return;
  const bool scalar = system.restream == nullptr && !has_pair_weights(system);
  if (system.restream != nullptr) {
    system.restream->read_slice(system.channel, system.table_index[i], buffers.slice.data());
    drop_held_out(system, offset, buffers.slice);
  }
  if (scalar) std::fill(buffers.weight.begin(), buffers.weight.end(), 1.0f);
  const auto count = static_cast<std::size_t>(range.x1 - range.x0);
  const double f = system.fraction[i];
  const double m = system.pair_count[i] * (scalar ? system.weights[0].phi[i] : 1);
  const std::size_t low = static_cast<std::size_t>(system.segment[i]) * system.pixels(),
                    high = low + system.pixels();
  const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(offset.dy) * system.width + offset.dx;
  const TableHeader& header = system.restream != nullptr ? system.restream->header() : grid;
  for (int y = std::max(range.y0, y_begin); y < std::min(range.y1, y_end); ++y) {
    if (!scalar)
      fill_pair_weights(system, header, i, y,
                        system.restream != nullptr ? buffers.slice.data() : nullptr,
                        buffers.weight.data());
    const std::size_t x = static_cast<std::size_t>(y) * static_cast<std::size_t>(system.width) +
                          static_cast<std::size_t>(range.x0);
    const auto xd = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(x) + step);
    sum_ends(p + low + x, p + low + xd, p + high + x, p + high + xd,
             buffers.weight.data() + range.x0, f, buffers.s.data(), count);
    for (const std::size_t end : {x, xd}) {
      add_scaled(out + low + end, buffers.s.data(), m * (1 - f), count);
      add_scaled(out + high + end, buffers.s.data(), m * f, count);
    }
  }
}

// Calls body(segment) for all segments; those of one parity touch disjoint planes and run together.
void for_segments(const ReducedSystem& system, const std::function<void(int)>& body) {
  const std::size_t segments = system.knots() - 1;
  for (std::size_t parity = 0; parity < 2; ++parity)
    parallel_for((segments + 1 - parity) / 2,
                 [&](std::size_t j) { body(static_cast<int>(2 * j + parity)); });
}

template <typename Real>
void add_all(const ReducedSystem& system, const Real* p, Real* out) {
  const TableHeader grid = grid_of(system);
  for_segments(system, [&](int segment) {
    const auto width = static_cast<std::size_t>(system.width);
    RowBuffers<Real> buffers{std::vector<float>(system.restream != nullptr ? system.pixels() : 0),
                             std::vector<float>(width), std::vector<Real>(width)};
    // Rows are taken in tiles that stay in cache, except where every tile would read the slices
    // again.
    const int tile = system.restream != nullptr ? system.height : tile_rows;
    for (int y = 0; y < system.height; y += tile)
      for (std::size_t i = 0; i < system.offsets.size(); ++i)
        if (system.segment[i] == segment) add_offset(system, grid, i, y, y + tile, p, out, buffers);
  });
}

template <typename Real>
void subtract_listed(const ReducedSystem& system, std::size_t i, const Real* p, Real* out) {
  const Offset offset = system.offsets[i];
  const std::ptrdiff_t step = static_cast<std::ptrdiff_t>(offset.dy) * system.width + offset.dx;
  const auto f = static_cast<Real>(system.fraction[i]),
             g = static_cast<Real>(1 - system.fraction[i]);
  const std::size_t low = static_cast<std::size_t>(system.segment[i]) * system.pixels(),
                    high = low + system.pixels();
  for (const std::uint32_t x : system.missing[i]) {
    const auto y = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(x) + step);
    double weight = 0;
    for (const WeightTerm& term : system.weights)
      weight += term.u.empty()
                    ? term.phi[i]
                    : term.phi[i] * static_cast<double>(term.u[x]) * static_cast<double>(term.u[y]);
    const Real s = static_cast<Real>(system.pair_count[i] * weight) *
                   (g * (p[low + x] + p[low + y]) + f * (p[high + x] + p[high + y]));
    for (const std::size_t end : {static_cast<std::size_t>(x), y}) {
      out[low + end] -= g * s;
      out[high + end] -= f * s;
    }
  }
}

template <typename Real>
void subtract_all(const ReducedSystem& system, const Real* p, Real* out) {
  if (!has_missing(system)) return;
  for_segments(system, [&](int segment) {
    for (std::size_t i = 0; i < system.offsets.size(); ++i)
      if (system.segment[i] == segment) subtract_listed(system, i, p, out);
  });
}

}  // namespace

bool has_missing(const ReducedSystem& system) {
  return std::any_of(system.missing.begin(), system.missing.end(),
                     [](const auto& list) { return !list.empty(); });
}

void add_pairs(const ReducedSystem& system, const float* p, float* out) {
  add_all(system, p, out);
  subtract_all(system, p, out);
}
void add_pairs(const ReducedSystem& system, const double* p, double* out) {
  add_all(system, p, out);
  subtract_all(system, p, out);
}
void subtract_missing(const ReducedSystem& system, const float* p, float* out) {
  subtract_all(system, p, out);
}
void subtract_missing(const ReducedSystem& system, const double* p, double* out) {
  subtract_all(system, p, out);
}

}  // namespace parian

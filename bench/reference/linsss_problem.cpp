#include <algorithm>
#include <cmath>
#include <map>

#include "base/hot.h"
#include "base/parallel.h"
#include "bench/reference/linsss_internal.h"

namespace parian {
namespace {

constexpr std::size_t groups = 8;  // partial sums over rings
constexpr std::size_t pixel_block = 512;

// t += (a + b) s
PARIAN_HOT void add_weighted(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                             const float* PARIAN_RESTRICT s, float* PARIAN_RESTRICT t, int count) {
  for (int i = 0; i < count; ++i) t[i] += (a[i] + b[i]) * s[i];
}

// The same where `value` is a number.
PARIAN_HOT void add_weighted_where(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                                   const float* PARIAN_RESTRICT s,
                                   const float* PARIAN_RESTRICT value, float* PARIAN_RESTRICT t,
                                   int count) {
  for (int i = 0; i < count; ++i) t[i] += value[i] == value[i] ? (a[i] + b[i]) * s[i] : 0.0f;
}

// t += factor s
PARIAN_HOT void add_scaled(float factor, const float* PARIAN_RESTRICT s, float* PARIAN_RESTRICT t,
                           std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) t[i] += factor * s[i];
}

// t = (t + w s) / 2
PARIAN_HOT void halve_sum(const float* PARIAN_RESTRICT w, const float* PARIAN_RESTRICT s,
                          float* PARIAN_RESTRICT t, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) t[i] = 0.5f * (t[i] + w[i] * s[i]);
}

// Calls row(x, partner, count) with the first pixels of each row of pairs.
template <typename Row>
void for_each_row(const TableHeader& header, Offset d, const Row& row) {
  const PixelRange range = pairs_in_grid(header, d);
  if (range.x1 <= range.x0) return;
  for (int y = range.y0; y < range.y1; ++y) {
    const std::ptrdiff_t x = static_cast<std::ptrdiff_t>(y) * header.width + range.x0;
    row(x, x + static_cast<std::ptrdiff_t>(d.dy) * header.width + d.dx, range.x1 - range.x0);
  }
}

// t(x) += sum over the ring's pairs (x, y) of (u_x + u_y) s(y); (0,0) once.
void add_ring(const LinsssProblem& p, const Ring& ring, const float* s, float* t) {
  const TableHeader& header = p.table.header;
  const float* u = p.u.data();
  for (const int i : ring.offsets) {
    const Offset d = header.offsets[static_cast<std::size_t>(i)];
    const float* value = slice_of(p.table, p.channel, i);
    const bool gaps = p.gaps[static_cast<std::size_t>(i)] != 0;
    for_each_row(header, d, [&](std::ptrdiff_t x, std::ptrdiff_t y, int count) {
      if (gaps) {
        add_weighted_where(u + x, u + y, s + y, value + x, t + x, count);
        if (d != Offset{}) add_weighted_where(u + x, u + y, s + x, value + x, t + y, count);
      } else {
        add_weighted(u + x, u + y, s + y, t + x, count);
        if (d != Offset{}) add_weighted(u + x, u + y, s + x, t + y, count);
      }
    });
  }
}

// t(x) += sum over the ring's pairs of (u_x + u_y) R; returns the sum over pairs of (u_x + u_y)
// R^2.
double add_ring_data(const LinsssProblem& p, const Ring& ring, float* t) {
  double squares = 0;
  const Plane& u = p.u;
  for (const int i : ring.offsets) {
    const Offset d = p.table.header.offsets[static_cast<std::size_t>(i)];
    const float* value = slice_of(p.table, p.channel, i);
    for_each_row(p.table.header, d, [&](std::ptrdiff_t x, std::ptrdiff_t y, int count) {
      for (int k = 0; k < count; ++k) {
        const auto from = static_cast<std::size_t>(x + k), to = static_cast<std::size_t>(y + k);
        const float r = value[from];
        if (std::isnan(r)) continue;
        const float product = (u[from] + u[to]) * r;
        t[from] += product;
        if (d != Offset{}) t[to] += product;
        squares += (d != Offset{} ? 1.0 : 0.5) * static_cast<double>(product * r);
      }
    });
  }
  return squares;
}

bool has_gaps(const BssrdfTable& table, int channel, int offset_index) {
  const float* value = slice_of(table, channel, offset_index);
  bool gaps = false;
  for_each_row(table.header, table.header.offsets[static_cast<std::size_t>(offset_index)],
               [&](std::ptrdiff_t x, std::ptrdiff_t, int count) {
                 gaps = gaps || std::any_of(value + x, value + x + count,
                                            [](float r) { return std::isnan(r); });
               });
  return gaps;
}

// bound_x = sum over rings of w(x) g g^T, as (1/2 (a + b))^2 <= 1/2 a^2 + 1/2 b^2.
void fill_bound(LinsssProblem& p, std::size_t pixels) {
  const std::size_t n = p.gaussians;
  p.bound.assign(pixels * n * n, 0.0f);
  parallel_for_blocks(pixels, pixel_block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = 0; r < p.rings.size(); ++r)
      for (std::size_t x = begin; x < end; ++x)
        for (std::size_t i = 0; i < n; ++i) {
          const float own = p.ring_weight[r][x] * p.gaussian[r * n + i];
          for (std::size_t j = 0; j < n; ++j)
            p.bound[(x * n + i) * n + j] += own * p.gaussian[r * n + j];
        }
  });
}

// Sum over rings of what body(ring, planes) adds to [gaussian][y][x], in fixed groups of rings.
template <typename Body>
Plane sum_rings(const LinsssProblem& p, const Body& body) {
  const std::size_t size = p.gaussians * p.u.size();
  std::vector<Plane> partial(groups);
  parallel_for(groups, [&](std::size_t group) {
    partial[group].assign(size, 0.0f);
    for (std::size_t r = group; r < p.rings.size(); r += groups) body(r, partial[group].data());
  });
  for (std::size_t group = 1; group < groups; ++group)
    add_scaled(1.0f, partial[group].data(), partial[0].data(), size);
  return std::move(partial[0]);
}

}  // namespace

std::vector<Ring> find_rings(const TableHeader& header) {
  std::map<int, Ring> rings;
  for (std::size_t i = 0; i < header.offsets.size(); ++i) {
    const Offset d = header.offsets[i];
    Ring& ring = rings[d.dx * d.dx + d.dy * d.dy];
    ring.radius2 = d.dx * d.dx + d.dy * d.dy;
    ring.offsets.push_back(static_cast<int>(i));
  }
  std::vector<Ring> out;
  out.reserve(rings.size());
  for (auto& [radius2, ring] : rings) out.push_back(std::move(ring));
  return out;
}

Plane make_pixel_weights(const BssrdfTable& table) {
  std::vector<double> energy(table.header.pixels(), 0.0);
  for (int c = 0; c < table.header.channels; ++c)
    for (std::size_t i = 0; i < table.header.offsets.size(); ++i) {
      const Offset d = table.header.offsets[i];
      const float* value = slice_of(table, c, static_cast<int>(i));
      for_each_row(table.header, d, [&](std::ptrdiff_t x, std::ptrdiff_t y, int count) {
        for (int k = 0; k < count; ++k) {
          const auto r = static_cast<double>(value[x + k]);
          if (std::isnan(r)) continue;
          energy[static_cast<std::size_t>(x + k)] += r * r;
          if (d != Offset{}) energy[static_cast<std::size_t>(y + k)] += r * r;
        }
      });
    }
  Plane u(energy.size());
  for (std::size_t x = 0; x < u.size(); ++x)
    u[x] = energy[x] > 0 ? static_cast<float>(1 / energy[x]) : 0.0f;
  return u;
}

LinsssProblem make_linsss_problem(const BssrdfTable& table, int channel,
                                  const std::vector<Ring>& rings, const Plane& u,
                                  const std::vector<double>& sigma_px) {
  LinsssProblem p{.table = table, .channel = channel, .rings = rings, .u = u};
  p.gaussians = sigma_px.size();
  const std::size_t pixels = u.size();
  for (std::size_t i = 0; i < table.header.offsets.size(); ++i)
    p.gaps.push_back(has_gaps(table, channel, static_cast<int>(i)) ? 1 : 0);
  for (const Ring& ring : rings)
    for (const double sigma : sigma_px)
      p.gaussian.push_back(static_cast<float>(std::exp(-0.5 * ring.radius2 / (sigma * sigma))));
  p.ring_weight.resize(rings.size());
  std::vector<double> squares(rings.size());
  p.b = sum_rings(p, [&](std::size_t r, float* planes) {
    const Plane ones(pixels, 1.0f);
    p.ring_weight[r].assign(pixels, 0.0f);
    add_ring(p, rings[r], ones.data(), p.ring_weight[r].data());
    Plane data(pixels, 0.0f);
    squares[r] = add_ring_data(p, rings[r], data.data());
    for (std::size_t h = 0; h < p.gaussians; ++h)
      add_scaled(p.gaussian[r * p.gaussians + h], data.data(), planes + h * pixels, pixels);
  });
  for (const double value : squares) p.c += value;
  fill_bound(p, pixels);
  return p;
}

Plane linsss_gradient(const LinsssProblem& p, const Plane& weight) {
  const std::size_t pixels = p.u.size();
  Plane gradient = sum_rings(p, [&](std::size_t r, float* planes) {
    thread_local Plane s, t;
    s.assign(pixels, 0.0f);
    t.assign(pixels, 0.0f);
    const float* g = &p.gaussian[r * p.gaussians];
    for (std::size_t h = 0; h < p.gaussians; ++h)
      add_scaled(g[h], &weight[h * pixels], s.data(), pixels);
    add_ring(p, p.rings[r], s.data(), t.data());
    halve_sum(p.ring_weight[r].data(), s.data(), t.data(), pixels);
    for (std::size_t h = 0; h < p.gaussians; ++h)
      add_scaled(g[h], t.data(), planes + h * pixels, pixels);
  });
  add_scaled(-1.0f, p.b.data(), gradient.data(), gradient.size());
  return gradient;
}

}  // namespace parian

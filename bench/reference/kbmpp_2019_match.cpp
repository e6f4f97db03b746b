#include "bench/reference/kbmpp_2019_match.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/hot.h"
#include "base/parallel.h"
#include "base/random.h"
#include "bench/reference/kbmpp_2019_kernels.h"

namespace parian::kbmpp {
namespace {

// How a pixel's change moves the gradient of its partners on one ring: floats to add to two
// neighbouring knots, [low, high][4].
struct Increment {
  alignas(32) float value[8];
};

// One partner of a pixel, on either side of an offset.
struct Partner {
  int dx = 0, dy = 0;
  std::ptrdiff_t at = 0;  // in the gradient, in floats, from the pixel's row
  std::size_t ring = 0;
  std::size_t mask = 0;  // in the pixel's part of the mask
};

struct Sweep {
  const Pairs& pairs;
  const std::vector<std::uint8_t>& mask;
  const SweepParams& params;
  Model& model;
  Workspace& work;
  std::vector<Partner> partners;
  std::vector<std::uint16_t> old_index;  // before the sweep
  AlignedVector<float> old_weight;
  int reach = 0;
};

std::vector<Partner> make_partners(const Pairs& pairs) {
  std::vector<Partner> partners;
  for (std::size_t r = 0; r < pairs.rings.size(); ++r)
    for (const Member& m : pairs.rings[r].members) {
      if (m.offset == Offset{}) continue;  // the pixel itself: in `diagonal`
      for (int side = 0; side < 2; ++side) {
        const int sign = side == 0 ? 1 : -1;
        const std::ptrdiff_t at = sign * m.shift * static_cast<std::ptrdiff_t>(pairs.row) +
                                  static_cast<std::ptrdiff_t>(4 * pairs.rings[r].segment);
        partners.push_back({sign * m.offset.dx, sign * m.offset.dy, at, r,
                            2 * m.plane + static_cast<std::size_t>(side)});
      }
    }
  std::stable_sort(partners.begin(), partners.end(), [](const Partner& a, const Partner& b) {
    return a.dy != b.dy ? a.dy < b.dy : a.dx < b.dx;
  });
  return partners;
}

void make_increments(const Pairs& pairs, const float* delta, std::vector<Increment>& increments) {
  increments.resize(pairs.rings.size());
  for (std::size_t r = 0; r < pairs.rings.size(); ++r) {
    const Ring& ring = pairs.rings[r];
    const float* at = delta + 4 * ring.segment;
    const auto low = static_cast<float>(ring.low), high = static_cast<float>(ring.high);
    const auto weight = static_cast<float>(ring.weight);
    for (std::size_t c = 0; c < 4; ++c) {
      const float q = weight * (low * at[c] + high * at[c + 4]);
      increments[r].value[c] = low * q;
      increments[r].value[c + 4] = high * q;
    }
  }
}

PARIAN_HOT void add_increments(const Partner* partners, std::size_t count,
                               const Increment* increments, float* gradient) {
  for (std::size_t i = 0; i < count; ++i) {
    float* to = gradient + partners[i].at;
    const float* value = increments[partners[i].ring].value;
    for (int j = 0; j < 8; ++j) to[j] += value[j];
  }
}

// The same for pixels near the border and tables with holes.
void add_checked(const Sweep& s, int x, int y, const Increment* increments, float* gradient) {
  const std::size_t sides = 2 * s.pairs.planes;
  const std::size_t pixel = static_cast<std::size_t>(y * s.pairs.width + x);
  for (const Partner& p : s.partners) {
    const int u = x + p.dx, v = y + p.dy;
    if (u < 0 || v < 0 || u >= s.pairs.width || v >= s.pairs.height) continue;
    const unsigned bits = s.mask.empty() ? 15u : s.mask[pixel * sides + p.mask];
    const float* value = increments[p.ring].value;
    for (unsigned c = 0; c < 4; ++c)
      if ((bits >> c & 1u) != 0) {
        gradient[p.at + c] += value[c];
        gradient[p.at + c + 4] += value[c + 4];
      }
  }
}

// A candidate's parameters against the pixel's own: what the pixel's profile would change by.
void make_delta(const Sweep& s, std::size_t pixel, const std::uint16_t* index, const float* weight,
                float* delta) {
  const std::size_t row = s.pairs.row;
  mix_rows(s.model.base_rows.data(), index, weight, 1, s.model.per_pixel, row, delta);
  const float* own = s.work.rows.data() + pixel * row;
  for (std::size_t j = 0; j < row; ++j) delta[j] -= own[j];
}

void replace(Sweep& s, int x, int y, const std::uint16_t* index, const float* weight,
             const float* delta, std::vector<Increment>& increments) {
  const std::size_t row = s.pairs.row, per_pixel = s.model.per_pixel;
  const std::size_t pixel = static_cast<std::size_t>(y * s.pairs.width + x);
  make_increments(s.pairs, delta, increments);
  float* gradient = s.work.gradient.data() + pixel * row;
  const bool inside = x >= s.reach && y >= s.reach && x + s.reach < s.pairs.width &&
                      y + s.reach < s.pairs.height && s.mask.empty();
  if (inside)
    add_increments(s.partners.data(), s.partners.size(), increments.data(), gradient);
  else
    add_checked(s, x, y, increments.data(), gradient);
  add_curvature(delta, s.pairs.diagonal.data() + pixel * row,
                s.pairs.off_diagonal.data() + pixel * row, row, gradient);
  std::copy(index, index + per_pixel, s.model.index.data() + pixel * per_pixel);
  std::copy(weight, weight + per_pixel, s.model.weight.data() + pixel * per_pixel);
  float* rows = s.work.rows.data() + pixel * row;
  for (std::size_t j = 0; j < row; ++j) rows[j] += delta[j];
}

// Space of one thread.
struct Scratch {
  AlignedVector<float> delta;
  std::vector<Increment> increments;
};

bool try_candidate(Sweep& s, int x, int y, const std::uint16_t* index, const float* weight,
                   Scratch& scratch) {
  const std::size_t row = s.pairs.row;
  const std::size_t pixel = static_cast<std::size_t>(y * s.pairs.width + x);
  make_delta(s, pixel, index, weight, scratch.delta.data());
  const float change = eval_change(scratch.delta.data(), s.work.gradient.data() + pixel * row,
                                   s.pairs.diagonal.data() + pixel * row,
                                   s.pairs.off_diagonal.data() + pixel * row, row);
  if (!(change < 0)) return false;
  replace(s, x, y, index, weight, scratch.delta.data(), scratch.increments);
  return true;
}

std::size_t visit(Sweep& s, int x, int y, Scratch& scratch) {
  const int step = s.params.iteration % 2 == 0 ? -1 : 1;
  const std::size_t per_pixel = s.model.per_pixel, pixels = s.pairs.pixels();
  const std::size_t pixel = static_cast<std::size_t>(y * s.pairs.width + x);
  const std::uint64_t key =
      hash_u64(s.params.seed, (static_cast<std::uint64_t>(s.params.iteration) << 40u) + pixel);
  std::size_t replaced = 0;
  const int neighbours[2][2] = {{x + step, y}, {x, y + step}};
  for (unsigned i = 0; i < 2u + static_cast<unsigned>(s.params.random_candidates); ++i) {
    // Whether an improvement would be taken does not depend on the candidate: ask first.
    if (hash_to_uniform(hash_u64(key, 2 * i)) >= s.params.probability) continue;
    if (i < 2) {
      const auto [u, v] = neighbours[i];
      if (u < 0 || v < 0 || u >= s.pairs.width || v >= s.pairs.height) continue;
      const std::size_t from = static_cast<std::size_t>(v * s.pairs.width + u) * per_pixel;
      replaced += try_candidate(s, x, y, s.model.index.data() + from, s.model.weight.data() + from,
                                scratch);
    } else {
      const double u = hash_to_uniform(hash_u64(key, 2 * i + 1));
      const auto from = static_cast<std::size_t>(u * static_cast<double>(pixels)) * per_pixel;
      replaced +=
          try_candidate(s, x, y, s.old_index.data() + from, s.old_weight.data() + from, scratch);
    }
  }
  return replaced;
}

struct TileGrid {
  int side = 0, columns = 0, rows = 0;
};

std::size_t visit_tile(Sweep& s, const TileGrid& grid, int column, int line) {
  const int x0 = column * grid.side, x1 = std::min(x0 + grid.side, s.pairs.width);
  const int y0 = line * grid.side, y1 = std::min(y0 + grid.side, s.pairs.height);
  const bool forward = s.params.iteration % 2 == 0;
  Scratch scratch;
  scratch.delta.resize(s.pairs.row);
  std::size_t replaced = 0;
  for (int j = 0; j < y1 - y0; ++j)
    for (int i = 0; i < x1 - x0; ++i)
      replaced += visit(s, forward ? x0 + i : x1 - 1 - i, forward ? y0 + j : y1 - 1 - j, scratch);
  return replaced;
}

}  // namespace

std::vector<std::uint8_t> make_pair_mask(const Pairs& pairs) {
  if (pairs.complete) return {};
  const std::size_t pixels = pairs.pixels(), sides = 2 * pairs.planes;
  std::vector<std::uint8_t> mask(pixels * sides, 0);
  for (const Ring& ring : pairs.rings)
    for (const Member& m : ring.members) {
      const PlaneRange range = range_of(m, pixels);
      for (std::size_t c = 0; c < static_cast<std::size_t>(pairs.channels); ++c)
        for (std::size_t x = range.begin; x < range.end; ++x) {
          if (std::isnan(pairs.logs(c, m.plane)[x])) continue;
          const auto bit = static_cast<std::uint8_t>(1u << c);
          const auto y = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(x) + m.shift);
          mask[x * sides + 2 * m.plane] |= bit;
          mask[y * sides + 2 * m.plane + 1] |= bit;
        }
    }
  return mask;
}

std::size_t sweep(const Pairs& pairs, const std::vector<std::uint8_t>& mask,
                  const SweepParams& params, Model& model, Workspace& work) {
  Sweep s{pairs, mask, params, model, work, make_partners(pairs), model.index, model.weight, 0};
  for (const Partner& p : s.partners) s.reach = std::max({s.reach, std::abs(p.dx), std::abs(p.dy)});
  TileGrid grid;
  grid.side = std::max(32, 2 * s.reach);
  grid.columns = (pairs.width + grid.side - 1) / grid.side;
  grid.rows = (pairs.height + grid.side - 1) / grid.side;
  const bool forward = params.iteration % 2 == 0;
  std::vector<std::size_t> counts(static_cast<std::size_t>(grid.columns * grid.rows), 0);
  for (int i = 0; i < 4; ++i) {
    const int colour = forward ? i : 3 - i;
    std::vector<int> tiles;
    for (int t = 0; t < grid.columns * grid.rows; ++t)
      if (t % grid.columns % 2 == colour % 2 && t / grid.columns % 2 == colour / 2)
        tiles.push_back(t);
    parallel_for(tiles.size(), [&](std::size_t j) {
      counts[static_cast<std::size_t>(tiles[j])] =
          visit_tile(s, grid, tiles[j] % grid.columns, tiles[j] / grid.columns);
    });
  }
  std::size_t replaced = 0;
  for (const std::size_t count : counts) replaced += count;
  return replaced;
}

}  // namespace parian::kbmpp

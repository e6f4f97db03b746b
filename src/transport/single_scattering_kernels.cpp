#include "transport/single_scattering_kernels.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/hot.h"

namespace parian {
namespace {

constexpr std::size_t bins = 4096;

// Texel of each node, where in the texel it is, and how deep.
struct PathTexels {
  std::int32_t texel[max_path_samples];
  float x[max_path_samples], y[max_path_samples], depth[max_path_samples];
};

PARIAN_HOT void find_texels(int width, int height, const MapPath& path,
                            const float* PARIAN_RESTRICT s, std::size_t nodes,
                            PathTexels* PARIAN_RESTRICT out) {
  const float last_x = static_cast<float>(width - 1), last_y = static_cast<float>(height - 1);
  for (std::size_t i = 0; i < nodes; ++i) {
    const float x = path.x + s[i] * path.dx, y = path.y + s[i] * path.dy;
    // NaN becomes 0.
    const float low_x = x > 0 ? x : 0.0f, low_y = y > 0 ? y : 0.0f;
    const auto column = static_cast<std::int32_t>(low_x < last_x ? low_x : last_x),
               row = static_cast<std::int32_t>(low_y < last_y ? low_y : last_y);
    out->texel[i] = row * width + column;
    out->x[i] = x - (static_cast<float>(column) + 0.5f);
    out->y[i] = y - (static_cast<float>(row) + 0.5f);
    out->depth[i] = path.z + s[i] * path.dz;
  }
}

PARIAN_HOT void add_hats(const BasisView& basis, const LitPath& lit, float* PARIAN_RESTRICT sums) {
  const float end = basis.knots[basis.intervals];
  const auto last_bin = static_cast<std::uint32_t>(basis.bins - 1);
  for (std::size_t i = 0; i < lit.count; ++i) {
    const float x = lit.length[i] < end ? lit.length[i] : end;
    std::size_t k =
        basis.first[std::min(static_cast<std::uint32_t>(x * basis.bins_per_mm), last_bin)];
    while (k + 1 < basis.intervals && x >= basis.knots[k + 1]) ++k;
    const float t = (x - basis.knots[k]) * basis.inverse[k];
    float* at = sums + 4 * k;
    for (std::size_t c = 0; c < 4; ++c) at[c] += (1 - t) * lit.source[i][c];
    for (std::size_t c = 0; c < 4; ++c) at[4 + c] += t * lit.source[i][c];
  }
}

PARIAN_HOT void add_quadratics(const BasisView& basis, const LitPath& lit,
                               float* PARIAN_RESTRICT sums) {
  const float end = basis.knots[basis.intervals];
  const auto last_bin = static_cast<std::uint32_t>(basis.bins - 1);
  for (std::size_t i = 0; i < lit.count; ++i) {
    const float x = lit.length[i] < end ? lit.length[i] : end;
    std::size_t k =
        basis.first[std::min(static_cast<std::uint32_t>(x * basis.bins_per_mm), last_bin)];
    while (k + 1 < basis.intervals && x >= basis.knots[k + 1]) ++k;
    const float t = (x - basis.knots[k]) * basis.inverse[k];
    float* at = sums + 4 * k;
    const float* power = basis.coefficients + 9 * k;
    for (std::size_t j = 0; j < 3; ++j) {
      const float b = power[3 * j] + t * (power[3 * j + 1] + t * power[3 * j + 2]);
      for (std::size_t c = 0; c < 4; ++c) at[4 * j + c] += b * lit.source[i][c];
    }
  }
}

PARIAN_HOT void add_colours(const float* PARIAN_RESTRICT colour, std::size_t count,
                            float* PARIAN_RESTRICT sums, float* PARIAN_RESTRICT value) {
  const float r = colour[0], g = colour[1], b = colour[2];
  for (std::size_t i = 0; i < count; ++i) {
    value[3 * i] += sums[i] * r;
    value[3 * i + 1] += sums[i] * g;
    value[3 * i + 2] += sums[i] * b;
    sums[i] = 0;
  }
}

}  // namespace

void look_up_path(const DepthTexel* texels, int width, int height, float bias, const MapPath& path,
                  const float* s, const float* weight, std::size_t nodes, LitPath* lit) {
  PathTexels places;
  find_texels(width, height, path, s, nodes, &places);
  std::size_t count = 0;
  for (std::size_t i = 0; i < nodes; ++i) {
    const DepthTexel& texel = texels[places.texel[i]];
    const float depth = places.depth[i];
    const float distance =
        depth - (texel.entry + texel.slope_x * places.x[i] + texel.slope_y * places.y[i]);
    if (!(distance >= -bias && depth <= texel.exit + bias)) continue;
    const float x = texel.flux[0], y = texel.flux[1], z = texel.flux[2];
    lit->length[count] = texel.length_ratio * std::max(distance, 0.0f) + s[i];
    float* source = lit->source[count++];
    source[0] = weight[i] * std::sqrt(x * x + y * y + z * z);  // |w_i'| = 1
    source[1] = weight[i] * x;
    source[2] = weight[i] * y;
    source[3] = weight[i] * z;
  }
  lit->count = count;
}

BasisTable make_basis_table(const SplineBasis& basis) {
  const std::vector<double>& knots = basis.knots;
  PARIAN_CHECK(knots.size() >= 2 && knots.size() < 65536 && knots.front() == 0);
  BasisTable table;
  table.degree = basis.degree;
  table.intervals = basis.intervals();
  table.bins_per_mm = static_cast<float>(bins / knots.back());
  table.first.reserve(bins);
  std::size_t k = 0;
  for (std::size_t bin = 0; bin < bins; ++bin) {
    // Somewhat before the bin, for rounding: too early is corrected by the search.
    const double start = (static_cast<double>(bin) - 1e-2) * knots.back() / bins;
    while (k + 1 < table.intervals && knots[k + 1] < start) ++k;
    table.first.push_back(static_cast<std::uint16_t>(k));
  }
  table.knots.assign(knots.begin(), knots.end());
  table.inverse.reserve(table.intervals);
  table.coefficients.reserve(9 * table.intervals);
  for (std::size_t i = 0; i < table.intervals; ++i) {
    const double a = knots[i], length = knots[i + 1] - a;
    table.inverse.push_back(static_cast<float>(1 / length));
    // Parabolas through three places of the interval's inside, where eval_basis takes it.
    const SplineValues p = eval_basis(basis, a + length / 4), q = eval_basis(basis, a + length / 2),
                       r = eval_basis(basis, a + length * 3 / 4);
    for (std::size_t j = 0; j < 3; ++j) {
      const double second = 8 * (p.value[j] - 2 * q.value[j] + r.value[j]);
      const double slope = 2 * (r.value[j] - p.value[j]) - second;
      const double start = q.value[j] - slope / 2 - second / 4;
      for (const double power : {start, slope, second})
        table.coefficients.push_back(static_cast<float>(power));
    }
  }
  return table;
}

BasisView view_of(const BasisTable& table) {
  return {.degree = table.degree,
          .intervals = table.intervals,
          .bins_per_mm = table.bins_per_mm,
          .bins = table.first.size(),
          .first = table.first.data(),
          .knots = table.knots.data(),
          .inverse = table.inverse.data(),
          .coefficients = table.coefficients.data()};
}

void deposit_path(const BasisView& basis, const LitPath& lit, const float* colour, float* sums,
                  float* value) {
  if (lit.count == 0) return;
  if (basis.degree == 1)
    add_hats(basis, lit, sums);
  else
    add_quadratics(basis, lit, sums);
  add_colours(colour, 4 * (basis.intervals + static_cast<std::size_t>(basis.degree)), sums, value);
}

}  // namespace parian

#include "bench/reference/peers_2006.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/check.h"
#include "base/hot.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/stopwatch.h"

namespace parian {
namespace {

constexpr std::size_t lanes = 64;  // rows of a block

int squared_length(Offset d) {
  return d.dx * d.dx + d.dy * d.dy;
}

// h(|d|): geometric mean of what is measured and positive.
void find_mean_decay(const OffsetMatrix& matrix, PeersChannel& channel) {
  const std::size_t columns = matrix.columns();
  std::vector<double> sum(columns, 0.0), count(columns, 0.0);
  for (std::size_t x = 0; x < matrix.rows; ++x) {
    std::size_t m = matrix.missing_begin[x];
    for (std::size_t i = 0; i < columns; ++i) {
      const float value = matrix.values[x * columns + i];
      if (m < matrix.missing_begin[x + 1] && matrix.missing_column[m] == i) {
        ++m;
      } else if (value > 0) {
        sum[i] += static_cast<double>(std::log(value));
        count[i] += 1;
      }
    }
  }
  std::map<int, std::pair<double, double>> rings;
  for (std::size_t i = 0; i < columns; ++i) {
    auto& ring = rings[squared_length(matrix.offsets[i])];
    ring.first += sum[i];
    ring.second += count[i];
  }
  for (const auto& [radius2, ring] : rings) {
    channel.radius2.push_back(radius2);
    channel.mean_decay.push_back(
        ring.second > 0 ? static_cast<float>(std::exp(ring.first / ring.second)) : 0.0f);
  }
}

// h v starts as the responses of random pixels: never worse than h alone once u is solved for.
void start_factors(const OffsetMatrix& matrix, std::size_t rank, std::uint64_t seed, Factors& f) {
  const std::size_t columns = matrix.columns();
  f.rank = rank;
  f.left.assign(matrix.rows * rank, 0.0f);
  f.right.resize(columns * rank);
  Rng rng = make_rng(seed);
  for (std::size_t k = 0; k < rank; ++k) {
    const auto x =
        std::min(matrix.rows - 1,
                 static_cast<std::size_t>(sample_uniform(rng) * static_cast<double>(matrix.rows)));
    for (std::size_t i = 0; i < columns; ++i)
      f.right[i * rank + k] = std::max(0.0f, matrix.values[x * columns + i]);
  }
}

// One sweep over the unknowns u [term][lane] of some rows, side by side: with G = right^T right and
// P = A right, u_k = max(0, u_k + (P_k - sum_j G_kj u_j) / G_kk).
PARIAN_HOT void sweep_rows(const float* PARIAN_RESTRICT g, const float* PARIAN_RESTRICT product,
                           std::size_t rank, float* PARIAN_RESTRICT u) {
  for (std::size_t k = 0; k < rank; ++k) {
    const float own = g[k * rank + k];
    if (!(own > 0)) continue;
    float rest[lanes];
    for (std::size_t x = 0; x < lanes; ++x) rest[x] = product[k * lanes + x];
    for (std::size_t j = 0; j < rank; ++j)
      for (std::size_t x = 0; x < lanes; ++x) rest[x] -= g[k * rank + j] * u[j * lanes + x];
    for (std::size_t x = 0; x < lanes; ++x) {
      const float value = u[k * lanes + x] + rest[x] / own;
      u[k * lanes + x] = value > 0 ? value : 0.0f;
    }
  }
}

// Lowers |A - left right^T|^2 over left >= 0.
void descend(const std::vector<double>& gram, const AlignedVector<float>& product, std::size_t rank,
             int sweeps, AlignedVector<float>& left) {
  const std::vector<float> g(gram.begin(), gram.end());
  parallel_for_blocks(left.size() / rank, lanes, [&](std::size_t begin, std::size_t end) {
    AlignedVector<float> u(rank * lanes), p(rank * lanes);
    std::fill(u.begin(), u.end(), 0.0f);
    std::fill(p.begin(), p.end(), 0.0f);
    for (std::size_t x = begin; x < end; ++x)
      for (std::size_t k = 0; k < rank; ++k) {
        u[k * lanes + x - begin] = left[x * rank + k];
        p[k * lanes + x - begin] = product[x * rank + k];
      }
    for (int sweep = 0; sweep < sweeps; ++sweep) sweep_rows(g.data(), p.data(), rank, u.data());
    for (std::size_t x = begin; x < end; ++x)
      for (std::size_t k = 0; k < rank; ++k) left[x * rank + k] = u[k * lanes + x - begin];
  });
}

// |A - left right^T|^2 from |A|^2, A^T left and both Gram matrices.
double residual2(double squares, const Factors& f, const AlignedVector<float>& product,
                 const std::vector<double>& gram_left, const std::vector<double>& gram_right) {
  double cross = 0, model = 0;
  for (std::size_t i = 0; i < f.right.size(); ++i)
    cross += static_cast<double>(product[i]) * static_cast<double>(f.right[i]);
  for (std::size_t i = 0; i < gram_left.size(); ++i) model += gram_left[i] * gram_right[i];
  return squares - 2 * cross + model;
}

// Both columns of each term get the same norm: the product stays, rounding is shared.
void balance(Factors& f) {
  for (std::size_t k = 0; k < f.rank; ++k) {
    double left = 0, right = 0;
    for (std::size_t i = k; i < f.left.size(); i += f.rank)
      left += static_cast<double>(f.left[i]) * static_cast<double>(f.left[i]);
    for (std::size_t i = k; i < f.right.size(); i += f.rank)
      right += static_cast<double>(f.right[i]) * static_cast<double>(f.right[i]);
    if (!(left > 0 && right > 0)) continue;
    const auto scale = static_cast<float>(std::pow(right / left, 0.25));
    for (std::size_t i = k; i < f.left.size(); i += f.rank) f.left[i] *= scale;
    for (std::size_t i = k; i < f.right.size(); i += f.rank) f.right[i] /= scale;
  }
}

std::string form_name(PeersForm form) {
  switch (form) {
    case PeersForm::plain:
      return "Peers 2006, plain";
    case PeersForm::symmetrised:
      return "Peers 2006, symmetrised";
    case PeersForm::half_plane:
      break;
  }
  return "Peers 2006, half plane";
}

}  // namespace

PeersChannel factor_peers_2006(OffsetMatrix& matrix, const PeersParams& params) {
  const std::size_t rows = matrix.rows, columns = matrix.columns();
  const std::size_t rank = std::min({params.rank, rows, columns});
  PARIAN_CHECK_LT(std::size_t{0}, rank);
  PeersChannel channel;
  find_mean_decay(matrix, channel);
  Factors& f = channel.factors;
  start_factors(matrix, rank, params.seed, f);
  AlignedVector<float> left_product(rows * rank), right_product(columns * rank);
  std::vector<double> gram_right = make_gram(f.right.data(), columns, rank);
  for (int i = 0; i < params.iterations; ++i) {
    multiply(matrix.values.data(), rows, columns, f.right.data(), rank, left_product.data());
    descend(gram_right, left_product, rank, i == 0 ? 20 : params.sweeps, f.left);
    const double squares = fill_missing(matrix, f);
    multiply_transposed(matrix.values.data(), rows, columns, f.left.data(), rank,
                        right_product.data());
    const std::vector<double> gram_left = make_gram(f.left.data(), rows, rank);
    if (i == 0)
      channel.objective.push_back(residual2(squares, f, right_product, gram_left, gram_right));
    descend(gram_left, right_product, rank, params.sweeps, f.right);
    gram_right = make_gram(f.right.data(), columns, rank);
    // Of the filled matrix: an upper bound of the measured part until it is filled in anew.
    channel.objective.push_back(residual2(squares, f, right_product, gram_left, gram_right));
    if (i % 8 == 7) {
      balance(f);
      gram_right = make_gram(f.right.data(), columns, rank);
    }
    fill_missing(matrix, f);
    const double last = channel.objective.back(), before = channel.objective.end()[-2];
    if (before - last <= params.tolerance * before) break;
  }
  return channel;
}

std::size_t peers_2006_bytes(const PeersChannel& channel) {
  const Factors& f = channel.factors;
  return sizeof(float) * (f.left.size() + f.right.size() + channel.mean_decay.size());
}

Rival compress_peers_2006(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed,
                          PeersForm form) {
  const Stopwatch watch;
  const auto channels = static_cast<std::size_t>(table.header.channels);
  Rival rival{.name = form_name(form)};
  std::vector<Factors> factors;
  for (std::size_t c = 0; c < channels; ++c) {
    OffsetMatrix matrix =
        make_offset_matrix(table, static_cast<int>(c),
                           form == PeersForm::half_plane ? Directions::listed : Directions::both);
    std::vector<int> rings;
    rings.reserve(matrix.columns());
    for (const Offset d : matrix.offsets) rings.push_back(squared_length(d));
    std::sort(rings.begin(), rings.end());
    const auto distances =
        static_cast<std::size_t>(std::unique(rings.begin(), rings.end()) - rings.begin());
    const std::size_t fixed = sizeof(float) * distances * channels;
    const std::size_t term = sizeof(float) * (matrix.rows + matrix.columns());
    const std::size_t terms = bytes > fixed ? (bytes - fixed) / term : 0;
    if (terms < channels) return {.name = rival.name, .bytes = fixed + channels * term};
    PeersParams params;
    params.rank = terms / channels + (c < terms % channels ? 1 : 0);
    params.seed = seed;
    const PeersChannel channel = factor_peers_2006(matrix, params);
    rival.bytes += peers_2006_bytes(channel);
    factors.push_back(channel.factors);
  }
  rival.slices = make_factor_slices(table.header, std::move(factors),
                                    form == PeersForm::symmetrised, rival.name);
  rival.seconds = watch.seconds();
  return rival;
}

}  // namespace parian

#include "bench/reference/truncated_svd.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/random.h"
#include "base/stopwatch.h"

namespace parian {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MutableMap = Eigen::Map<Matrix>;

Eigen::Index index(std::size_t i) {
  return static_cast<Eigen::Index>(i);
}

void orthonormalise(float* columns, std::size_t rows, std::size_t k) {
  MutableMap map(columns, index(rows), index(k));
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(map.cast<double>());
  const Eigen::MatrixXd thin = qr.householderQ() * Eigen::MatrixXd::Identity(index(rows), index(k));
  map = thin.cast<float>();
}

// Rotates left = A right so that its columns become orthogonal, by falling norm.
std::vector<double> rotate_to_singular(Factors& f, std::size_t rows, std::size_t columns) {
  const std::vector<double> gram = make_gram(f.left.data(), rows, f.rank);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      Eigen::Map<const Eigen::MatrixXd>(gram.data(), index(f.rank), index(f.rank)));
  const Matrix turn = solver.eigenvectors().rowwise().reverse().cast<float>();
  const Factors old = f;
  multiply(old.left.data(), rows, f.rank, turn.data(), f.rank, f.left.data());
  multiply(old.right.data(), columns, f.rank, turn.data(), f.rank, f.right.data());
  std::vector<double> singular(f.rank);
  for (std::size_t i = 0; i < f.rank; ++i)
    singular[i] = std::sqrt(std::max(0.0, solver.eigenvalues()[index(f.rank - 1 - i)]));
  return singular;
}

// The channel and term with the next largest singular value, as long as it fits.
std::vector<std::size_t> share_ranks(const std::vector<std::vector<double>>& singular,
                                     std::size_t terms) {
  std::vector<std::size_t> ranks(singular.size(), 0);
  for (std::size_t i = 0; i < terms; ++i) {
    std::size_t best = singular.size();
    double largest = 0;
    for (std::size_t c = 0; c < singular.size(); ++c)
      if (ranks[c] < singular[c].size() && singular[c][ranks[c]] > largest) {
        largest = singular[c][ranks[c]];
        best = c;
      }
    if (best == singular.size()) break;
    ++ranks[best];
  }
  return ranks;
}

}  // namespace

Factors factor_svd(OffsetMatrix& matrix, std::size_t rank, const SvdParams& params,
                   std::vector<double>* singular) {
  const std::size_t rows = matrix.rows, columns = matrix.columns();
  rank = std::min({rank, rows, columns});
  Factors f;
  f.rank = std::min({rank + params.extra, rows, columns});
  f.left.resize(rows * f.rank);
  f.right.resize(columns * f.rank);
  Rng rng = make_rng(params.seed);
  for (float& value : f.right) value = static_cast<float>(sample_normal(rng));
  std::vector<double> values;
  for (int round = 0;; ++round) {
    orthonormalise(f.right.data(), columns, f.rank);
    multiply(matrix.values.data(), rows, columns, f.right.data(), f.rank, f.left.data());
    if (round == params.rounds) break;
    // The first rounds know too little to fill anything in from.
    if (round > 1) fill_missing(matrix, f);
    multiply_transposed(matrix.values.data(), rows, columns, f.left.data(), f.rank, f.right.data());
  }
  values = rotate_to_singular(f, rows, columns);
  values.resize(rank);
  if (singular) *singular = values;
  return truncate(f, rank);
}

Factors truncate(const Factors& factors, std::size_t rank) {
  if (rank >= factors.rank) return factors;
  Factors out;
  out.rank = rank;
  for (const auto& [from, to] :
       {std::pair{&factors.left, &out.left}, std::pair{&factors.right, &out.right}}) {
    const std::size_t rows = from->size() / factors.rank;
    to->resize(rows * rank);
    for (std::size_t x = 0; x < rows; ++x)
      std::copy_n(&(*from)[x * factors.rank], rank, to->data() + x * rank);
  }
  return out;
}

Rival compress_truncated_svd(const BssrdfTable& table, std::size_t bytes, std::uint64_t seed) {
  const Stopwatch watch;
  const TableHeader& header = table.header;
  const auto channels = static_cast<std::size_t>(header.channels);
  std::vector<Factors> factors;
  std::vector<std::vector<double>> singular(channels);
  std::size_t terms = 0, term_bytes = 0;
  for (std::size_t c = 0; c < channels; ++c) {
    OffsetMatrix matrix = make_offset_matrix(table, static_cast<int>(c), Directions::listed);
    term_bytes = sizeof(float) * (matrix.rows + matrix.columns());
    terms = bytes / term_bytes;
    if (terms < channels) return {.name = "truncated SVD", .bytes = channels * term_bytes};
    SvdParams params;
    params.seed = seed;
    factors.push_back(factor_svd(matrix, (3 * terms) / (2 * channels) + 1, params, &singular[c]));
  }
  const std::vector<std::size_t> ranks = share_ranks(singular, terms);
  Rival rival{.name = "truncated SVD"};
  for (std::size_t c = 0; c < channels; ++c) {
    factors[c] = truncate(factors[c], ranks[c]);
    rival.bytes += ranks[c] * term_bytes;
  }
  rival.slices = make_factor_slices(header, std::move(factors), false, rival.name);
  rival.seconds = watch.seconds();
  return rival;
}

}  // namespace parian

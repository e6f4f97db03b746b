#include <algorithm>
#include <cmath>
#include <vector>

#include "compress/bases.h"

namespace parian {
namespace {

// Symmetric, two diagonals beside the main one: band[i] = A(j, j + i).
struct Banded {
  std::vector<double> band[3];
  explicit Banded(std::size_t size) {
    for (std::vector<double>& diagonal : band) diagonal.assign(size, 0.0);
  }
  std::size_t size() const { return band[0].size(); }
};

Banded make_matrix(const double* diagonal, const double* coupling, double curvature_weight,
                   std::size_t knots) {
  Banded matrix(knots);
  for (std::size_t k = 0; k < knots; ++k) {
    matrix.band[0][k] = diagonal[k];
    if (k + 1 < knots) matrix.band[1][k] = coupling[k];
  }
  constexpr double row[3] = {1, -2, 1};
  for (std::size_t h = 0; h + 2 < knots; ++h)
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = i; j < 3; ++j)
        matrix.band[j - i][h + i] += curvature_weight * row[i] * row[j];
  return matrix;
}

double eval(const Banded& matrix, const double* b, const double* v) {
  double value = 0;
  for (std::size_t k = 0; k < matrix.size(); ++k) {
    value += v[k] * (0.5 * matrix.band[0][k] * v[k] - b[k]);
    for (std::size_t i = 1; i < 3 && k + i < matrix.size(); ++i)
      value += matrix.band[i][k] * v[k] * v[k + i];
  }
  return value;
}

// A over groups of equal neighbours: sums of blocks, again banded.
Banded join(const Banded& matrix, const std::vector<std::size_t>& group, std::size_t groups) {
  Banded joined(groups);
  for (std::size_t k = 0; k < matrix.size(); ++k)
    for (std::size_t i = 0; i < 3 && k + i < matrix.size(); ++i) {
      const std::size_t distance = group[k + i] - group[k];
      const double value = matrix.band[i][k];
      joined.band[distance][group[k]] += distance == 0 && i > 0 ? 2 * value : value;
    }
  return joined;
}

// A x = b by L D L^T, in place.
void solve(Banded matrix, std::vector<double>& x) {
  const std::size_t n = matrix.size();
  auto& d = matrix.band[0];
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 1; i < 3 && j + i < n; ++i) {
      const double factor = matrix.band[i][j] / d[j];
      for (std::size_t k = i; k < 3 && j + k < n; ++k)
        matrix.band[k - i][j + i] -= factor * matrix.band[k][j];
      x[j + i] -= factor * x[j];
    }
  for (std::size_t j = n; j-- > 0;) {
    x[j] /= d[j];
    for (std::size_t i = 1; i < 3 && j + i < n; ++i) x[j] -= matrix.band[i][j] / d[j] * x[j + i];
  }
}

// Values of the groups; `v` of the knots they stand for.
std::vector<double> solve_joined(const Banded& matrix, const std::vector<double>& b,
                                 const std::vector<std::size_t>& group, std::size_t groups) {
  std::vector<double> x(groups, 0.0);
  for (std::size_t k = 0; k < b.size(); ++k) x[group[k]] += b[k];
  solve(join(matrix, group, groups), x);
  return x;
}

}  // namespace

void solve_non_increasing(const double* diagonal, const double* coupling, double curvature_weight,
                          const double* right_hand_side, std::size_t knots, double* v) {
  Banded matrix = make_matrix(diagonal, coupling, curvature_weight, knots);
  double trace = 0;
  for (std::size_t k = 0; k < knots; ++k) trace += matrix.band[0][k];
  if (!(trace > 0)) return;
  // Knots that hardly any pair sees stay near where they are.
  const double hold = 1e-7 * trace / static_cast<double>(knots);
  std::vector<double> b(right_hand_side, right_hand_side + knots);
  for (std::size_t k = 0; k < knots; ++k) {
    matrix.band[0][k] += hold;
    b[k] += hold * v[k];
  }
  std::vector<std::size_t> group(knots);
  for (std::size_t k = 0; k < knots; ++k) group[k] = k;
  std::size_t groups = knots;
  std::vector<double> x;
  while (true) {
    x = solve_joined(matrix, b, group, groups);
    std::vector<std::size_t> to(groups, 0);
    for (std::size_t g = 1; g < groups; ++g) to[g] = to[g - 1] + (x[g] > x[g - 1] ? 0 : 1);
    if (to.back() + 1 == groups) break;
    groups = to.back() + 1;
    for (std::size_t& g : group) g = to[g];
  }
  std::vector<double> candidate(knots);
  for (std::size_t k = 0; k < knots; ++k) candidate[k] = x[group[k]];
  if (eval(matrix, b.data(), candidate.data()) < eval(matrix, b.data(), v))
    std::copy(candidate.begin(), candidate.end(), v);
}

}  // namespace parian

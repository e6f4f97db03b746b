#include "compress/simplex.h"

#include <algorithm>
#include <cmath>

namespace parian {
namespace {

using Gram = const double (*)[max_corners];

// A over a subset of the corners, by Cholesky with a trace of the diagonal added: z with
// A_SS z = 1, scaled to sum 1, is the nearest point of the subset's affine hull.
void nearest_in_hull(Gram gram, const std::size_t* support, std::size_t count, double ridge,
                     double* z) {
  double factor[max_corners][max_corners];
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double value = gram[support[i]][support[j]] + (i == j ? ridge : 0);
      for (std::size_t k = 0; k < j; ++k) value -= factor[i][k] * factor[j][k];
      factor[i][j] = i == j ? std::sqrt(std::max(value, ridge)) : value / factor[j][j];
    }
  for (std::size_t i = 0; i < count; ++i) {
    z[i] = 1;
    for (std::size_t k = 0; k < i; ++k) z[i] -= factor[i][k] * z[k];
    z[i] /= factor[i][i];
  }
  double sum = 0;
  for (std::size_t i = count; i-- > 0;) {
    for (std::size_t k = i + 1; k < count; ++k) z[i] -= factor[k][i] * z[k];
    z[i] /= factor[i][i];
    sum += z[i];
  }
  for (std::size_t i = 0; i < count; ++i) z[i] /= sum;
}

// The support's weights go towards z until the first is 0, which leaves; false when none did.
bool step_towards(const double* z, std::size_t* support, std::size_t& count, double* weights) {
  double step = 1;
  std::size_t leaves = count;
  for (std::size_t i = 0; i < count; ++i) {
    if (z[i] > 0) continue;
    const double limit = weights[support[i]] / (weights[support[i]] - z[i]);
    if (leaves == count || limit < step) {
      step = std::min(1.0, limit);
      leaves = i;
    }
  }
  for (std::size_t i = 0; i < count; ++i)
    weights[support[i]] += step * (z[i] - weights[support[i]]);
  if (leaves == count) return false;
  weights[support[leaves]] = 0;
  std::copy(support + leaves + 1, support + count, support + leaves);
  --count;
  return true;
}

// The corner that the gradient at `weights` favours most, or `count`.
std::size_t find_entering(Gram gram, std::size_t count, const double* weights, double tolerance) {
  double level = 0, product[max_corners];
  for (std::size_t i = 0; i < count; ++i) {
    product[i] = 0;
    for (std::size_t j = 0; j < count; ++j) product[i] += gram[i][j] * weights[j];
    level += weights[i] * product[i];
  }
  std::size_t best = count;
  double lowest = level - tolerance;
  for (std::size_t i = 0; i < count; ++i)
    if (weights[i] == 0 && product[i] < lowest) {
      lowest = product[i];
      best = i;
    }
  return best;
}

}  // namespace

void nearest_in_simplex(Gram gram, std::size_t count, double* weights) {
  if (count == 2) {  // a segment
    const double length = gram[0][0] - 2 * gram[0][1] + gram[1][1];
    const double t = (gram[1][1] - gram[0][1]) / length;
    weights[0] = length > 0 ? std::clamp(t, 0.0, 1.0) : 1.0;
    weights[1] = 1 - weights[0];
    return;
  }
  std::fill_n(weights, count, 0.0);
  std::size_t nearest = 0;
  double trace = 0;
  for (std::size_t i = 0; i < count; ++i) {
    trace += gram[i][i];
    if (gram[i][i] < gram[nearest][nearest]) nearest = i;
  }
  weights[nearest] = 1;
  if (!(trace > 0)) return;
  const double ridge = 1e-10 * trace;
  std::size_t support[max_corners] = {nearest}, supported = 1;
  for (std::size_t round = 0; round < 4 * max_corners; ++round) {
    const std::size_t entering = find_entering(gram, count, weights, ridge);
    if (entering == count) return;
    support[supported++] = entering;
    for (bool again = true; again && supported > 1;) {
      double z[max_corners];
      nearest_in_hull(gram, support, supported, ridge, z);
      again = step_towards(z, support, supported, weights);
    }
    if (supported == 1) {  // what is left has all the weight
      std::fill_n(weights, count, 0.0);
      weights[support[0]] = 1;
    }
  }
}

void round_weights(double* weights, std::size_t count, int levels) {
  double remainder[max_corners];
  int left = levels;
  for (std::size_t i = 0; i < count; ++i) {
    const double scaled = weights[i] * levels, floor = std::floor(scaled + 1e-9);
    remainder[i] = scaled - floor;
    weights[i] = floor;
    left -= static_cast<int>(floor);
  }
  for (; left > 0; --left) {
    const auto largest = std::max_element(remainder, remainder + count) - remainder;
    weights[largest] += 1;
    remainder[largest] -= 1;
  }
  for (std::size_t i = 0; i < count; ++i) weights[i] /= levels;
}

}  // namespace parian

#include "acquire/path_stencil.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace parian {
namespace {

// Weights of the nodes in the box that the path spans, both ends included, along |dx| and |dy|.
std::vector<double> spread_path(int width, int height) {
  const auto columns = static_cast<std::size_t>(width) + 1;
  std::vector<double> weights(columns * (static_cast<std::size_t>(height) + 1));
  const int steps = std::max(1, static_cast<int>(std::ceil(2 * std::hypot(width, height))));
  for (int i = 0; i <= steps; ++i) {
    const double weight = (i == 0 || i == steps ? 0.5 : 1.0) / steps;
    const double x = static_cast<double>(i) * width / steps;
    const double y = static_cast<double>(i) * height / steps;
    const int x0 = std::min(static_cast<int>(x), std::max(0, width - 1));
    const int y0 = std::min(static_cast<int>(y), std::max(0, height - 1));
    for (int k = 0; k < 4; ++k) {
      const int nx = x0 + k % 2, ny = y0 + k / 2;
      if (nx > width || ny > height) continue;
      const double wx = k % 2 == 0 ? 1 - (x - x0) : x - x0;
      const double wy = k / 2 == 0 ? 1 - (y - y0) : y - y0;
      weights[static_cast<std::size_t>(ny) * columns + static_cast<std::size_t>(nx)] +=
          weight * (wx * wy);
    }
  }
  return weights;
}

}  // namespace

std::vector<PathPair> make_path_stencil(Offset offset) {
  const int width = std::abs(offset.dx), height = std::abs(offset.dy);
  const int sign_x = offset.dx < 0 ? -1 : 1, sign_y = offset.dy < 0 ? -1 : 1;
  const std::vector<double> weights = spread_path(width, height);
  const std::size_t last = weights.size() - 1;
  std::vector<PathPair> pairs;
  for (std::size_t i = 0; 2 * i <= last; ++i) {
    const std::size_t mirror = last - i;
    const double weight = 0.5 * (weights[i] + weights[mirror]);
    if (weight == 0) continue;
    const int column = static_cast<int>(i % (static_cast<std::size_t>(width) + 1));
    const int row = static_cast<int>(i / (static_cast<std::size_t>(width) + 1));
    const Offset near{sign_x * column, sign_y * row};
    // The middle node is its own mirror and counts half in each place.
    pairs.push_back(
        {near, {offset.dx - near.dx, offset.dy - near.dy}, i == mirror ? 0.5 * weight : weight});
  }
  return pairs;
}

}  // namespace parian

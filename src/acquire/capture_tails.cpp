#include <algorithm>
#include <array>
#include <cmath>

#include "acquire/capture_tails_internal.h"
#include "acquire/positive_fit_internal.h"
#include "base/parallel.h"

namespace parian {
namespace {

constexpr std::size_t bases = 14;            // exponentials
constexpr std::size_t max_samples = 400000;  // pairs of pixel and frame that the fit looks at

using Terms = Coefficients<bases>;

// Sums over the pairs of one class: places in the lattice's cell.
struct ClassSums {
  double count = 0, measured = 0;
  Terms basis{};
};

std::size_t pixel_count(const CaptureMeta& meta) {
  return static_cast<std::size_t>(meta.width) * static_cast<std::size_t>(meta.height);
}

// The square of the distance to the nearest dot, were there dots everywhere on the lattice.
int cell_distance2(const CaptureMeta& meta, int dx, int dy) {
  const int l = meta.lattice_px;
  const int x = std::min(dx, l - dx), y = std::min(dy, l - dy);
  return x * x + y * y;
}

// Exponentials from a decay over a fifth of a pixel to one over four lattices.
double decay_of(const CaptureMeta& meta, std::size_t k) {
  const double first = 0.25 / meta.lattice_px, last = 5;
  return first * std::pow(last / first, static_cast<double>(k) / (bases - 1));
}

std::vector<double> fit_tail(const CaptureMeta& meta, const DotResponses& responses, int channel) {
  const std::size_t pixels = pixel_count(meta);
  const auto lattice = static_cast<std::size_t>(meta.lattice_px);
  const auto reach = static_cast<std::size_t>(tail_reach2(meta)) + 1;
  std::vector<Terms> basis(reach);
  for (std::size_t r2 = 0; r2 < reach; ++r2)
    for (std::size_t k = 0; k < bases; ++k)
      basis[r2][k] = std::exp(-decay_of(meta, k) * std::sqrt(static_cast<double>(r2)));
  std::vector<ClassSums> classes(lattice * lattice);
  const std::size_t stride = pixels * lattice * lattice / max_samples + 1;
  for (std::size_t sample = 0; sample < pixels * lattice * lattice; sample += stride) {
    const std::size_t pixel = sample % pixels, frame = sample / pixels;
    const int x = static_cast<int>(pixel) % meta.width, y = static_cast<int>(pixel) / meta.width;
    const int i = static_cast<int>(frame % lattice), j = static_cast<int>(frame / lattice);
    const float value = responses.value[response_index(meta, i, j, channel) * pixels + pixel];
    if (std::isnan(value)) continue;
    const int dx = ((x - i) % meta.lattice_px + meta.lattice_px) % meta.lattice_px;
    const int dy = ((y - j) % meta.lattice_px + meta.lattice_px) % meta.lattice_px;
    ClassSums& sums =
        classes[static_cast<std::size_t>(dy) * lattice + static_cast<std::size_t>(dx)];
    sums.count += 1;
    sums.measured += value;
    for_each_dot(meta, i, j, x, y, [&](std::size_t r2, std::size_t) {
      for (std::size_t k = 0; k < bases; ++k) sums.basis[k] += basis[r2][k];
    });
  }
  std::array<Terms, bases> normal{};
  Terms right{};
  for (std::size_t index = 0; index < classes.size(); ++index) {
    const ClassSums& sums = classes[index];
    const int distance2 =
        cell_distance2(meta, static_cast<int>(index % lattice), static_cast<int>(index / lattice));
    if (sums.count == 0 || !(sums.measured > 0) ||
        16 * distance2 < meta.lattice_px * meta.lattice_px)
      continue;
    for (std::size_t k = 0; k < bases; ++k) {
      right[k] += sums.basis[k] / sums.measured;
      for (std::size_t l = 0; l < bases; ++l)
        normal[k][l] += sums.basis[k] * sums.basis[l] / (sums.measured * sums.measured);
    }
  }
  const Terms c = solve_positive(normal, right);
  std::vector<double> tail(reach);
  for (std::size_t r2 = 0; r2 < reach; ++r2)
    for (std::size_t k = 0; k < bases; ++k) tail[r2] += c[k] * basis[r2][k];
  return tail;
}

// factor(x) = measured / predicted between the dots, over all frames.
std::vector<double> fit_factors(const CaptureMeta& meta, const DotResponses& responses, int channel,
                                const TailModel& tail) {
  const std::size_t pixels = pixel_count(meta);
  std::vector<double> factors(pixels);
  parallel_for(pixels, [&](std::size_t pixel) {
    const int x = static_cast<int>(pixel) % meta.width, y = static_cast<int>(pixel) / meta.width;
    double measured = 0, predicted = 0;
    for (int j = 0; j < meta.lattice_px; ++j)
      for (int i = 0; i < meta.lattice_px; ++i) {
        const float value = responses.value[response_index(meta, i, j, channel) * pixels + pixel];
        if (std::isnan(value)) continue;
        double sum = 0;
        bool near = false;
        for_each_dot(meta, i, j, x, y, [&](std::size_t r2, std::size_t dot) {
          near = near || static_cast<int>(r2) * 16 < meta.lattice_px * meta.lattice_px;
          sum += tail.at[r2] * tail.factor[dot];
        });
        if (near) continue;
        measured += value;
        predicted += sum;
      }
    factors[pixel] = predicted > 0 ? std::clamp(measured / predicted, 0.0, 10.0) : 1;
  });
  return factors;
}

}  // namespace

TailModel make_tail_model(const CaptureMeta& meta, const DotResponses& responses, int channel) {
  TailModel tail{.at = fit_tail(meta, responses, channel),
                 .factor = std::vector<double>(pixel_count(meta), 1)};
  for (int round = 0; round < 3; ++round) tail.factor = fit_factors(meta, responses, channel, tail);
  return tail;
}

}  // namespace parian

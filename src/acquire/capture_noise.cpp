// The noise model of a capture, from the difference between the two directions of its pairs.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "acquire/capture_slices.h"

namespace parian {
namespace {

struct NoiseSample {
  double value = 0;     // mean of both directions
  double variance = 0;  // (R - R^T)^2 / 4
};

std::vector<NoiseSample> collect(const BssrdfTable& raw, int channel) {
  std::vector<NoiseSample> samples;
  const auto width = static_cast<std::size_t>(raw.header.width);
  for (const Offset d : raw.header.offsets) {
    if (!(d.dy > 0 || (d.dy == 0 && d.dx > 0))) continue;
    const float* forth = slice_of(raw, channel, find_offset(raw.header, d));
    const float* back = slice_of(raw, channel, find_offset(raw.header, {-d.dx, -d.dy}));
    const PixelRange range = pairs_in_grid(raw.header, d);
    for (int y = range.y0; y < range.y1; ++y)
      for (int x = range.x0; x < range.x1; ++x) {
        const double a = forth[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
        const double b =
            back[static_cast<std::size_t>(y + d.dy) * width + static_cast<std::size_t>(x + d.dx)];
        if (!std::isnan(a + b)) samples.push_back({(a + b) / 2, (a - b) * (a - b) / 4});
      }
  }
  return samples;
}

// Equally many samples per bin, by rising value.
std::vector<NoiseSample> make_bins(std::vector<NoiseSample> samples) {
  constexpr std::size_t bins = 40;
  std::sort(samples.begin(), samples.end(), [](const NoiseSample& a, const NoiseSample& b) {
    return a.value != b.value ? a.value < b.value : a.variance < b.variance;
  });
  std::vector<NoiseSample> means;
  for (std::size_t k = 0; k < bins; ++k) {
    const std::size_t begin = k * samples.size() / bins, end = (k + 1) * samples.size() / bins;
    if (begin == end) continue;
    NoiseSample mean;
    for (std::size_t i = begin; i < end; ++i)
      mean.value += samples[i].value, mean.variance += samples[i].variance;
    mean.value /= static_cast<double>(end - begin);
    mean.variance /= static_cast<double>(end - begin);
    if (mean.variance > 0) means.push_back(mean);
  }
  return means;
}

}  // namespace

NoiseModel fit_noise_model(const BssrdfTable& raw, int channel) {
  const std::vector<NoiseSample> bins = make_bins(collect(raw, channel));
  // variance = a + b R + c R^2 with relative weights; of all subsets of the terms the best one
  // whose coefficients are not negative.
  double best = std::numeric_limits<double>::infinity();
  NoiseModel model;
  for (int terms = 1; terms < 8; ++terms) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const auto row_of = [terms](const NoiseSample& bin) {
      const double value = std::max(0.0, bin.value);
      Eigen::Vector3d row(1, value, value * value);
      for (int k = 0; k < 3; ++k)
        if ((terms >> k & 1) == 0) row[k] = 0;
      return Eigen::Vector3d(row / bin.variance);
    };
    for (const NoiseSample& bin : bins) {
      const Eigen::Vector3d row = row_of(bin);
      normal += row * row.transpose();
      right += row;
    }
    const Eigen::Vector3d c = normal.completeOrthogonalDecomposition().solve(right);
    if (c.minCoeff() < 0) continue;
    double error = 0;
    for (const NoiseSample& bin : bins) {
      const double residual = row_of(bin).dot(c) - 1;
      error += residual * residual;
    }
    if (error < best) {
      best = error;
      model = {std::sqrt(c[0]), c[1], std::sqrt(c[2])};
    }
  }
  return model;
}

}  // namespace parian

// Raw appearance vectors, produced block by block, and their reduction by principal components.
#include "edit/features.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "edit/features_internal.h"

namespace parian {
namespace {

constexpr std::size_t block_size = 512;
// Principal directions come from whole blocks of at most about this many pixels, evenly spread.
constexpr std::size_t covariance_pixels = 16384;
// Partial sums of the covariance, added in order.
constexpr std::size_t groups = 16;
// Components with less than this part of the variance are rounding.
constexpr double smallest_variance = 1e-10;

struct Moments {
  double count = 0;
  Eigen::VectorXd mean;
  Eigen::MatrixXd scatter;
};

// Chan's formula: merges means and scatters without cancellation.
void add(Moments& sum, const Moments& part) {
  if (part.count == 0) return;
  if (sum.count == 0) {
    sum = part;
    return;
  }
  const double total = sum.count + part.count;
  const Eigen::VectorXd step = part.mean - sum.mean;
  sum.scatter += part.scatter;
  sum.scatter += (sum.count * part.count / total) * step * step.transpose();
  sum.mean += (part.count / total) * step;
  sum.count = total;
}

using Block = Eigen::MatrixXf;  // pixels by raw dims: a column is a plane

Moments moments_of(Block& block) {
  Moments moments;
  moments.count = static_cast<double>(block.rows());
  moments.mean = block.cast<double>().colwise().mean().transpose();
  block.rowwise() -= moments.mean.cast<float>().transpose();
  Eigen::MatrixXf scatter = Eigen::MatrixXf::Zero(block.cols(), block.cols());
  scatter.selfadjointView<Eigen::Lower>().rankUpdate(block.transpose());
  moments.scatter = scatter.cast<double>().selfadjointView<Eigen::Lower>();
  return moments;
}

Moments measure(std::size_t pixels, int raw_dims, const FillRaw& fill) {
  const std::size_t blocks = (pixels + block_size - 1) / block_size;
  const std::size_t stride = (pixels + covariance_pixels - 1) / covariance_pixels;
  std::vector<Moments> part(groups);
  parallel_for(groups, [&](std::size_t group) {
    for (std::size_t b = group * stride; b < blocks; b += groups * stride) {
      const std::size_t begin = b * block_size;
      const std::size_t count = std::min(block_size, pixels - begin);
      Block block(static_cast<Eigen::Index>(count), raw_dims);
      fill(begin, count, block.data());
      add(part[group], moments_of(block));
    }
  });
  for (std::size_t group = 1; group < groups; ++group) add(part[0], part[group]);
  return part[0];
}

// Columns: directions of the largest variances, signed so that the largest component is positive.
Eigen::MatrixXd principal_directions(const Moments& moments, int dims) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(moments.scatter);
  const Eigen::Index raw = moments.scatter.rows();
  const double total = std::max(0.0, solver.eigenvalues().sum());
  Eigen::Index kept = 1;
  while (kept < std::min<Eigen::Index>(dims, raw) &&
         solver.eigenvalues()[raw - 1 - kept] > smallest_variance * total)
    ++kept;
  Eigen::MatrixXd directions(raw, kept);
  for (Eigen::Index k = 0; k < kept; ++k) {
    Eigen::VectorXd direction = solver.eigenvectors().col(raw - 1 - k);
    Eigen::Index largest = 0;
    direction.cwiseAbs().maxCoeff(&largest);
    directions.col(k) = direction[largest] < 0 ? -direction : direction;
  }
  return directions;
}

void centre_and_scale(Features& features, double rounding) {
  const std::size_t pixels = features.pixels(), dims = static_cast<std::size_t>(features.dims);
  std::vector<double> mean(dims, 0);
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t d = 0; d < dims; ++d)
      mean[d] += static_cast<double>(features.values[i * dims + d]);
  for (double& m : mean) m /= static_cast<double>(pixels);
  double variance = 0;
  for (std::size_t i = 0; i < pixels; ++i) {
    for (std::size_t d = 0; d < dims; ++d) {
      const double v = static_cast<double>(features.values[i * dims + d]) - mean[d];
      variance += v * v;
    }
  }
  variance /= static_cast<double>(pixels);
  // The mean over ordered pairs of |a - b|^2 is twice the variance.
  const double scale = variance > rounding * rounding ? 1 / std::sqrt(2 * variance) : 0;
  for (std::size_t i = 0; i < pixels; ++i)
    for (std::size_t d = 0; d < dims; ++d) {
      float& v = features.values[i * dims + d];
      v = static_cast<float>((static_cast<double>(v) - mean[d]) * scale);
    }
}

void check_finite(int width, int raw_dims, std::size_t value, float found) {
  if (std::isfinite(found)) return;
  const std::size_t pixel = value / static_cast<std::size_t>(raw_dims);
  const auto w = static_cast<std::size_t>(width);
  throw Error({.place = fmt::format("feature at pixel ({}, {})", pixel % w, pixel / w),
               .expected = "a finite value",
               .found = fmt::format("{}", found)});
}

}  // namespace

Features reduce_features(int width, int height, int raw_dims, int dims, const FillRaw& fill) {
  PARIAN_CHECK(width >= 1 && height >= 1 && raw_dims >= 1 && dims >= 1);
  Features features{.width = width, .height = height};
  const std::size_t pixels = features.pixels();
  const Moments moments = measure(pixels, raw_dims, fill);
  const Eigen::MatrixXf directions = principal_directions(moments, dims).cast<float>();
  const Eigen::RowVectorXf mean = moments.mean.cast<float>().transpose();
  features.dims = static_cast<int>(directions.cols());
  const auto kept = static_cast<std::size_t>(features.dims);
  features.values.resize(pixels * kept);
  parallel_for_blocks(pixels, block_size, [&](std::size_t begin, std::size_t end) {
    Block block(static_cast<Eigen::Index>(end - begin), raw_dims);
    fill(begin, end - begin, block.data());
    block.rowwise() -= mean;
    Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> out(
        features.values.data() + begin * kept, block.rows(), directions.cols());
    out.noalias() = block * directions;
  });
  const double largest = moments.mean.cwiseAbs().maxCoeff();
  centre_and_scale(features, 1e-6 * largest);
  return features;
}

double feature_distance_squared(const Features& features, std::size_t a, std::size_t b) {
  const auto dims = static_cast<std::size_t>(features.dims);
  double sum = 0;
  for (std::size_t d = 0; d < dims; ++d) {
    const double step = static_cast<double>(features.values[a * dims + d]) -
                        static_cast<double>(features.values[b * dims + d]);
    sum += step * step;
  }
  return sum;
}

Features make_features(int width, int height, int raw_dims, const std::vector<float>& values,
                       int dims) {
  PARIAN_CHECK(width >= 1 && height >= 1 && raw_dims >= 1);
  const auto raw = static_cast<std::size_t>(raw_dims);
  PARIAN_CHECK_EQ(values.size(),
                  static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * raw);
  float largest = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    check_finite(width, raw_dims, i, values[i]);
    largest = std::max(largest, std::abs(values[i]));
  }
  const float scale = largest > 0 ? largest : 1;  // squares of what is left do not overflow
  return reduce_features(width, height, raw_dims, dims,
                         [&](std::size_t begin, std::size_t count, float* out) {
                           for (std::size_t d = 0; d < raw; ++d)
                             for (std::size_t i = 0; i < count; ++i)
                               out[d * count + i] = values[(begin + i) * raw + d] / scale;
                         });
}

Features make_property_features(int width, int height, int planes, const std::vector<float>& values,
                                int dims) {
  PARIAN_CHECK(width >= 1 && height >= 1 && planes >= 1);
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const auto raw = static_cast<std::size_t>(planes);
  PARIAN_CHECK_EQ(values.size(), pixels * raw);
  std::vector<float> standard(values.size());
  for (std::size_t p = 0; p < raw; ++p) {
    const float* plane = values.data() + p * pixels;
    double sum = 0, squares = 0, largest = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
      check_finite(width, 1, i, plane[i]);
      sum += static_cast<double>(plane[i]);
    }
    const double mean = sum / static_cast<double>(pixels);
    for (std::size_t i = 0; i < pixels; ++i) {
      const double v = static_cast<double>(plane[i]) - mean;
      squares += v * v;
      largest = std::max(largest, std::abs(static_cast<double>(plane[i])));
    }
    const double deviation = std::sqrt(squares / static_cast<double>(pixels));
    const double factor = deviation > 1e-6 * largest ? 1 / deviation : 0;
    for (std::size_t i = 0; i < pixels; ++i)
      standard[i * raw + p] = static_cast<float>((static_cast<double>(plane[i]) - mean) * factor);
  }
  return make_features(width, height, planes, standard, dims);
}

}  // namespace parian

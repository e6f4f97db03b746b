#include "edit/synthesis_search.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/hot.h"
#include "base/parallel.h"

namespace parian {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::size_t at(int y, int x, int width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

// Planes of zero mean and unit variance; those that do not vary are left out.
Matrix standardise(const std::vector<float>& planes, int plane_count, int width, int height) {
  const auto pixels = static_cast<Eigen::Index>(at(height, 0, width));
  Matrix standard(plane_count, pixels);
  Eigen::Index kept = 0;
  for (int index = 0; index < plane_count; ++index) {
    const float* plane = planes.data() + index * pixels;
    for (Eigen::Index i = 0; i < pixels; ++i)
      if (!std::isfinite(plane[i]))
        throw Error({.place = fmt::format("plane {} at x {}, y {}", index, i % width, i / width),
                     .expected = "a finite value",
                     .found = fmt::format("{}", plane[i])});
    const Eigen::VectorXd values = Eigen::Map<const Eigen::VectorXf>(plane, pixels).cast<double>();
    const double mean = values.mean();
    const double deviation = std::sqrt((values.array() - mean).square().mean());
    if (deviation <= 1e-6 * std::abs(mean)) continue;  // rounding only
    standard.row(kept++) = (values.array() - mean) / deviation;
  }
  return standard.topRows(kept);
}

// sum += conj(a) b for spectra as in fft.h.
PARIAN_HOT void add_correlation(const float* PARIAN_RESTRICT a, const float* PARIAN_RESTRICT b,
                                float* PARIAN_RESTRICT sum, std::size_t count) {
  constexpr std::size_t lanes = spectrum_lanes<float>;
  for (std::size_t group = 0; group < count; group += 2 * lanes)
    for (std::size_t re = group; re < group + lanes; ++re) {
      const std::size_t im = re + lanes;
      sum[re] += a[re] * b[re] + a[im] * b[im];
      sum[im] += a[re] * b[im] - a[im] * b[re];
    }
}

}  // namespace

// Differences of patches are the same in any orthonormal basis of the planes, and planes correlate
// strongly, so few principal components do for all of them.
TextureSample make_texture_sample(const std::vector<float>& planes, int plane_count, int width,
                                  int height) {
  TextureSample sample{.width = width, .height = height, .planes = 0, .values = {}, .variance = 0};
  const Matrix standard = standardise(planes, plane_count, width, height);
  if (standard.rows() == 0) return sample;
  const Matrix covariance = standard * standard.transpose() / static_cast<double>(standard.cols());
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(covariance);
  constexpr double wanted_share = 0.99;
  const auto count = static_cast<int>(standard.rows());
  const int most = std::min(count, 8);
  sample.values.reserve(sample.pixels() * static_cast<std::size_t>(most));
  while (sample.planes < most && sample.variance < wanted_share * count) {
    const Eigen::Index column = count - 1 - sample.planes++;  // largest eigenvalues come last
    sample.variance += solver.eigenvalues()[column];
    const Eigen::VectorXf component =
        (standard.transpose() * solver.eigenvectors().col(column)).cast<float>();
    sample.values.insert(sample.values.end(), component.begin(), component.end());
  }
  return sample;
}

PatchSearch::PatchSearch(const TextureSample& sample)
    : sample_(sample), grid_(make_fft_grid(sample.width, sample.height, 0, 0)) {
  const auto planes = static_cast<std::size_t>(sample.planes);
  spectrum_size_ = 2 * grid_.frequencies<float>();
  spectra_.resize(planes * spectrum_size_);
  wanted_spectra_.resize(planes * spectrum_size_);
  sum_.resize(spectrum_size_);
  wanted_.resize(planes * sample.pixels());
  correlation_.resize(sample.pixels());
  parallel_for(planes, [&](std::size_t i) {
    forward_fft(grid_, sample_.plane(static_cast<int>(i)), &spectra_[i * spectrum_size_]);
  });
  fill_squares();
}

void PatchSearch::fill_squares() {
  const int stride = sample_.width + 1;
  squares_.assign(at(sample_.height + 1, 0, stride), 0.0);
  for (int y = 0; y < sample_.height; ++y) {
    double row = 0;
    for (int x = 0; x < sample_.width; ++x) {
      for (int plane = 0; plane < sample_.planes; ++plane) {
        const double value = sample_.plane(plane)[at(y, x, sample_.width)];
        row += value * value;
      }
      squares_[at(y + 1, x + 1, stride)] = squares_[at(y, x + 1, stride)] + row;
    }
  }
}

double PatchSearch::sum_squares(int x, int y, int width, int height) const {
  const int stride = sample_.width + 1;
  return squares_[at(y + height, x + width, stride)] - squares_[at(y, x + width, stride)] -
         squares_[at(y + height, x, stride)] + squares_[at(y, x, stride)];
}

// Patches stay inside the sample, so the cyclic correlation does not wrap where it is read.
void PatchSearch::correlate() {
  parallel_for(static_cast<std::size_t>(sample_.planes), [&](std::size_t i) {
    forward_fft(grid_, &wanted_[i * sample_.pixels()], &wanted_spectra_[i * spectrum_size_]);
  });
  std::fill(sum_.begin(), sum_.end(), 0.0f);
  for (std::size_t i = 0; i < static_cast<std::size_t>(sample_.planes); ++i)
    add_correlation(&wanted_spectra_[i * spectrum_size_], &spectra_[i * spectrum_size_],
                    sum_.data(), spectrum_size_);
  inverse_fft(grid_, sum_.data(), correlation_.data());
}

// sum (S - C)^2 = sum S^2 - 2 sum S C + sum C^2 over the overlap, which four boxes make up.
void PatchSearch::run(int width, int height, const Overlap& overlap,
                      std::vector<float>& difference) {
  double squares = 0;
  for (const float value : wanted_) squares += static_cast<double>(value) * value;
  correlate();
  const int columns = sample_.width - width + 1, rows = sample_.height - height + 1;
  const int right = width - overlap.right, low = height - overlap.bottom;
  const int middle = low - overlap.top;
  difference.resize(at(rows, 0, columns));
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const double own = sum_squares(x, y, width, overlap.top) +
                         sum_squares(x, y + low, width, overlap.bottom) +
                         sum_squares(x, y + overlap.top, overlap.left, middle) +
                         sum_squares(x + right, y + overlap.top, overlap.right, middle);
      const double sum =
          own + squares - 2.0 * static_cast<double>(correlation_[at(y, x, sample_.width)]);
      difference[at(y, x, columns)] = static_cast<float>(std::max(0.0, sum));
    }
}

}  // namespace parian

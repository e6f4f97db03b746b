#include "image/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/hot.h"
#include "math/vec.h"

namespace parian {
namespace {

constexpr int ssim_window = 11;
constexpr double ssim_sigma = 1.5;
constexpr double ssim_k1 = 0.01;
constexpr double ssim_k2 = 0.03;

void check_same_shape(const Image& reference, const Image& image) {
  PARIAN_CHECK_EQ(image.width, reference.width);
  PARIAN_CHECK_EQ(image.height, reference.height);
  PARIAN_CHECK_EQ(image.channels, reference.channels);
  PARIAN_CHECK(!reference.values.empty());
}

double peak_of(const Image& image) {
  return *std::max_element(image.values.begin(), image.values.end());
}

std::vector<double> make_window(int size) {
  std::vector<double> window(static_cast<std::size_t>(size));
  double sum = 0;
  for (int k = 0; k < size; ++k) {
    const double t = (k - 0.5 * (size - 1)) / ssim_sigma;
    sum += window[k] = std::exp(-0.5 * t * t);
  }
  for (double& weight : window) weight /= sum;
  return window;
}

PARIAN_HOT void add_scaled(const double* PARIAN_RESTRICT in, double factor, std::size_t count,
                           double* PARIAN_RESTRICT sum) {
  for (std::size_t i = 0; i < count; ++i) sum[i] += factor * in[i];
}

// The two images and their products, of which SSIM takes windowed means.
enum Moment { mean_a, mean_b, square_a, square_b, product, moment_count };

// Weighted means over windows along x of one row: [moment][window].
void filter_row(const Image& a, const Image& b, int y, int c, const std::vector<double>& window,
                std::vector<double>& values, std::vector<double>& row) {
  const std::size_t width = a.width, windows = width - window.size() + 1;
  values.resize(moment_count * width);
  for (std::size_t x = 0; x < width; ++x) {
    const double va = at(a, static_cast<int>(x), y, c), vb = at(b, static_cast<int>(x), y, c);
    const double moments[moment_count] = {va, vb, va * va, vb * vb, va * vb};
    for (std::size_t m = 0; m < moment_count; ++m) values[m * width + x] = moments[m];
  }
  row.assign(moment_count * windows, 0);
  for (std::size_t m = 0; m < moment_count; ++m)
    for (std::size_t k = 0; k < window.size(); ++k)
      add_scaled(&values[m * width + k], window[k], windows, &row[m * windows]);
}

// Sum of SSIM over one row of windows.
double sum_ssim(const std::vector<double>& means, std::size_t windows, double c1, double c2) {
  double sum = 0;
  for (std::size_t x = 0; x < windows; ++x) {
    const double a = means[mean_a * windows + x], b = means[mean_b * windows + x];
    const double aa = means[square_a * windows + x] - a * a;
    const double bb = means[square_b * windows + x] - b * b;
    const double ab = means[product * windows + x] - a * b;
    const double numerator = (2 * (a * b) + c1) * (2 * ab + c2);
    const double denominator = (a * a + b * b + c1) * (aa + bb + c2);
    sum += denominator == 0 ? 1 : numerator / denominator;  // 0/0: both windows are black
  }
  return sum;
}

}  // namespace

double mse(const Image& reference, const Image& image) {
  check_same_shape(reference, image);
  double sum = 0;
  for (std::size_t i = 0; i < reference.values.size(); ++i) {
    const double difference = static_cast<double>(image.values[i]) - reference.values[i];
    sum += difference * difference;
  }
  return sum / static_cast<double>(reference.values.size());
}

double psnr_db(const Image& reference, const Image& image) {
  const double error = mse(reference, image);
  if (error == 0) return std::numeric_limits<double>::infinity();
  const double peak = peak_of(reference);
  return 10 * std::log10(peak * peak / error);
}

double ssim(const Image& reference, const Image& image) {
  check_same_shape(reference, image);
  const double peak = peak_of(reference);
  const double c1 = ssim_k1 * peak * (ssim_k1 * peak), c2 = ssim_k2 * peak * (ssim_k2 * peak);
  const std::vector<double> window_x = make_window(std::min(ssim_window, reference.width));
  const std::vector<double> window_y = make_window(std::min(ssim_window, reference.height));
  const std::size_t across = reference.width - window_x.size() + 1;
  const std::size_t down = reference.height - window_y.size() + 1;
  double sum = 0;
  std::vector<double> values, means;
  std::vector<std::vector<double>> rows(window_y.size());  // a ring of filtered rows
  for (int c = 0; c < reference.channels; ++c)
    for (int y = 0; y < reference.height; ++y) {
      const std::size_t last = static_cast<std::size_t>(y);
      filter_row(reference, image, y, c, window_x, values, rows[last % rows.size()]);
      if (last + 1 < rows.size()) continue;
      means.assign(moment_count * across, 0);
      for (std::size_t k = 0; k < rows.size(); ++k)
        add_scaled(rows[(last + 1 + k) % rows.size()].data(), window_y[k], means.size(),
                   means.data());
      sum += sum_ssim(means, across, c1, c2);
    }
  return sum / (static_cast<double>(across * down) * reference.channels);
}

RelativeErrors relative_errors(const Image& reference, const Image& image,
                               const std::vector<float>& coverage) {
  check_same_shape(reference, image);
  PARIAN_CHECK_EQ(image.channels, 3);
  PARIAN_CHECK_EQ(3 * coverage.size(), image.values.size());
  const auto pixel = [](const Image& of, std::size_t i) {
    return Vec3{of.values[3 * i], of.values[3 * i + 1], of.values[3 * i + 2]};
  };
  double most = 0;
  for (std::size_t i = 0; i < coverage.size(); ++i)
    most = std::max(most, static_cast<double>(length(pixel(reference, i))));
  std::vector<double> errors;
  for (std::size_t i = 0; i < coverage.size(); ++i) {
    const Vec3 wanted = pixel(reference, i);
    if (coverage[i] < 0.999f || wanted == Vec3{}) continue;
    errors.push_back(static_cast<double>(distance(wanted, pixel(image, i))) /
                     (static_cast<double>(length(wanted)) + 1e-3 * most));
  }
  RelativeErrors result;
  result.pixels = errors.size();
  if (errors.empty()) return result;
  std::sort(errors.begin(), errors.end());
  for (const double error : errors) result.mean += error / static_cast<double>(errors.size());
  result.p99 = errors[errors.size() * 99 / 100];
  result.max = errors.back();
  return result;
}

}  // namespace parian

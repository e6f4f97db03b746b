#include "acquire/capture_resample.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"

namespace parian {
namespace {

constexpr int iterations = 60;
constexpr double tolerance = 1e-10;  // of the squared residual

// Part of a Gaussian at `centre` in the unit interval from x.
double interval_weight(double x, double centre, double sigma) {
  const double scale = 1 / (sigma * std::sqrt(2.0));
  return 0.5 * (std::erf((x + 1 - centre) * scale) - std::erf((x - centre) * scale));
}

// The weights of one grid pixel's image over a box of camera pixels.
struct Footprint {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  std::vector<double> weight;
};

// The pixel is cut into n x n points, each a Gaussian whose area is its part of the pixel's image.
Footprint make_footprint(const CaptureMeta& meta, const Homography& h, double psf, int gx, int gy) {
  const double pitch = meta.pixel_pitch_mm;
  double x0 = 1e30, x1 = -1e30, y0 = 1e30, y1 = -1e30;
  for (const int cx : {0, 1})
    for (const int cy : {0, 1}) {
      const Point p = apply(h, (gx + cx) * pitch, (gy + cy) * pitch);
      x0 = std::min(x0, p.x), x1 = std::max(x1, p.x);
      y0 = std::min(y0, p.y), y1 = std::max(y1, p.y);
    }
  const double reach = 4 * psf;
  Footprint box;
  const auto clamp_to = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  box.x0 = clamp_to(std::floor(x0 - reach), meta.camera_width);
  box.y0 = clamp_to(std::floor(y0 - reach), meta.camera_height);
  box.width = clamp_to(std::ceil(x1 + reach), meta.camera_width) - box.x0;
  box.height = clamp_to(std::ceil(y1 + reach), meta.camera_height) - box.y0;
  if (box.width <= 0 || box.height <= 0) return {};
  const auto width = static_cast<std::size_t>(box.width);
  box.weight.resize(width * static_cast<std::size_t>(box.height));
  const double longest = std::max(x1 - x0, y1 - y0);
  const int n = std::clamp(static_cast<int>(std::ceil(1.5 * longest / psf)), 3, 24);
  std::vector<double> along_x(width), along_y(static_cast<std::size_t>(box.height));
  for (int sy = 0; sy < n; ++sy)
    for (int sx = 0; sx < n; ++sx) {
      const double x = (gx + (sx + 0.5) / n) * pitch, y = (gy + (sy + 0.5) / n) * pitch;
      const Point p = apply(h, x, y);
      const double area = area_scale(h, x, y) * pitch * pitch / (n * n);
      for (std::size_t i = 0; i < width; ++i)
        along_x[i] = interval_weight(box.x0 + static_cast<double>(i), p.x, psf);
      for (std::size_t j = 0; j < along_y.size(); ++j)
        along_y[j] = area * interval_weight(box.y0 + static_cast<double>(j), p.y, psf);
      for (std::size_t j = 0; j < along_y.size(); ++j)
        for (std::size_t i = 0; i < width; ++i)
          box.weight[j * width + i] += along_x[i] * along_y[j];
    }
  return box;
}

void append(const CaptureMeta& meta, const Footprint& box, CameraOperator& b) {
  for (int j = 0; j < box.height; ++j)
    for (int i = 0; i < box.width; ++i) {
      const double weight =
          box.weight[static_cast<std::size_t>(j) * static_cast<std::size_t>(box.width) +
                     static_cast<std::size_t>(i)];
      if (weight < 1e-6) continue;
      b.camera_pixel.push_back(
          static_cast<std::uint32_t>((box.y0 + j) * meta.camera_width + box.x0 + i));
      b.weight.push_back(static_cast<float>(weight));
    }
}

// 1 / variance of one channel, the variance smoothed over 3 x 3 valid pixels.
std::vector<float> make_weights(const HdrImage& image, int channel) {
  const Image& variance = image.variance;
  std::vector<float> weights(static_cast<std::size_t>(variance.width) *
                             static_cast<std::size_t>(variance.height));
  for (int y = 0; y < variance.height; ++y)
    for (int x = 0; x < variance.width; ++x) {
      if (!std::isfinite(at(variance, x, y, channel))) continue;
      double sum = 0, count = 0;
      for (int j = std::max(0, y - 1); j <= std::min(variance.height - 1, y + 1); ++j)
        for (int i = std::max(0, x - 1); i <= std::min(variance.width - 1, x + 1); ++i) {
          const float value = at(variance, i, j, channel);
          if (std::isfinite(value)) sum += value, count += 1;
        }
      weights[static_cast<std::size_t>(y) * static_cast<std::size_t>(variance.width) +
              static_cast<std::size_t>(x)] = static_cast<float>(1 / std::max(sum / count, 1e-20));
    }
  return weights;
}

// e = B^T i
std::vector<double> apply_transposed(const CameraOperator& b, const std::vector<double>& image) {
  std::vector<double> result(b.begin.size() - 1);
  for (std::size_t k = 0; k < result.size(); ++k)
    for (std::size_t a = b.begin[k]; a < b.begin[k + 1]; ++a)
      result[k] += static_cast<double>(b.weight[a]) * image[b.camera_pixel[a]];
  return result;
}

std::vector<double> apply_double(const CameraOperator& b, const std::vector<double>& exitance) {
  std::vector<double> image(static_cast<std::size_t>(b.camera_width) *
                            static_cast<std::size_t>(b.camera_height));
  for (std::size_t k = 0; k < exitance.size(); ++k)
    for (std::size_t a = b.begin[k]; a < b.begin[k + 1]; ++a)
      image[b.camera_pixel[a]] += static_cast<double>(b.weight[a]) * exitance[k];
  return image;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

CameraOperator make_camera_operator(const CaptureMeta& meta, const Homography& mm_to_px,
                                    double psf_px) {
  CameraOperator b{.width = meta.width + 2 * resample_margin_px,
                   .height = meta.height + 2 * resample_margin_px,
                   .camera_width = meta.camera_width,
                   .camera_height = meta.camera_height};
  b.begin.push_back(0);
  for (int y = -resample_margin_px; y < meta.height + resample_margin_px; ++y)
    for (int x = -resample_margin_px; x < meta.width + resample_margin_px; ++x) {
      append(meta, make_footprint(meta, mm_to_px, psf_px, x, y), b);
      b.begin.push_back(b.weight.size());
    }
  return b;
}

std::vector<float> photograph(const CameraOperator& b, const std::vector<float>& exitance) {
  PARIAN_CHECK_EQ(exitance.size() + 1, b.begin.size());
  const std::vector<double> image =
      apply_double(b, std::vector<double>(exitance.begin(), exitance.end()));
  return {image.begin(), image.end()};
}

std::vector<float> resample(const CameraOperator& b, const HdrImage& image, int channel) {
  PARIAN_CHECK_EQ(image.value.width, b.camera_width);
  PARIAN_CHECK_EQ(image.value.height, b.camera_height);
  std::vector<float> weights = make_weights(image, channel);
  // In units of the largest weight, so that single precision cannot overflow.
  const std::size_t pixels = weights.size(), unknowns = b.begin.size() - 1;
  const double largest = *std::max_element(weights.begin(), weights.end());
  std::vector<double> w(pixels), right(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    w[i] = largest > 0 ? weights[i] / largest : 0;
    const float value = image.value.values[i * static_cast<std::size_t>(image.value.channels) +
                                           static_cast<std::size_t>(channel)];
    right[i] = w[i] > 0 ? w[i] * value : 0;
  }
  std::vector<double> diagonal(unknowns), seen(unknowns), valid(unknowns);
  for (std::size_t k = 0; k < unknowns; ++k)
    for (std::size_t a = b.begin[k]; a < b.begin[k + 1]; ++a) {
      const double weight = b.weight[a];
      diagonal[k] += weight * weight * w[b.camera_pixel[a]];
      seen[k] += weight;
      if (w[b.camera_pixel[a]] > 0) valid[k] += weight;
    }
  std::vector<double> e(unknowns), residual = apply_transposed(b, right), z(unknowns), p, q;
  const auto precondition = [&] {
    for (std::size_t k = 0; k < unknowns; ++k)
      z[k] = diagonal[k] > 0 ? residual[k] / diagonal[k] : 0;
  };
  precondition();
  p = z;
  double rho = dot(residual, z);
  const double first = rho;
  for (int n = 0; n < iterations && rho > tolerance * first; ++n) {
    q = apply_double(b, p);
    for (std::size_t i = 0; i < pixels; ++i) q[i] *= w[i];
    q = apply_transposed(b, q);
    const double step = rho / dot(p, q);
    for (std::size_t k = 0; k < unknowns; ++k) e[k] += step * p[k], residual[k] -= step * q[k];
    precondition();
    const double next = dot(residual, z);
    for (std::size_t k = 0; k < unknowns; ++k) p[k] = z[k] + next / rho * p[k];
    rho = next;
  }
  std::vector<float> result;
  const int m = resample_margin_px;
  for (int y = m; y < b.height - m; ++y)
    for (int x = m; x < b.width - m; ++x) {
      const std::size_t k = static_cast<std::size_t>(y) * static_cast<std::size_t>(b.width) +
                            static_cast<std::size_t>(x);
      result.push_back(seen[k] > 0 && valid[k] >= 0.5 * seen[k]
                           ? static_cast<float>(e[k])
                           : std::numeric_limits<float>::quiet_NaN());
    }
  return result;
}

Image predict_dots(const CaptureMeta& meta, const Homography& mm_to_px, double psf_px,
                   const Image& white) {
  Image image = make_image(meta.camera_width, meta.camera_height, 1);
  for (int y = 0; y < meta.height; y += meta.lattice_px)
    for (int x = 0; x < meta.width; x += meta.lattice_px) {
      const Footprint box = make_footprint(meta, mm_to_px, psf_px, x, y);
      const Point centre =
          apply(mm_to_px, (x + 0.5) * meta.pixel_pitch_mm, (y + 0.5) * meta.pixel_pitch_mm);
      const float light = at(white, std::clamp(static_cast<int>(centre.x), 0, white.width - 1),
                             std::clamp(static_cast<int>(centre.y), 0, white.height - 1), 0);
      for (int j = 0; j < box.height; ++j)
        for (int i = 0; i < box.width; ++i)
          at(image, box.x0 + i, box.y0 + j, 0) +=
              light * static_cast<float>(box.weight[static_cast<std::size_t>(j * box.width + i)]);
    }
  return image;
}

double estimate_psf(const CaptureMeta& meta, const Homography& mm_to_px, const Image& dots,
                    const Image& white) {
  // Squared difference between the dots and their predicted image, with the factor that fits best.
  const auto misfit = [&](double psf) {
    const Image predicted = predict_dots(meta, mm_to_px, psf, white);
    double pp = 0, pi = 0, ii = 0;
    for (std::size_t k = 0; k < dots.values.size(); ++k) {
      const double p = predicted.values[k], i = dots.values[k];
      pp += p * p, pi += p * i, ii += i * i;
    }
    return pp > 0 ? ii - pi * pi / pp : std::numeric_limits<double>::infinity();
  };
  // Golden section on ln psf.
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  double low = std::log(0.2), high = std::log(6.0);
  double a = high - ratio * (high - low), b = low + ratio * (high - low);
  double fa = misfit(std::exp(a)), fb = misfit(std::exp(b));
  for (int n = 0; n < 18; ++n) {
    if (fa < fb) {
      high = b, b = a, fb = fa, a = high - ratio * (high - low), fa = misfit(std::exp(a));
    } else {
      low = a, a = b, fa = fb, b = low + ratio * (high - low), fb = misfit(std::exp(b));
    }
  }
  return std::exp((low + high) / 2);
}

}  // namespace parian

#include "edit/mask.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/hot.h"
#include "base/parallel.h"
#include "image/color.h"

namespace parian {
namespace {

template <typename Combine>
Mask combine(const Mask& a, const Mask& b, const Combine& of) {
  PARIAN_CHECK_EQ(a.width, b.width);
  PARIAN_CHECK_EQ(a.height, b.height);
  Mask result = a;
  for (std::size_t i = 0; i < a.weight.size(); ++i) result.weight[i] = of(a.weight[i], b.weight[i]);
  return result;
}

int reflect(int i, int size) {
  const int period = 2 * size;
  i = (i % period + period) % period;
  return i < size ? i : period - 1 - i;
}

// out[i] = sum_j kernel[j] in[reflected i + j - reach], `count` samples `stride` apart.
void blur_line(const float* in, float* out, int count, std::size_t stride,
               const std::vector<double>& kernel) {
  const int reach = static_cast<int>(kernel.size()) / 2;
  for (int i = 0; i < count; ++i) {
    double sum = 0;
    for (int j = -reach; j <= reach; ++j)
      sum += kernel[static_cast<std::size_t>(j + reach)] *
             static_cast<double>(in[static_cast<std::size_t>(reflect(i + j, count)) * stride]);
    out[static_cast<std::size_t>(i) * stride] = static_cast<float>(std::min(1.0, sum));
  }
}

std::vector<double> gaussian_kernel(double sigma) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3 * sigma)));
  std::vector<double> kernel(2 * static_cast<std::size_t>(reach) + 1);
  double sum = 0;
  for (int j = -reach; j <= reach; ++j)
    sum += kernel[static_cast<std::size_t>(j + reach)] = std::exp(-0.5 * j * j / (sigma * sigma));
  for (double& value : kernel) value /= sum;
  return kernel;
}

PARIAN_HOT void raise_row(const float* PARIAN_RESTRICT from, float factor,
                          float* PARIAN_RESTRICT to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float value = factor * from[i];
    to[i] = value > to[i] ? value : to[i];
  }
}

}  // namespace

Mask make_mask(int width, int height, float value) {
  Mask mask{width, height, {}};
  mask.weight.assign(mask.pixels(), value);
  return mask;
}

bool is_empty(const Mask& mask) {
  return std::all_of(mask.weight.begin(), mask.weight.end(), [](float w) { return w == 0; });
}

Mask make_mask(const Image& image, int width, int height) {
  if (image.width != width || image.height != height)
    throw Error({.expected = fmt::format("an image of {} x {} pixels, as the map", width, height),
                 .found = fmt::format("{} x {}", image.width, image.height)});
  Mask mask{width, height, {}};
  mask.weight.reserve(mask.pixels());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float value = image.channels >= 3 ? luminance(at(image, x, y, 0), at(image, x, y, 1),
                                                          at(image, x, y, 2))
                                              : at(image, x, y, 0);
      if (!std::isfinite(value))
        throw Error({.place = fmt::format("pixel ({}, {})", x, y),
                     .expected = "a finite value",
                     .found = fmt::format("{}", value)});
      mask.weight.push_back(std::clamp(value, 0.0f, 1.0f));
    }
  return mask;
}

Mask threshold(const double* values, int width, int height, double low, double high,
               double softness) {
  Mask mask{width, height, {}};
  mask.weight.reserve(mask.pixels());
  for (std::size_t i = 0; i < mask.pixels(); ++i) {
    const double beyond = std::max({low - values[i], values[i] - high, 0.0});
    const double t = softness > 0 ? std::min(1.0, beyond / softness) : (beyond > 0 ? 1.0 : 0.0);
    mask.weight.push_back(static_cast<float>(1 - t * t * (3 - 2 * t)));
  }
  return mask;
}

Mask unite(const Mask& a, const Mask& b) {
  return combine(a, b, [](float x, float y) { return std::max(x, y); });
}

Mask intersect(const Mask& a, const Mask& b) {
  return combine(a, b, [](float x, float y) { return std::min(x, y); });
}

Mask subtract(const Mask& a, const Mask& b) {
  return combine(a, b, [](float x, float y) { return std::min(x, 1 - y); });
}

Mask invert(Mask mask) {
  for (float& weight : mask.weight) weight = 1 - weight;
  return mask;
}

Mask scale(Mask mask, double factor) {
  PARIAN_CHECK(factor >= 0 && factor <= 1);
  if (factor != 1)
    for (float& weight : mask.weight) weight *= static_cast<float>(factor);
  return mask;
}

Mask feather(const Mask& mask, double sigma_px) {
  if (!(sigma_px > 0)) return mask;
  // Beyond the map's size a mirrored blur is its mean.
  const std::vector<double> kernel =
      gaussian_kernel(std::min(sigma_px, 2.0 * std::max(mask.width, mask.height)));
  Mask rows = mask, blurred = mask;
  const auto width = static_cast<std::size_t>(mask.width);
  parallel_for(static_cast<std::size_t>(mask.height), [&](std::size_t y) {
    blur_line(&mask.weight[y * width], &rows.weight[y * width], mask.width, 1, kernel);
  });
  parallel_for(width, [&](std::size_t x) {
    blur_line(&rows.weight[x], &blurred.weight[x], mask.height, width, kernel);
  });
  return blurred;
}

Mask grow(const Mask& mask, double radius_px) {
  if (radius_px < 0) return invert(grow(invert(mask), -radius_px));
  if (radius_px == 0) return mask;
  const double radius =
      std::min(radius_px, std::hypot(static_cast<double>(mask.width), mask.height));
  const int reach = static_cast<int>(std::ceil(radius + 1));
  Mask grown = mask;
  const auto width = static_cast<std::size_t>(mask.width);
  parallel_for(static_cast<std::size_t>(mask.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    for (int dy = std::max(-reach, -y); dy <= std::min(reach, mask.height - 1 - y); ++dy) {
      const float* from = &mask.weight[static_cast<std::size_t>(y + dy) * width];
      if (std::all_of(from, from + width, [](float w) { return w == 0; })) continue;
      for (int dx = -reach; dx <= reach; ++dx) {
        // From a pixel whose edge is half a pixel beyond its centre: the rim covers pixels in part.
        const double inside = radius - std::hypot(dx, dy) + 1;
        if (inside <= 0 || std::abs(dx) >= mask.width) continue;
        const auto skip = static_cast<std::size_t>(std::max(0, -dx));
        const std::size_t count = width - static_cast<std::size_t>(std::abs(dx));
        raise_row(from + static_cast<std::size_t>(std::max(0, dx)),
                  static_cast<float>(std::min(1.0, inside)), &grown.weight[row * width + skip],
                  count);
      }
    }
  });
  return grown;
}

}  // namespace parian

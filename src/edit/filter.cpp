#include "edit/filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/parallel.h"
#include "edit/filter_kernels.h"

namespace parian {
namespace {

constexpr int max_steps = 48;  // of the bilateral window to each side

std::size_t to_size(int value) {
  return static_cast<std::size_t>(value);
}

void check_sigma(double sigma_px, int width, int height) {
  PARIAN_CHECK(width > 0 && height > 0);
  const int limit = std::max(width, height);
  if (sigma_px >= 0 && sigma_px <= limit) return;
  throw Error{{.place = "sigma-px",
               .expected = fmt::format("a number in [0, {}], the larger side of the image", limit),
               .found = fmt::format("{}", sigma_px)}};
}

void check_values(const float* values, const char* name, int planes, int width, int height) {
  const std::size_t pixels = to_size(width) * to_size(height);
  for (std::size_t i = 0; i < pixels * to_size(planes); ++i) {
    if (std::abs(values[i]) <= 1e30f) continue;
    const std::size_t pixel = i % pixels;
    throw Error{{.place = fmt::format("{}, plane {}, pixel ({}, {})", name, i / pixels,
                                      pixel % to_size(width), pixel / to_size(width)),
                 .expected = "a number of magnitude at most 1e30",
                 .found = fmt::format("{}", values[i])}};
  }
}

// The cut of the Gaussian: beyond it lie 0.3 % of the weight.
int window_radius(double sigma_px) {
  return static_cast<int>(std::ceil(3 * sigma_px));
}

// Half-sample reflection: ... 1 0 | 0 1 ... n-1 | n-1 n-2 ...
int reflect(int i, int n) {
  const int period = 2 * n, k = ((i % period) + period) % period;
  return k < n ? k : period - 1 - k;
}

// Weights of offsets 0..radius, folded to radius <= size: the reflected image has period 2 size.
std::vector<float> gaussian_weights(double sigma_px, int size) {
  const int radius = window_radius(sigma_px);
  std::vector<double> weights(to_size(radius) + 1), folded(to_size(std::min(radius, size)) + 1);
  double total = 0;
  for (int k = 0; k <= radius; ++k) {
    const double x = k > 0 ? k / sigma_px : 0.0;
    weights[to_size(k)] = std::exp(-0.5 * x * x);
    total += (k > 0 ? 2 : 1) * weights[to_size(k)];
  }
  for (int k = 0; k <= radius; ++k) {
    const int m = k % (2 * size), to = std::min(m, 2 * size - m);
    // Offsets k and -k are one where they meet at the period.
    const double factor = to == 0 && k > 0 ? 2.0 : 1.0;
    folded[to_size(to)] += factor * weights[to_size(k)] / total;
  }
  return {folded.begin(), folded.end()};
}

void over_rows(int height, int block, const std::function<void(int, int)>& body) {
  parallel_for_blocks(to_size(height), to_size(block), [&](std::size_t begin, std::size_t end) {
    body(static_cast<int>(begin), static_cast<int>(end));
  });
}

// Gaussian of one plane; out may be in.
void smooth_plane(const float* in, int width, int height, double sigma_px, float* out) {
  const std::vector<float> along_x = gaussian_weights(sigma_px, width);
  const std::vector<float> along_y = gaussian_weights(sigma_px, height);
  const int pad = static_cast<int>(along_x.size()) - 1,
            reach = static_cast<int>(along_y.size()) - 1;
  std::vector<float> rows(to_size(width) * to_size(height));
  over_rows(height, 16, [&](int begin, int end) {
    std::vector<float> padded(to_size(width + 2 * pad));
    for (int y = begin; y < end; ++y) {
      const float* row = in + to_size(y) * to_size(width);
      std::copy_n(row, width, padded.data() + pad);
      for (int x = 1; x <= pad; ++x) {
        padded[to_size(pad - x)] = row[reflect(-x, width)];
        padded[to_size(pad + width - 1 + x)] = row[reflect(width - 1 + x, width)];
      }
      convolve_row(padded.data() + pad, along_x.data(), pad, width,
                   rows.data() + to_size(y) * to_size(width));
    }
  });
  const auto row_at = [&](int y) {
    return rows.data() + to_size(reflect(y, height)) * to_size(width);
  };
  over_rows(height, 16, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      float* to = out + to_size(y) * to_size(width);
      convolve_row(row_at(y), along_y.data(), 0, width, to);
      for (int k = 1; k <= reach; ++k)
        add_rows_weighted(row_at(y - k), row_at(y + k), along_y[to_size(k)], width, to);
    }
  });
}

// Guides and planes, [y][guide or plane][x], with reflected pixels left and right.
struct Padded {
  int pad = 0;
  std::size_t stride = 0;  // between planes of one row
  std::size_t count = 0;   // of guides and planes
  std::vector<float> values;

  const float* row(int y) const {
    return values.data() + to_size(y) * count * stride + to_size(pad);
  }
};

void copy_padded(const std::vector<float>& planes, int plane_count, int width, int height,
                 double scale, std::size_t first, Padded& padded) {
  over_rows(height, 16, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (std::size_t p = 0; p < to_size(plane_count); ++p) {
        const float* from = planes.data() + (p * to_size(height) + to_size(y)) * to_size(width);
        float* to = padded.values.data() + (to_size(y) * padded.count + first + p) * padded.stride;
        for (int x = -padded.pad; x < width + padded.pad; ++x)
          to[x + padded.pad] =
              static_cast<float>(scale * static_cast<double>(from[reflect(x, width)]));
      }
  });
}

// Taps along x: offsets within the padding, and the exponents of the spatial weight in base 2.
struct Taps {
  int step = 1, reach = 0;  // pixels from tap to tap, taps to each side
  std::vector<int> offsets;
  std::vector<float> log_weights;
};

double log_weight(int offset, double sigma_px) {
  const double x = offset != 0 ? offset / sigma_px : 0.0;
  return -0.5 * x * x / std::log(2.0);
}

Taps make_taps(double sigma_px, int width) {
  Taps taps;
  const int radius = window_radius(sigma_px);
  taps.step = std::max(1, (radius + max_steps - 1) / max_steps);
  taps.reach = radius / taps.step;
  for (int k = -taps.reach; k <= taps.reach; ++k) {
    const int x = k * taps.step, period = 2 * width;
    const int around = (((x + width) % period) + period) % period - width;
    taps.offsets.push_back(radius <= width ? x : around);
    taps.log_weights.push_back(static_cast<float>(log_weight(x, sigma_px)));
  }
  return taps;
}

struct Bilateral {
  const Padded& padded;
  const Taps& taps;
  int guides, planes, width, height;
  double sigma_px;
};

// One chunk of a row: pixels x to x + bilateral_chunk.
void filter_chunk(const Bilateral& filter, int x, int y, std::vector<float>& work,
                  std::vector<float>& log_weights, std::vector<float>& sums) {
  const Taps& taps = filter.taps;
  std::fill(sums.begin(), sums.end(), 0.0f);
  for (int k = -taps.reach; k <= taps.reach; ++k) {
    const int dy = k * taps.step;
    const auto along_y = static_cast<float>(log_weight(dy, filter.sigma_px));
    for (std::size_t t = 0; t < log_weights.size(); ++t)
      log_weights[t] = taps.log_weights[t] + along_y;
    add_bilateral_row({.centre = filter.padded.row(y) + x,
                       .row = filter.padded.row(reflect(y + dy, filter.height)) + x,
                       .stride = static_cast<std::ptrdiff_t>(filter.padded.stride),
                       .guides = filter.guides,
                       .planes = filter.planes,
                       .offsets = taps.offsets.data(),
                       .log_weights = log_weights.data(),
                       .taps = static_cast<int>(taps.offsets.size())},
                      work.data(), sums.data());
  }
}

// Rows [begin, end): chunk columns outside, so that the rows of the window stay in the cache.
void filter_rows(const Bilateral& filter, int begin, int end, const std::vector<float>& in,
                 std::vector<float>& out) {
  std::vector<float> sums(to_size(filter.planes + 1) * bilateral_chunk), work(sums.size());
  std::vector<float> log_weights(filter.taps.log_weights.size());
  for (int x = 0; x < filter.width; x += bilateral_chunk)
    for (int y = begin; y < end; ++y) {
      filter_chunk(filter, x, y, work, log_weights, sums);
      const int count = std::min(bilateral_chunk, filter.width - x);
      for (int p = 0; p < filter.planes; ++p) {
        const float* sum = sums.data() + to_size(p + 1) * bilateral_chunk;
        const std::size_t at = to_size(p * filter.height + y) * to_size(filter.width) + to_size(x);
        for (int i = 0; i < count; ++i)
          out[at + to_size(i)] = in[at + to_size(i)] + sum[i] / sums[to_size(i)];
      }
    }
}

// Brings guides to units in which the exponent of the range weight is the squared distance, base 2;
// bounded so that the smallest sigma_range does not overflow.
double guide_scale(const std::vector<float>& guide, double sigma_range) {
  double largest = 1e-30;
  for (const float value : guide) largest = std::max(largest, std::abs(static_cast<double>(value)));
  return std::min(std::sqrt(0.5 / std::log(2.0)) / sigma_range, 1e18 / largest);
}

}  // namespace

void gaussian_filter(const float* in, int width, int height, double sigma_px, float* out) {
  check_sigma(sigma_px, width, height);
  check_values(in, "values", 1, width, height);
  smooth_plane(in, width, height, sigma_px, out);
}

std::vector<float> bilateral_filter(const std::vector<float>& planes, int plane_count,
                                    const std::vector<float>& guide, int guide_count, int width,
                                    int height, double sigma_px, double sigma_range) {
  check_sigma(sigma_px, width, height);
  if (!(sigma_range > 0 && sigma_range <= 1e300))
    throw Error{{.place = "sigma-range",
                 .expected = "a number > 0",
                 .found = fmt::format("{}", sigma_range)}};
  const std::size_t pixels = to_size(width) * to_size(height);
  PARIAN_CHECK(plane_count > 0 && guide_count > 0);
  PARIAN_CHECK_EQ(planes.size(), pixels * to_size(plane_count));
  PARIAN_CHECK_EQ(guide.size(), pixels * to_size(guide_count));
  check_values(planes.data(), "values", plane_count, width, height);
  check_values(guide.data(), "guide", guide_count, width, height);

  const Taps taps = make_taps(sigma_px, width);
  Padded padded;
  padded.pad = std::min(window_radius(sigma_px), width);
  padded.stride =
      to_size((width + bilateral_chunk - 1) / bilateral_chunk * bilateral_chunk + 2 * padded.pad);
  padded.count = to_size(guide_count) + to_size(plane_count);
  padded.values.assign(to_size(height) * padded.count * padded.stride, 0.0f);
  const double scale = guide_scale(guide, sigma_range);
  copy_padded(guide, guide_count, width, height, scale, 0, padded);
  copy_padded(planes, plane_count, width, height, 1, to_size(guide_count), padded);

  std::vector<float> out(planes.size());
  const Bilateral filter{padded, taps, guide_count, plane_count, width, height, sigma_px};
  over_rows(height, 8, [&](int begin, int end) { filter_rows(filter, begin, end, planes, out); });
  return out;
}

std::vector<float> unsharp(const std::vector<float>& planes, int plane_count, int width, int height,
                           double sigma_px, double amount) {
  check_sigma(sigma_px, width, height);
  if (!(std::abs(amount) <= 1e6))
    throw Error{{.place = "amount",
                 .expected = "a number in [-1e6, 1e6]",
                 .found = fmt::format("{}", amount)}};
  const std::size_t pixels = to_size(width) * to_size(height);
  PARIAN_CHECK(plane_count > 0);
  PARIAN_CHECK_EQ(planes.size(), pixels * to_size(plane_count));
  check_values(planes.data(), "values", plane_count, width, height);
  std::vector<float> out = planes, smooth(pixels);
  for (std::size_t p = 0; p < to_size(plane_count); ++p) {
    smooth_plane(planes.data() + p * pixels, width, height, sigma_px, smooth.data());
    for (std::size_t y = 0; y < to_size(height); ++y) {
      float* row = out.data() + p * pixels + y * to_size(width);
      sharpen_row(row, smooth.data() + y * to_size(width), static_cast<float>(amount), width, row);
    }
  }
  return out;
}

}  // namespace parian

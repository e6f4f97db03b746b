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

// A value is the sum of taps[j] times the sample `first + j` beside it.
struct Kernel {
  int first = 0;
  std::vector<double> taps;
};

// Which samples of a line make sample i of a longer or shorter one: a tent that is as wide as two
// samples of the coarser, so that of the same line each is itself. Ends are repeated.
Kernel tent_kernel(int i, int from, int to) {
  const double ratio = static_cast<double>(from) / to;
  const double center = (i + 0.5) * ratio - 0.5, radius = std::max(1.0, ratio);
  Kernel kernel{.first = static_cast<int>(std::floor(center - radius)) + 1, .taps = {}};
  double sum = 0;
  for (int k = kernel.first; k < center + radius; ++k) {
    kernel.taps.push_back(1 - std::abs(k - center) / radius);
    sum += kernel.taps.back();
  }
  for (double& tap : kernel.taps) tap /= sum;
  return kernel;
}

// Lines along x of another length, [y][x].
std::vector<double> stretch_lines(const std::vector<double>& values, int from, int to) {
  const std::size_t lines = values.size() / static_cast<std::size_t>(from);
  std::vector<double> stretched(lines * static_cast<std::size_t>(to));
  for (int i = 0; i < to; ++i) {
    const Kernel kernel = tent_kernel(i, from, to);
    for (std::size_t line = 0; line < lines; ++line) {
      double sum = 0;
      for (std::size_t j = 0; j < kernel.taps.size(); ++j) {
        const int at = std::clamp(kernel.first + static_cast<int>(j), 0, from - 1);
        sum += kernel.taps[j] *
               values[line * static_cast<std::size_t>(from) + static_cast<std::size_t>(at)];
      }
      stretched[line * static_cast<std::size_t>(to) + static_cast<std::size_t>(i)] = sum;
    }
  }
  return stretched;
}

std::vector<double> transpose(const std::vector<double>& values, int width) {
  const auto columns = static_cast<std::size_t>(width);
  const std::size_t rows = values.size() / columns;
  std::vector<double> turned(values.size());
  for (std::size_t i = 0; i < values.size(); ++i)
    turned[(i % columns) * rows + i / columns] = values[i];
  return turned;
}

Mask stretch(const Mask& mask, int width, int height) {
  const std::vector<double> values(mask.weight.begin(), mask.weight.end());
  const std::vector<double> wide = stretch_lines(values, mask.width, width);
  const std::vector<double> turned = stretch_lines(transpose(wide, width), mask.height, height);
  const std::vector<double> upright = transpose(turned, height);
  Mask stretched{width, height, {}};
  stretched.weight.reserve(upright.size());
  for (const double weight : upright)
    stretched.weight.push_back(std::clamp(static_cast<float>(weight), 0.0f, 1.0f));
  return stretched;
}

// A Gaussian for lines of `size` samples. Mirrored lines repeat after 2 size samples, and so taps
// beyond are folded onto these.
Kernel gaussian_kernel(double sigma, int size) {
  sigma = std::min(sigma, 2.0 * size);  // where every value is the mean to 2e-6
  const int reach = std::max(1, static_cast<int>(std::ceil(4 * sigma)));
  const int first = -std::min(reach, size), count = std::min(2 * reach + 1, 2 * size);
  Kernel kernel{first, std::vector<double>(static_cast<std::size_t>(count))};
  double sum = 0;
  for (int j = -reach; j <= reach; ++j) {
    const double value = std::exp(-0.5 * (j / sigma) * (j / sigma));
    const int place = (j - first) % (2 * size);
    kernel.taps[static_cast<std::size_t>(place < 0 ? place + 2 * size : place)] += value;
    sum += value;
  }
  for (double& value : kernel.taps) value /= sum;
  return kernel;
}

PARIAN_HOT void add_scaled(const double* PARIAN_RESTRICT from, double factor,
                           double* PARIAN_RESTRICT to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) to[i] += factor * from[i];
}

void blur_row(const float* in, double* out, int width, const Kernel& kernel) {
  const auto count = static_cast<std::size_t>(width);
  std::vector<double> mirrored(count + kernel.taps.size());
  for (std::size_t i = 0; i < mirrored.size(); ++i)
    mirrored[i] = static_cast<double>(
        in[static_cast<std::size_t>(reflect(static_cast<int>(i) + kernel.first, width))]);
  for (std::size_t j = 0; j < kernel.taps.size(); ++j)
    add_scaled(&mirrored[j], kernel.taps[j], out, count);
}

PARIAN_HOT void raise_row(const float* PARIAN_RESTRICT from, float factor,
                          float* PARIAN_RESTRICT to, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float value = factor * from[i];
    to[i] = value > to[i] ? value : to[i];
  }
}

PARIAN_HOT void raise_row_by_two(const float* a, const float* b, float* PARIAN_RESTRICT to,
                                 std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float value = a[i] > b[i] ? a[i] : b[i];
    to[i] = value > to[i] ? value : to[i];
  }
}

// Rows with `pad` zeros on either side, where each value is the largest of the `span` samples from
// its own on.
struct MaxRows {
  std::size_t width = 0, pad = 0, stride = 0, span = 1;
  std::vector<float> values;
  std::vector<unsigned char> is_zero;  // of each row

  const float* row(std::size_t y) const { return &values[y * stride + pad]; }
};

MaxRows make_max_rows(const Mask& mask, int pad) {
  MaxRows rows{.width = static_cast<std::size_t>(mask.width), .pad = static_cast<std::size_t>(pad)};
  rows.stride = rows.width + 2 * rows.pad;
  rows.values.resize(rows.stride * static_cast<std::size_t>(mask.height));
  rows.is_zero.resize(static_cast<std::size_t>(mask.height));
  for (std::size_t y = 0; y < rows.is_zero.size(); ++y) {
    const float* from = &mask.weight[y * rows.width];
    std::copy_n(from, rows.width, &rows.values[y * rows.stride + rows.pad]);
    rows.is_zero[y] = std::all_of(from, from + rows.width, [](float w) { return w == 0; });
  }
  return rows;
}

void double_span(MaxRows& rows) {
  parallel_for(rows.is_zero.size(), [&](std::size_t y) {
    float* row = &rows.values[y * rows.stride];
    for (std::size_t i = 0; i + rows.span < rows.stride; ++i)
      row[i] = std::max(row[i], row[i + rows.span]);
  });
  rows.span *= 2;
}

// What a disc covers in the rows `dy` above and below its centre: whole pixels up to `half` beside
// it, then a rim covered in part.
struct Chord {
  int half = -1;  // -1: none is whole
  std::vector<float> rim;
};

// A pixel's own edge is half a pixel from its centre, and so is its neighbour's: the part covered
// is 1 up to a distance of the radius, then falls to 0 over a pixel.
std::vector<Chord> make_chords(double radius, int max_dx, int max_dy) {
  std::vector<Chord> chords;
  for (int dy = 0; dy <= max_dy && dy < radius + 1; ++dy) {
    Chord chord;
    for (int dx = 0; dx <= max_dx; ++dx) {
      const double part = radius - std::hypot(dx, dy) + 1;
      if (part <= 0) break;
      if (part >= 1)
        chord.half = dx;
      else
        chord.rim.push_back(static_cast<float>(part));
    }
    chords.push_back(std::move(chord));
  }
  return chords;
}

// Raises a row by the parts of one chord that the span of `rows` serves: the rim by single samples,
// the whole pixels by two overlapping spans.
void raise_by_chord(const MaxRows& rows, const float* from, const Chord& chord, float* to) {
  if (rows.span == 1) {
    const int first = chord.half + 1;
    for (std::size_t i = 0; i < chord.rim.size(); ++i) {
      const int dx = first + static_cast<int>(i);
      raise_row(from + dx, chord.rim[i], to, rows.width);
      if (dx > 0) raise_row(from - dx, chord.rim[i], to, rows.width);
    }
  }
  const int span = static_cast<int>(rows.span), whole = 2 * chord.half + 1;
  if (whole >= span && whole < 2 * span)
    raise_row_by_two(from - chord.half, from + chord.half + 1 - span, to, rows.width);
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
  Mask mask{image.width, image.height, {}};
  mask.weight.reserve(mask.pixels());
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const float value = image.channels >= 3 ? luminance(at(image, x, y, 0), at(image, x, y, 1),
                                                          at(image, x, y, 2))
                                              : at(image, x, y, 0);
      if (!std::isfinite(value))
        throw Error({.place = fmt::format("pixel ({}, {})", x, y),
                     .expected = "a finite value",
                     .found = std::isnan(value) ? "NaN" : fmt::format("{}", value)});
      mask.weight.push_back(std::clamp(value, 0.0f, 1.0f));
    }
  return image.width == width && image.height == height ? mask : stretch(mask, width, height);
}

Mask threshold(const double* values, int width, int height, double low, double high,
               double softness) {
  Mask mask{width, height, {}};
  mask.weight.reserve(mask.pixels());
  for (std::size_t i = 0; i < mask.pixels(); ++i) {
    // NaN, of values that are NaN, counts as far beyond.
    const double beyond = std::max({low - values[i], values[i] - high, 0.0});
    const double t = softness > 0 ? std::min(1.0, beyond / softness) : (beyond <= 0 ? 0.0 : 1.0);
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
  PARIAN_CHECK(std::isfinite(sigma_px));
  if (sigma_px <= 0 || mask.weight.empty()) return mask;
  const auto width = static_cast<std::size_t>(mask.width);
  const auto height = static_cast<std::size_t>(mask.height);
  const Kernel across = gaussian_kernel(sigma_px, mask.width);
  const Kernel down = gaussian_kernel(sigma_px, mask.height);
  std::vector<double> rows(mask.pixels());
  parallel_for(height, [&](std::size_t y) {
    blur_row(&mask.weight[y * width], &rows[y * width], mask.width, across);
  });
  Mask blurred = mask;
  parallel_for(height, [&](std::size_t y) {
    std::vector<double> sum(width);
    for (std::size_t j = 0; j < down.taps.size(); ++j) {
      const int from = reflect(static_cast<int>(y + j) + down.first, mask.height);
      add_scaled(&rows[static_cast<std::size_t>(from) * width], down.taps[j], sum.data(), width);
    }
    for (std::size_t x = 0; x < width; ++x)
      blurred.weight[y * width + x] = static_cast<float>(std::min(1.0, sum[x]));
  });
  return blurred;
}

Mask grow(const Mask& mask, double radius_px) {
  PARIAN_CHECK(std::isfinite(radius_px));
  if (radius_px < 0) return invert(grow(invert(mask), -radius_px));
  if (radius_px == 0 || mask.weight.empty()) return mask;
  const double radius =
      std::min(radius_px, std::hypot(static_cast<double>(mask.width), mask.height));
  const std::vector<Chord> chords = make_chords(radius, mask.width - 1, mask.height - 1);
  MaxRows rows = make_max_rows(mask, mask.width - 1);
  Mask grown = mask;
  const auto widest = static_cast<std::size_t>(2 * chords[0].half + 1);
  for (;;) {
    parallel_for(rows.is_zero.size(), [&](std::size_t y) {
      for (std::size_t dy = 0; dy < chords.size(); ++dy)
        for (const std::size_t from : {y - dy, y + dy})  // above the map wraps to beyond its end
          if (from < rows.is_zero.size() && rows.is_zero[from] == 0)
            raise_by_chord(rows, rows.row(from), chords[dy], &grown.weight[y * rows.width]);
    });
    if (2 * rows.span > widest) break;
    double_span(rows);
  }
  return grown;
}

}  // namespace parian

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "compress/assign.h"
#include "compress/mixture_kernels.h"
#include "compress/screen_internal.h"

namespace parian {
namespace {

constexpr std::size_t sample_limit = 16384;  // pixels that k-means looks at,
constexpr std::size_t sample_per_base = 64;  // or as many as this asks for
constexpr int lloyd_steps = 6;

float squared_distance(const float* a, const float* b, std::size_t stride) {
  float sum = 0;
  for (std::size_t i = 0; i < stride; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

// k-means++ (Arthur and Vassilvitskii 2007): each next centre with probability by squared distance.
std::vector<std::size_t> pick_centres(const AlignedVector<float>& white, std::size_t stride,
                                      std::size_t centres, Rng& rng) {
  const std::size_t count = white.size() / stride;
  std::vector<float> distance(count, 1e30f);
  std::vector<std::size_t> picked;
  std::size_t next = std::min(
      count - 1, static_cast<std::size_t>(sample_uniform(rng) * static_cast<double>(count)));
  while (true) {
    picked.push_back(next);
    if (picked.size() == centres) return picked;
    parallel_for_blocks(count, 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        distance[i] = std::min(distance[i],
                               squared_distance(&white[i * stride], &white[next * stride], stride));
    });
    double total = 0;
    for (float value : distance) total += static_cast<double>(value);
    double left = sample_uniform(rng) * total;
    next = count - 1;
    for (std::size_t i = 0; i < count; ++i) {
      left -= static_cast<double>(distance[i]);
      if (left < 0) {
        next = i;
        break;
      }
    }
  }
}

// Nearest base of each row in the common metric.
std::vector<std::uint16_t> nearest_bases(const CommonMetric& common,
                                         const AlignedVector<float>& bases,
                                         const AlignedVector<float>& rows) {
  const std::size_t stride = common.shape.stride(), count = rows.size() / stride;
  const ScreenedBases screened = screen_bases(common, bases);
  std::vector<std::uint16_t> nearest(count);
  parallel_for_blocks(count, 64, [&](std::size_t begin, std::size_t end) {
    AlignedVector<float> white(stride), product(screened.padded);
    for (std::size_t x = begin; x < end; ++x) {
      whiten(common, &rows[x * stride], white.data());
      project_row(screened.columns.data(), stride, screened.padded, white.data(), product.data());
      std::size_t best = 0;
      float lowest = 1e30f;
      for (std::size_t j = 0; j < screened.count; ++j) {
        const float value = screened.norm[j] - 2 * product[j];
        if (value < lowest) {
          lowest = value;
          best = j;
        }
      }
      nearest[x] = static_cast<std::uint16_t>(best);
    }
  });
  return nearest;
}

// Every base becomes the mean of its rows; those without rows stay.
void move_bases(const AlignedVector<float>& rows, const std::vector<std::uint16_t>& nearest,
                std::size_t stride, AlignedVector<float>& bases) {
  std::vector<double> sum(bases.size(), 0.0), count(bases.size() / stride, 0.0);
  for (std::size_t x = 0; x < nearest.size(); ++x) {
    count[nearest[x]] += 1;
    for (std::size_t i = 0; i < stride; ++i)
      sum[nearest[x] * stride + i] += static_cast<double>(rows[x * stride + i]);
  }
  for (std::size_t j = 0; j < count.size(); ++j)
    if (count[j] > 0)
      for (std::size_t i = 0; i < stride; ++i)
        bases[j * stride + i] = static_cast<float>(sum[j * stride + i] / count[j]);
}

AlignedVector<float> pick_rows(const AlignedVector<float>& rows, std::size_t stride,
                               const std::vector<std::size_t>& picked) {
  AlignedVector<float> some(picked.size() * stride);
  for (std::size_t i = 0; i < picked.size(); ++i)
    std::copy_n(&rows[picked[i] * stride], stride, &some[i * stride]);
  return some;
}

}  // namespace

Mixture start_mixture(const LocalMetric& metric, const AlignedVector<float>& target,
                      std::size_t bases, std::uint64_t seed) {
  const std::size_t stride = metric.shape.stride(), pixels = metric.shape.pixels;
  Rng rng = make_rng(seed);
  const CommonMetric common = make_common_metric(metric, target);
  std::vector<std::size_t> picked(
      std::min(pixels, std::max(sample_limit, bases * sample_per_base)));
  const double step = static_cast<double>(pixels) / static_cast<double>(picked.size());
  for (std::size_t i = 0; i < picked.size(); ++i)  // one from each of equal parts
    picked[i] =
        std::min(pixels - 1,
                 static_cast<std::size_t>((static_cast<double>(i) + sample_uniform(rng)) * step));
  const AlignedVector<float> sample = pick_rows(target, stride, picked);
  AlignedVector<float> white(sample.size());
  for (std::size_t i = 0; i < picked.size(); ++i)
    whiten(common, &sample[i * stride], &white[i * stride]);

  Mixture mixture;
  mixture.shape = metric.shape;
  mixture.per_pixel = 1;
  mixture.bases = pick_rows(sample, stride, pick_centres(white, stride, bases, rng));
  for (int i = 0; i < lloyd_steps; ++i)
    move_bases(sample, nearest_bases(common, mixture.bases, sample), stride, mixture.bases);
  mixture.index = nearest_bases(common, mixture.bases, target);
  mixture.weight.assign(pixels, 1.0f);
  return mixture;
}

}  // namespace parian

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "compress/mixture_kernels.h"
#include "compress/screen_internal.h"

namespace parian {
namespace {

std::vector<double> mean_row(const RowShape& shape, const AlignedVector<float>& rows) {
  const std::size_t stride = shape.stride(), count = rows.size() / stride;
  std::vector<double> mean(stride, 0.0);
  for (std::size_t x = 0; x < count; ++x)
    for (std::size_t i = 0; i < stride; ++i) mean[i] += static_cast<double>(rows[x * stride + i]);
  for (double& value : mean) value /= static_cast<double>(std::max<std::size_t>(1, count));
  return mean;
}

}  // namespace

CommonMetric make_common_metric(const LocalMetric& metric, const AlignedVector<float>& rows) {
  const std::size_t stride = metric.shape.stride();
  std::vector<double> d = mean_row(metric.shape, metric.diagonal);
  const std::vector<double> o = mean_row(metric.shape, metric.coupling);
  const std::vector<double> centre = mean_row(metric.shape, rows);
  const double largest = *std::max_element(d.begin(), d.end());
  CommonMetric common{metric.shape,
                      std::vector<float>(stride),
                      std::vector<float>(stride),
                      {centre.begin(), centre.end()}};
  for (std::size_t i = 0; i < stride; ++i) {
    const double root = std::sqrt(std::max(d[i], 1e-9 * largest));
    common.diagonal[i] = static_cast<float>(d[i] > 0 ? root : 0);
    if (i + 1 == stride || d[i] <= 0) continue;
    const double next = o[i] / root;
    common.next[i] = static_cast<float>(next);
    d[i + 1] -= next * next;
  }
  return common;
}

void whiten(const CommonMetric& common, const float* row, float* out) {
  const std::size_t stride = common.shape.stride();
  for (std::size_t i = 0; i < stride; ++i) {
    out[i] = common.diagonal[i] * (row[i] - common.centre[i]);
    if (i + 1 < stride) out[i] += common.next[i] * (row[i + 1] - common.centre[i + 1]);
  }
}

ScreenedBases screen_bases(const CommonMetric& common, const AlignedVector<float>& bases) {
  const std::size_t stride = common.shape.stride();
  ScreenedBases screened;
  screened.count = bases.size() / stride;
  screened.padded = (screened.count + 31) / 32 * 32;
  const std::size_t padded = screened.padded;
  screened.columns.assign(stride * padded, 0.0f);
  screened.norm.assign(padded, 1e30f);
  AlignedVector<float> rows(screened.count * stride);
  for (std::size_t j = 0; j < screened.count; ++j) {
    float* row = &rows[j * stride];
    whiten(common, &bases[j * stride], row);
    double norm = 0;
    for (std::size_t i = 0; i < stride; ++i) {
      screened.columns[i * padded + j] = row[i];
      norm += static_cast<double>(row[i]) * static_cast<double>(row[i]);
    }
    screened.norm[j] = static_cast<float>(norm);
  }
  if (screened.count > max_gram_bases) return screened;
  screened.gram.resize(padded * padded);
  parallel_for(screened.count, [&](std::size_t j) {
    project_row(screened.columns.data(), stride, padded, &rows[j * stride],
                &screened.gram[j * padded]);
  });
  return screened;
}

}  // namespace parian

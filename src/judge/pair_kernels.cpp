#include "judge/pair_kernels.h"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <utility>

#include "base/hot.h"

namespace parian {

PARIAN_HOT void widen_measured(const float* PARIAN_RESTRICT values, std::size_t count,
                               double* PARIAN_RESTRICT wide) {
  for (std::size_t i = 0; i < count; ++i)
    wide[i] = values[i] == values[i] ? static_cast<double>(values[i]) : 0.0;
}

PARIAN_HOT PairCounts widen_compared(const float* PARIAN_RESTRICT data,
                                     const float* PARIAN_RESTRICT model, std::size_t count,
                                     double* PARIAN_RESTRICT wide_data,
                                     double* PARIAN_RESTRICT wide_model) {
  int compared = 0, measured = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float d = data[i], m = model[i];
    const bool has_data = d == d, has_both = has_data & (m == m);
    wide_data[i] = has_both ? static_cast<double>(d) : 0.0;
    wide_model[i] = has_both ? static_cast<double>(m) : 0.0;
    compared += has_both ? 1 : 0;
    measured += has_data ? 1 : 0;
  }
  return {static_cast<std::size_t>(compared), static_cast<std::size_t>(measured - compared)};
}

PARIAN_HOT void add_errors(const double* PARIAN_RESTRICT data, const double* PARIAN_RESTRICT model,
                           std::size_t count, double* PARIAN_RESTRICT error2,
                           double* PARIAN_RESTRICT data2, double* PARIAN_RESTRICT error1,
                           double* PARIAN_RESTRICT data1) {
  for (std::size_t i = 0; i < count; ++i) {
    const double difference = model[i] - data[i];
    error2[i] += difference * difference;
    data2[i] += data[i] * data[i];
    error1[i] += std::fabs(difference);
    data1[i] += std::fabs(data[i]);
  }
}

PARIAN_HOT void add_values(const double* PARIAN_RESTRICT values, std::size_t count,
                           double* PARIAN_RESTRICT sum) {
  for (std::size_t i = 0; i < count; ++i) sum[i] += values[i];
}

PARIAN_HOT void add_lit(const double* PARIAN_RESTRICT values, const float* PARIAN_RESTRICT light,
                        std::size_t count, double* PARIAN_RESTRICT sum) {
  for (std::size_t i = 0; i < count; ++i) sum[i] += values[i] * static_cast<double>(light[i]);
}

LightPlane make_light_plane(std::vector<float> values, std::size_t width) {
  LightPlane plane{width, std::move(values), {}, {}};
  for (std::size_t row = 0; row < plane.values.size(); row += width) {
    const float* light = plane.values.data() + row;
    std::size_t begin = 0, end = width;
    while (end > 0 && light[end - 1] == 0) --end;
    while (begin < end && light[begin] == 0) ++begin;
    plane.begin.push_back(begin);
    plane.end.push_back(end);
  }
  return plane;
}

void add_lit(const double* values, const LightPlane& light, std::size_t lit_from, std::size_t count,
             double* sum) {
  const std::size_t row = lit_from / light.width, x = lit_from % light.width;
  const std::size_t begin = std::max(x, light.begin[row]);
  const std::size_t end = std::min(x + count, light.end[row]);
  if (begin >= end) return;
  add_lit(values + (begin - x), &light.values[lit_from + (begin - x)], end - begin,
          sum + (begin - x));
}

PARIAN_HOT std::size_t make_ratios(const float* PARIAN_RESTRICT data,
                                   const float* PARIAN_RESTRICT model, std::size_t count,
                                   double floor, float* PARIAN_RESTRICT ratios) {
  int counted = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const float d = data[i], m = model[i];
    const bool counts = (static_cast<double>(d) > floor) & (m == m);
    const float bounded_d = d > FLT_MIN ? d : FLT_MIN, bounded_m = m > FLT_MIN ? m : FLT_MIN;
    const float ratio = (counts ? bounded_m : 1.0f) / (counts ? bounded_d : 1.0f);
    const float not_small = ratio > FLT_MIN ? ratio : FLT_MIN;
    ratios[i] = not_small < FLT_MAX ? not_small : FLT_MAX;
    counted += counts ? 1 : 0;
  }
  return static_cast<std::size_t>(counted);
}

PARIAN_HOT void add_squares(const float* PARIAN_RESTRICT values, std::size_t count, double weight,
                            double* PARIAN_RESTRICT sum) {
  for (std::size_t i = 0; i < count; ++i) {
    const double value = values[i];
    sum[i] += weight * (value * value);
  }
}

}  // namespace parian

#include "edit/shape_planes.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "edit/shape_kernels.h"

namespace parian {

KnotTable make_knot_table(const std::vector<double>& knots_mm) {
  KnotTable table;
  table.radius = knots_mm;
  table.radius_float.assign(knots_mm.begin(), knots_mm.end());
  for (std::size_t k = 1; k < knots_mm.size(); ++k)
    table.inverse_length.push_back(static_cast<float>(1 / (knots_mm[k] - knots_mm[k - 1])));
  return table;
}

void find_tails(const KnotTable& knots, const float* rows, const double* range_mm,
                ShapeTails* tails) {
  const std::size_t n = knots.radius.size() - 1;
  const float* end = rows + n * shape_lanes;
  finish_tails(end - shape_lanes, end, range_mm, knots.radius[n], knots.inverse_length[n - 1],
               tails);
}

ShapeRows view_rows(const KnotTable& knots, const float* rows, const ShapeTails& tails) {
  return {.value = rows,
          .radius = knots.radius_float.data(),
          .inverse_length = knots.inverse_length.data(),
          .tail_slope = tails.slope,
          .support = tails.support,
          .knots = knots.radius.size()};
}

namespace {

// Rows of a block: where they lie, or a copy in which idle lanes repeat the last one.
class BlockRows {
 public:
  BlockRows(const float* rows, std::size_t stride, std::size_t count, std::size_t knots)
      : rows_(rows), stride_(stride) {
    if (count == shape_lanes) return;
    copy_ = AlignedVector<float>(knots * shape_lanes);
    for (std::size_t k = 0; k < knots; ++k) {
      float* row = &copy_[k * shape_lanes];
      std::copy_n(rows + k * stride, count, row);
      std::fill(row + count, row + shape_lanes, row[count - 1]);
    }
    rows_ = copy_.data();
    stride_ = shape_lanes;
  }
  const float* operator[](std::size_t k) const { return rows_ + k * stride_; }
  std::size_t stride() const { return stride_; }

 private:
  AlignedVector<float> copy_;
  const float* rows_;
  std::size_t stride_;
};

// alpha of a profile that falls through the level within its knots, as profile_range.
double find_range(const KnotTable& knots, const BlockRows& rows, std::size_t i, double level,
                  float segment) {
  const auto value = [&](std::size_t k) { return static_cast<double>(rows[k][i]); };
  // Floats may see the crossing one segment off: it is the last whose start lies above the level.
  auto k = static_cast<std::size_t>(std::max(0.0f, segment));
  while (k + 2 < knots.radius.size() && value(k + 1) > level) ++k;
  while (k > 0 && value(k) <= level) --k;
  return knots.radius[k] +
         (knots.radius[k + 1] - knots.radius[k]) * ((value(k) - level) / (value(k) - value(k + 1)));
}

}  // namespace

void measure_shapes(const KnotTable& knots, const float* log_value, std::size_t stride,
                    std::size_t count, double* albedo, double* range_mm) {
  const std::size_t n = knots.radius.size();
  const BlockRows rows(log_value, stride, count, n);
  ShapeCrossings crossings;
  find_crossings(rows[0], rows.stride(), n, &crossings);
  ShapeSums sums;
  sum_segments(rows[0], rows.stride(), knots.radius.data(), n, &sums);
  finish_shapes(rows[n - 2], rows[n - 1], knots.radius[n - 1],
                knots.radius[n - 1] - knots.radius[n - 2], &crossings, &sums);
  std::copy_n(sums.integral, count, albedo);
  for (std::size_t i = 0; i < count; ++i)
    range_mm[i] =
        sums.tail[i] > 0
            ? knots.radius[n - 1] + sums.tail[i]
            : find_range(knots, rows, i,
                         static_cast<double>(crossings.top[i]) + std::log(support_threshold),
                         crossings.segment[i]);
}

std::shared_ptr<const ShapePlanes> make_shape_planes(AlignedVector<float> log_profile,
                                                     const std::vector<double>& knots_mm,
                                                     std::size_t pixels, int channels) {
  const auto planes = std::make_shared<ShapePlanes>();
  planes->log_profile = std::move(log_profile);
  const std::size_t count = pixels * static_cast<std::size_t>(channels);
  planes->albedo.resize(count);
  planes->range_mm.resize(count);
  const KnotTable knots = make_knot_table(knots_mm);
  const std::size_t blocks = (pixels + shape_lanes - 1) / shape_lanes;
  const auto measure = [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b) {
      const std::size_t channel = b / blocks, first = b % blocks * shape_lanes;
      const std::size_t at = channel * pixels + first;
      measure_shapes(knots, &planes->log_profile[channel * knots_mm.size() * pixels + first],
                     pixels, std::min(shape_lanes, pixels - first), &planes->albedo[at],
                     &planes->range_mm[at]);
    }
  };
  parallel_for_blocks(blocks * static_cast<std::size_t>(channels), 16, measure);
  return planes;
}

}  // namespace parian

#include "edit/shape_edit.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "edit/reshape.h"
#include "edit/shape_kernels.h"
#include "math/isotonic.h"

namespace parian {
namespace {

using Points = std::vector<std::array<double, 2>>;

constexpr std::size_t samples = 4096;

double eval_points(const Points& points, double u) {
  if (u <= points.front()[0]) return points.front()[1];
  for (std::size_t i = 1; i < points.size(); ++i)
    if (u <= points[i][0]) {
      const double w = (u - points[i - 1][0]) / (points[i][0] - points[i - 1][0]);
      return (1 - w) * points[i - 1][1] + w * points[i][1];
    }
  return points.back()[1];
}

// At u = i / samples; the last entry serves u >= 1.
AlignedVector<float> sample_points(const Points& points, float neutral) {
  AlignedVector<float> values(samples + 1);
  for (std::size_t i = 0; i <= samples; ++i)
    values[i] =
        points.empty()
            ? neutral
            : static_cast<float>(eval_points(points, static_cast<double>(i) / double{samples}));
  return values;
}

void check_points(const Points& points, const char* name, double least) {
  if (points.size() > max_curve_points)
    throw Error({.place = name,
                 .expected = fmt::format("at most {} points", max_curve_points),
                 .found = fmt::format("{}", points.size())});
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [u, value] = points[i];
    if (!(u >= 0 && u <= 1) || (i > 0 && !(u > points[i - 1][0])))
      throw Error({.place = name,
                   .expected = "places u in [0, 1] that increase",
                   .found = fmt::format("{} as number {}", u, i)});
    if (!(value >= least && value <= 1000))
      throw Error({.place = name,
                   .expected = fmt::format("values in [{}, 1000]", least),
                   .found = fmt::format("{} as number {}", value, i)});
  }
}

}  // namespace

ParamList describe(ShapeEdit& edit) {
  return {{.name = "falloff",
           .help = "exponent of the shape: above 1 it falls faster near the centre",
           .target = &edit.falloff,
           .min = 0.05,
           .max = 20}};
}

void check(const ShapeEdit& edit) {
  check_points(edit.scale, "scale", 0);
  check_points(edit.offset, "offset", -1000);
}

void apply(const ShapeEdit& edit, EditState& state, const Mask& mask) {
  const AlignedVector<float> scale = sample_points(edit.scale, 1),
                             offset = sample_points(edit.offset, 0);
  const std::size_t knots = state.knots_mm.size();
  const auto make_rows = [&](const ShapeBlock& block, float* rows) {
    ShapeCurves curves{scale.data(),
                       edit.offset.empty() ? nullptr : offset.data(),
                       static_cast<int>(samples),
                       {},
                       {},
                       {}};
    for (std::size_t i = 0; i < shape_lanes; ++i) {
      curves.inverse_range[i] = static_cast<float>(1 / block.range_mm[i]);
      curves.exponent[i] = 1 + block.amount[i] * (static_cast<float>(edit.falloff) - 1);
    }
    fill_log_scales(block.range_mm, block.albedo, curves.shift);
    for (std::size_t k = 0; k < knots; ++k)
      bend_shape_row(&curves, static_cast<float>(state.knots_mm[k]), block.rows + k * shape_lanes,
                     block.rows, block.amount, rows + k * shape_lanes);
    make_rows_non_increasing(rows, knots);
  };
  reshape(state, mask.weight, make_rows);
}

std::size_t make_monotone(EditState& state, const Mask& mask) {
  const std::size_t knots = state.knots_mm.size(), pixels = state.pixels();
  std::vector<double> weights;  // r dr of each knot's hat, and a little at r = 0
  weights.reserve(knots);
  for (std::size_t k = 0; k < knots; ++k) {
    const double before = state.knots_mm[k == 0 ? 0 : k - 1];
    const double after = state.knots_mm[std::min(k + 1, knots - 1)];
    weights.push_back(std::max(state.knots_mm[k], 0.25 * state.knots_mm[1]) * (after - before));
  }
  std::atomic<std::size_t> changed{0};
  // Profiles that fall keep their bits: a block's rows are copied but for those that rise.
  const auto make_rows = [&](const ShapeBlock& block, float* rows) {
    std::copy_n(block.rows, knots * shape_lanes, rows);
    std::vector<double> values(knots);
    for (std::size_t i = 0; i < block.count; ++i) {
      if (!(block.amount[i] > 0)) continue;
      for (std::size_t k = 0; k < knots; ++k)
        values[k] = static_cast<double>(block.rows[k * shape_lanes + i]);
      if (!make_non_increasing(values, weights)) continue;
      ++changed;
      for (std::size_t k = 0; k < knots; ++k)
        rows[k * shape_lanes + i] = static_cast<float>(values[k]);
    }
  };
  // Only those pixels are touched at all of which a channel rises.
  std::vector<float> rising(pixels, 0.0f);
  for (std::size_t plane = 0; plane + 1 < knots * static_cast<std::size_t>(state.channels);
       ++plane) {
    if (plane % knots + 1 == knots) continue;
    const float* here = &state.shapes->log_profile[plane * pixels];
    for (std::size_t i = 0; i < pixels; ++i)
      if (here[pixels + i] > here[i] && mask.weight[i] > 0) rising[i] = 1;
  }
  if (std::all_of(rising.begin(), rising.end(), [](float r) { return r == 0; })) return 0;
  reshape(state, rising, make_rows);
  return changed;
}

}  // namespace parian

#include "edit/smooth.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/parallel.h"
#include "edit/filter.h"
#include "edit/profile_rows.h"
#include "edit/reshape.h"

namespace parian {
namespace {

constexpr std::size_t block = 4096;

std::vector<float> logs(const Plane& values) {
  std::vector<float> result(values.size());
  parallel_for_blocks(values.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) result[i] = static_cast<float>(std::log(values[i]));
  });
  return result;
}

struct Filter {
  const FilterParams& params;
  const EditState& state;
  std::vector<float> guide;  // of the bilateral filter
  int guides = 0;

  std::vector<float> run(const std::vector<float>& planes) const {
    const int count = static_cast<int>(planes.size() / state.pixels());
    const double sigma_px = params.sigma_mm / state.pixel_pitch_mm;
    switch (params.kind) {
      case FilterKind::unsharp:
        return unsharp(planes, count, state.width, state.height, sigma_px, params.amount);
      case FilterKind::bilateral:
        return bilateral_filter(planes, count, guide, guides, state.width, state.height, sigma_px,
                                params.range_sigma);
      case FilterKind::gaussian:
        break;
    }
    std::vector<float> filtered(planes.size());
    parallel_for(static_cast<std::size_t>(count), [&](std::size_t p) {
      gaussian_filter(&planes[p * state.pixels()], state.width, state.height, sigma_px,
                      &filtered[p * state.pixels()]);
    });
    return filtered;
  }
};

// before e^(mask (filtered - logs)): the same bits where the mask is 0.
Plane move_by(const EditState& state, const Plane& before, const std::vector<float>& from,
              const std::vector<float>& to, const Mask& mask) {
  Plane after(before.size());
  parallel_for_blocks(before.size(), block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      after[i] = before[i] * std::exp(static_cast<double>(mask.weight[i % state.pixels()]) *
                                      (static_cast<double>(to[i]) - static_cast<double>(from[i])));
  });
  return after;
}

void filter_shapes(const Filter& filter, EditState& state, const Mask& mask) {
  const std::size_t knots = state.knots_mm.size();
  const std::vector<float> rows = normalise_rows(state);
  const std::vector<float> filtered = filter.run(rows);
  reshape(state, mask.weight, [&](const ShapeBlock& at, float* out) {
    for (std::size_t k = 0; k < knots; ++k) {
      const std::size_t plane = static_cast<std::size_t>(at.channel) * knots + k;
      for (std::size_t i = 0; i < shape_lanes; ++i) {
        const std::size_t from = plane * state.pixels() + at.first + std::min(i, at.count - 1);
        out[k * shape_lanes + i] = rows[from] + at.amount[i] * (filtered[from] - rows[from]);
      }
    }
    make_rows_non_increasing(out, knots);
  });
}

}  // namespace

ParamList describe(FilterParams& params) {
  return {{.name = "kind",
           .help = "gaussian, bilateral or unsharp",
           .target = make_choice(params.kind, {"gaussian", "bilateral", "unsharp"})},
          {.name = "sigma-mm",
           .help = "standard deviation of the Gaussian",
           .target = &params.sigma_mm,
           .min = 0,
           .max = 1e6,
           .above_min = true,
           .unit = "mm"},
          {.name = "range-sigma",
           .help = "how much properties may differ, in logarithms, to be mixed (bilateral)",
           .target = &params.range_sigma,
           .min = 0,
           .max = 1e6,
           .above_min = true},
          {.name = "amount",
           .help = "how much is added of what the Gaussian removes (unsharp)",
           .target = &params.amount,
           .min = -1,
           .max = 100},
          {.name = "albedo", .help = "filter the albedo", .target = &params.albedo},
          {.name = "range", .help = "filter the range", .target = &params.range},
          {.name = "shape", .help = "filter the shape", .target = &params.shape}};
}

void apply(const FilterParams& params, EditState& state, const Mask& mask, EditReport& report) {
  PARIAN_CHECK_EQ(mask.weight.size(), state.pixels());
  const Plane albedo = albedo_plane(state), range = range_plane(state);
  const std::vector<float> log_albedo = logs(albedo), log_range = logs(range);
  Filter filter{params, state, {}, 0};
  if (params.kind == FilterKind::bilateral) {
    filter.guide = log_albedo;
    filter.guide.insert(filter.guide.end(), log_range.begin(), log_range.end());
    filter.guides = 2 * state.channels;
  }
  std::vector<float> planes;
  if (params.albedo) planes.insert(planes.end(), log_albedo.begin(), log_albedo.end());
  if (params.range) planes.insert(planes.end(), log_range.begin(), log_range.end());
  const std::vector<float> filtered = planes.empty() ? planes : filter.run(planes);
  const EditState before = state;
  std::vector<float> part;
  if (params.albedo) {
    part.assign(filtered.begin(), filtered.begin() + static_cast<std::ptrdiff_t>(albedo.size()));
    set_albedo(state, albedo, move_by(state, albedo, log_albedo, part, mask), report);
  }
  if (params.range) {
    part.assign(filtered.end() - static_cast<std::ptrdiff_t>(range.size()), filtered.end());
    set_range(state, range, move_by(state, range, log_range, part, mask), report);
  }
  if (params.shape) filter_shapes({params, before, filter.guide, filter.guides}, state, mask);
}

}  // namespace parian

#include "edit/blend.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/parallel.h"
#include "edit/reshape.h"
#include "edit/shape_kernels.h"

namespace parian {
namespace {

constexpr std::size_t block = 4096;

// What a block mixes in, lane by lane: rows on the state's knots, and their own albedo and range.
struct Source {
  AlignedVector<float> rows;
  alignas(64) double albedo[shape_lanes];
  alignas(64) double range_mm[shape_lanes];
  ShapeTails tails;                          // of the rows
  alignas(64) float log_scale[shape_lanes];  // ln S - ln P
};

void finish_source(const KnotTable& knots, Source& source) {
  find_tails(knots, source.rows.data(), source.range_mm, &source.tails);
  fill_log_scales(source.range_mm, source.albedo, source.log_scale);
}

// S' = (1 - w) S_d + w S_s at u = r_k / alpha', 1 / alpha' = (1 - w) / alpha_d + w / alpha_s: the
// knots of the mixture lie between those of both, in units of the range.
void mix_block(const KnotTable& knots, const ShapeBlock& target, const Source& source,
               double amount, float* rows) {
  const std::size_t n = knots.radius.size();
  alignas(64) float target_log_scale[shape_lanes];
  MixScales scales;
  fill_mix_scales(target.range_mm, source.range_mm, target.amount, amount, &scales);
  fill_log_scales(target.range_mm, target.albedo, target_log_scale);
  ShapeTails target_tails;
  find_tails(knots, target.rows, target.range_mm, &target_tails);
  float *const a = target.scratch, *const b = a + n * shape_lanes;
  sample_shapes(view_rows(knots, target.rows, target_tails), scales.first, a);
  sample_shapes(view_rows(knots, source.rows.data(), source.tails), scales.second, b);
  mix_shapes(a, target_log_scale, b, source.log_scale, scales.weight, n, rows);
  for (std::size_t i = 0; i < shape_lanes; ++i)
    if (scales.weight[i] == 1)
      for (std::size_t at = i; at < n * shape_lanes; at += shape_lanes) rows[at] = source.rows[at];
}

// before + amount mask (source - before), source(channel, pixel)
template <typename Get>
Plane mix_planes(const EditState& state, const Plane& before, const Mask& mask, double amount,
                 const Get& source) {
  Plane mixed(before.size());
  const std::size_t pixels = state.pixels(), blocks = (pixels + block - 1) / block;
  parallel_for(blocks * static_cast<std::size_t>(state.channels), [&](std::size_t b) {
    const std::size_t channel = b / blocks, first = b % blocks * block;
    const double* from = &before[channel * pixels];
    double* to = &mixed[channel * pixels];
    for (std::size_t i = first; i < std::min(first + block, pixels); ++i) {
      const double w = amount * static_cast<double>(mask.weight[i]);
      const double sum = (1 - w) * from[i] + w * source(channel, i);
      to[i] = w == 0 ? from[i] : sum;
    }
  });
  return mixed;
}

// get_albedo(channel, pixel), get_range(...): the source's properties there; fill(block, own): what
// the block mixes in, made in `own` where it is not there already.
template <typename GetAlbedo, typename GetRange, typename Fill>
void blend(const BlendAmounts& amounts, EditState& state, const Mask& mask, EditReport& report,
           const GetAlbedo& get_albedo, const GetRange& get_range, const Fill& fill) {
  PARIAN_CHECK_EQ(mask.weight.size(), state.pixels());
  if (amounts.albedo > 0) {
    const Plane before = albedo_plane(state);
    set_albedo(state, before, mix_planes(state, before, mask, amounts.albedo, get_albedo), report);
  }
  if (amounts.range > 0) {
    const Plane before = range_plane(state);
    set_range(state, before, mix_planes(state, before, mask, amounts.range, get_range), report);
  }
  if (!(amounts.shape > 0)) return;
  const KnotTable knots = make_knot_table(state.knots_mm);
  reshape(state, mask.weight, [&](const ShapeBlock& target, float* rows) {
    Source own;
    const Source* source = fill(target, own);
    mix_block(knots, target, *source, amounts.shape, rows);
  });
}

// The places of knots relative to the last one agree to rounding.
bool has_same_spacing(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k)
    if (std::abs(a[k] / a.back() - b[k] / b.back()) > 1e-9) return false;
  return true;
}

}  // namespace

ParamList describe(BlendAmounts& amounts) {
  const auto amount = [](const char* name, const char* help, double* target) {
    return Param{.name = name, .help = help, .target = target, .min = 0, .max = 1};
  };
  return {amount("albedo", "part of the source's albedo", &amounts.albedo),
          amount("range", "part of the source's range", &amounts.range),
          amount("shape", "part of the source's shape", &amounts.shape)};
}

EditState match_knots(const EditState& state, const std::vector<double>& knots_mm) {
  EditState matched = state;
  matched.knots_mm = knots_mm;
  const double stretch = state.knots_mm.back() / knots_mm.back();
  if (has_same_spacing(state.knots_mm, knots_mm)) {
    if (stretch == 1) return matched;
    matched.shapes =
        make_shape_planes(state.shapes->log_profile, knots_mm, state.pixels(), state.channels);
  } else {
    const std::size_t pixels = state.pixels(), n = knots_mm.size(), m = state.knots_mm.size();
    AlignedVector<float> rows(state.values() * n);
    parallel_for(n * static_cast<std::size_t>(state.channels), [&](std::size_t plane) {
      const std::size_t channel = plane / n, k = plane % n;
      const double r = std::min(knots_mm[k] * stretch, state.knots_mm.back());
      const auto upper = static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(
          std::upper_bound(state.knots_mm.begin(), state.knots_mm.end(), r) -
              state.knots_mm.begin(),
          1, static_cast<std::ptrdiff_t>(m) - 1));
      const auto w = static_cast<float>((r - state.knots_mm[upper - 1]) /
                                        (state.knots_mm[upper] - state.knots_mm[upper - 1]));
      const float* a = &state.shapes->log_profile[(channel * m + upper - 1) * pixels];
      const float* b = a + pixels;
      float* out = &rows[plane * pixels];
      for (std::size_t i = 0; i < pixels; ++i) out[i] = (1 - w) * a[i] + w * b[i];
    });
    matched.shapes = make_shape_planes(std::move(rows), knots_mm, pixels, state.channels);
  }
  set_properties(matched, albedo_plane(state), range_plane(state));
  return matched;
}

void apply(const BlendAmounts& amounts, const EditState& source,
           const std::vector<std::uint32_t>& source_pixel, EditState& state, const Mask& mask,
           EditReport& report) {
  PARIAN_CHECK(source_pixel.empty() || source_pixel.size() == state.pixels());
  PARIAN_CHECK(source.channels == state.channels || source.channels == 1);
  PARIAN_CHECK(has_same_spacing(source.knots_mm, state.knots_mm));
  const std::size_t n = state.knots_mm.size();
  const auto channel_of = [&](std::size_t channel) { return source.channels == 1 ? 0 : channel; };
  const auto index = [&](std::size_t channel, std::size_t pixel) {
    return channel_of(channel) * source.pixels() + (source_pixel.empty() ? 0 : source_pixel[pixel]);
  };
  const Plane albedo = albedo_plane(source), range = range_plane(source);
  const KnotTable knots = make_knot_table(state.knots_mm);
  const auto load = [&](std::size_t channel, const auto& pixel_at, Source& out) {
    out.rows = AlignedVector<float>(n * shape_lanes);
    for (std::size_t i = 0; i < shape_lanes; ++i) {
      const std::size_t pixel = pixel_at(i);
      out.albedo[i] = source.shapes->albedo[channel * source.pixels() + pixel];
      out.range_mm[i] = source.shapes->range_mm[channel * source.pixels() + pixel];
      for (std::size_t k = 0; k < n; ++k)
        out.rows[k * shape_lanes + i] =
            source.shapes->log_profile[(channel * n + k) * source.pixels() + pixel];
    }
    finish_source(knots, out);
  };
  std::vector<Source> same;  // of each channel, where all pixels take from one
  if (source_pixel.empty()) {
    same.resize(static_cast<std::size_t>(source.channels));
    for (std::size_t c = 0; c < same.size(); ++c)
      load(
          c, [](std::size_t) { return std::size_t{0}; }, same[c]);
  }
  const auto fill = [&](const ShapeBlock& target, Source& own) -> const Source* {
    const std::size_t channel = channel_of(static_cast<std::size_t>(target.channel));
    if (!same.empty()) return &same[channel];
    load(
        channel,
        [&](std::size_t i) -> std::size_t {
          return source_pixel[target.first + std::min(i, target.count - 1)];
        },
        own);
    return &own;
  };
  blend(
      amounts, state, mask, report,
      [&](std::size_t channel, std::size_t pixel) { return albedo[index(channel, pixel)]; },
      [&](std::size_t channel, std::size_t pixel) { return range[index(channel, pixel)]; }, fill);
}

}  // namespace parian

#include "edit/hallucinate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "edit/blend.h"
#include "edit/features.h"
#include "edit/geometry.h"
#include "edit/neighbours.h"
#include "image/color_spaces.h"
#include "judge/row_sums.h"
#include "material/material.h"

namespace parian {
namespace {

double value_of(const Image& image, std::size_t pixel, std::size_t channel) {
  const std::size_t c = image.channels >= 3 ? channel : 0;
  return static_cast<double>(image.values[pixel * static_cast<std::size_t>(image.channels) + c]);
}

std::size_t pixels_of(const Image& image) {
  return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

void check_pictures(const Image& photograph, const Image& guidance) {
  if (pixels_of(photograph) > max_photograph_pixels)
    throw Error({.place = "photograph",
                 .expected = fmt::format("at most {} pixels", max_photograph_pixels),
                 .found = fmt::format("{} x {}", photograph.width, photograph.height)});
  if (guidance.width != photograph.width || guidance.height != photograph.height)
    throw Error({.place = "guidance",
                 .expected = fmt::format("a picture of {} x {} pixels, as the photograph",
                                         photograph.width, photograph.height),
                 .found = fmt::format("{} x {}", guidance.width, guidance.height)});
  for (const Image* image : {&photograph, &guidance})
    for (float value : image->values)
      if (!std::isfinite(value))
        throw Error({.place = image == &photograph ? "photograph" : "guidance",
                     .expected = "finite values",
                     .found = fmt::format("{}", value)});
}

Features make_lab_features(const Image& image) {
  std::vector<float> values;
  values.reserve(3 * pixels_of(image));
  for (std::size_t i = 0; i < pixels_of(image); ++i)
    for (double value :
         linear_to_lab({value_of(image, i, 0), value_of(image, i, 1), value_of(image, i, 2)}))
      values.push_back(static_cast<float>(value));
  return make_features(image.width, image.height, 3, values);
}

// How much of each pin a pixel has, [pin][y][x], 1 together.
std::vector<Mask> propagate_pins(const HallucinateParams& params,
                                 const PropagateParams& propagation, const Image& guidance,
                                 const std::vector<Pin>& pins) {
  const int width = guidance.width, height = guidance.height;
  std::vector<Mask> masks(pins.size(), make_mask(width, height, 1));
  if (pins.size() == 1) return masks;
  std::vector<StrokePixel> pixels;
  for (std::size_t p = 0; p < pins.size(); ++p) {
    Mask dab = make_mask(width, height, 0);
    const std::uint32_t column = pins[p].pixel % static_cast<std::uint32_t>(width);
    const std::uint32_t row = pins[p].pixel / static_cast<std::uint32_t>(width);
    draw_stroke(dab, {{column + 0.5, row + 0.5}}, std::max(0.75, params.pin_radius_px), 1);
    for (std::size_t i = 0; i < dab.weight.size(); ++i)
      if (dab.weight[i] > 0)
        pixels.push_back({static_cast<std::uint32_t>(i), dab.weight[i], static_cast<int>(p)});
  }
  const Features features = make_lab_features(guidance);
  const Propagation found = propagate(make_neighbour_graph(features), features, pixels,
                                      static_cast<int>(pins.size()), propagation);
  const std::size_t count = pixels_of(guidance);
  for (std::size_t i = 0; i < count; ++i) {
    float sum = 0;
    for (std::size_t p = 0; p < pins.size(); ++p) sum += found.indicators[p * count + i];
    // Where no pin reaches all count alike.
    for (std::size_t p = 0; p < pins.size(); ++p)
      masks[p].weight[i] = sum > 1e-12f ? found.indicators[p * count + i] / sum
                                        : 1 / static_cast<float>(pins.size());
  }
  return masks;
}

// The first pin everywhere, then each further one by its part of what there is up to it: that mixes
// all linearly in range and in shape.
EditState mix_pins(const std::vector<Pin>& pins, std::vector<Mask> masks, int width, int height,
                   EditReport& report) {
  std::vector<std::uint32_t> index(masks[0].weight.size(), 0);
  EditState state = gather_pixels(pins[0].profile, index, width, height);
  std::vector<float> sum = masks[0].weight;
  for (std::size_t p = 1; p < pins.size(); ++p) {
    for (std::size_t i = 0; i < sum.size(); ++i) {
      sum[i] += masks[p].weight[i];
      masks[p].weight[i] = sum[i] > 0 ? std::min(1.0f, masks[p].weight[i] / sum[i]) : 0;
    }
    apply(BlendAmounts{}, pins[p].profile, {}, state, masks[p], report);
  }
  return state;
}

Plane photographed_albedo(const HallucinateParams& params, const Image& photograph,
                          const EditState& state) {
  Plane albedo(state.values());
  for (std::size_t i = 0; i < state.values(); ++i) {
    const std::size_t c = i / state.pixels();
    const double light = params.illumination[params.illumination.size() == 1 ? 0 : c];
    albedo[i] = value_of(photograph, i % state.pixels(), c) / light;
  }
  return albedo;
}

// C <- C photograph / relit, as row sums are what a uniformly lit flat sample shows.
void deblur(EditState& state, const Plane& wanted, const Progress& progress, EditReport& report) {
  const Material material = make_profile_map(state);
  const RowSums sums = measure_row_sums(*make_slices(material, natural_header(material)), progress);
  const Plane before = albedo_plane(state);
  Plane after = before;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const std::size_t c = i / state.pixels(), pixel = i % state.pixels();
    const auto relit = static_cast<double>(
        sums.albedo.values[pixel * static_cast<std::size_t>(state.channels) + c]);
    // A step of at most 2, since noise would grow without bound.
    after[i] *= std::clamp(std::max(wanted[i], least_albedo) / relit, 0.5, 2.0);
  }
  set_albedo(state, before, after, report);
}

}  // namespace

ParamList describe(HallucinateParams& params) {
  return {{.name = "illumination",
           .help = "irradiance on the photographed sample relative to the photograph's white",
           .target = &params.illumination,
           .min = 0,
           .max = 1e6,
           .above_min = true},
          {.name = "pixel-pitch-mm",
           .help = "side of the photograph's pixels; 0: as the map's",
           .target = &params.pixel_pitch_mm,
           .min = 0,
           .max = 1e6,
           .unit = "mm"},
          {.name = "deblur",
           .help = "steps that make the relit material match the photograph",
           .target = &params.deblur,
           .min = 0,
           .max = 20},
          {.name = "pin-radius-px",
           .help = "pixels around a pin that are sure to be its material",
           .target = &params.pin_radius_px,
           .min = 0,
           .max = 1000,
           .unit = "px"}};
}

EditState hallucinate(const HallucinateParams& params, const PropagateParams& propagation,
                      const Image& photograph, const Image& guidance, const std::vector<Pin>& pins,
                      const EditState& like, EditReport& report, const Progress& progress) {
  PARIAN_CHECK(!pins.empty());
  check_pictures(photograph, guidance);
  advance_progress(progress, "propagate", 0);
  EditState state = mix_pins(pins, propagate_pins(params, propagation, guidance, pins),
                             photograph.width, photograph.height, report);
  state.boundary = like.boundary;
  state.eta = like.eta;
  state.pixel_pitch_mm = params.pixel_pitch_mm > 0 ? params.pixel_pitch_mm : like.pixel_pitch_mm;
  const Plane wanted = photographed_albedo(params, photograph, state);
  set_albedo(state, albedo_plane(state), wanted, report);
  for (int i = 0; i < params.deblur; ++i) deblur(state, wanted, progress, report);
  return state;
}

}  // namespace parian

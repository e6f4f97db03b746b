#include "app/studio/flat_picture.h"

#include <algorithm>
#include <cmath>

#include "judge/false_color.h"
#include "judge/relight.h"
#include "material/material.h"

namespace parian {
namespace {

std::size_t source_channel(const EditState& state, std::size_t c) {
  return std::min(c, static_cast<std::size_t>(state.channels) - 1);
}

Image draw_plane(const EditState& state, const Plane& plane, bool in_false_colors) {
  Image image = make_image(state.width, state.height, 3);
  const std::size_t pixels = state.pixels();
  if (!in_false_colors) {
    for (std::size_t i = 0; i < pixels; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        image.values[3 * i + c] = static_cast<float>(plane[source_channel(state, c) * pixels + i]);
    return image;
  }
  std::vector<double> mean(pixels, 0.0);
  const auto channels = static_cast<std::size_t>(state.channels);
  for (std::size_t k = 0; k < plane.size(); ++k)
    mean[k % pixels] += plane[k] / static_cast<double>(channels);
  const double largest = std::max(1e-9, *std::max_element(mean.begin(), mean.end()));
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto color = map_color(mean[i] / largest);
    std::copy(color.begin(), color.end(),
              image.values.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  return image;
}

// The albedo, with what is not selected in grey.
Image draw_selection(const FlatRequest& request) {
  Image image = draw_plane(request.state, albedo_plane(request.state), false);
  if (request.mask == nullptr || request.mask->weight.size() != request.state.pixels())
    return image;
  for (std::size_t i = 0; i < request.mask->weight.size(); ++i) {
    const float weight = request.mask->weight[i];
    float* at = image.values.data() + 3 * i;
    const float grey = 0.1f * (at[0] + at[1] + at[2]);
    for (std::size_t c = 0; c < 3; ++c) at[c] = grey + weight * (at[c] - grey);
  }
  return image;
}

Image make_beam(const EditState& state, MapPixel beam) {
  Image light = make_image(state.width, state.height, 1);
  constexpr int radius = 1;
  for (int y = std::max(0, beam.y - radius); y <= std::min(state.height - 1, beam.y + radius); ++y)
    for (int x = std::max(0, beam.x - radius); x <= std::min(state.width - 1, beam.x + radius); ++x)
      at(light, x, y, 0) = 1;
  return light;
}

Image draw_lit(const FlatRequest& request, const Progress& progress) {
  const EditState& state = request.state;
  const Material material(*request.map);
  const auto slices = make_slices(material, natural_header(material));
  const Image light = request.mode == FlatMode::beam
                          ? make_beam(state, request.beam)
                          : make_flat_light(request.mode == FlatMode::uniform ? FlatLight::uniform
                                            : request.mode == FlatMode::disc  ? FlatLight::disc
                                                                              : FlatLight::line,
                                            state.width, state.height, 1);
  Image lit = relight(*slices, {light}, progress).front();
  if (lit.channels == 3) return lit;
  Image image = make_image(state.width, state.height, 3);
  for (std::size_t i = 0; i < image.values.size(); ++i) image.values[i] = lit.values[i / 3];
  return image;
}

}  // namespace

Image draw_flat(const FlatRequest& request, const Progress& progress) {
  switch (request.mode) {
    case FlatMode::albedo:
      return draw_plane(request.state, albedo_plane(request.state), false);
    case FlatMode::range:
      return draw_plane(request.state, range_plane(request.state), true);
    case FlatMode::mean_radius:
      return draw_plane(request.state, mean_radius_plane(request.state), true);
    case FlatMode::selection:
      return draw_selection(request);
    default:
      return draw_lit(request, progress);
  }
}

std::vector<MeasuredPair> collect_pairs(const SliceSource& table, int channel, MapPixel pixel,
                                        const Progress& progress) {
  const TableHeader& header = table.header();
  std::vector<MeasuredPair> pairs;
  if (channel >= header.channels || pixel.x >= header.width || pixel.y >= header.height)
    return pairs;
  std::vector<float> slice(header.pixels());
  for (std::size_t d = 0; d < header.offsets.size(); ++d) {
    advance_progress(progress, "reading pairs",
                     static_cast<double>(d) / static_cast<double>(header.offsets.size()));
    table.read_slice(channel, d, slice.data());
    const Offset offset = header.offsets[d];
    const double r = header.pixel_pitch_mm * std::hypot(offset.dx, offset.dy);
    // The pixel as either end of the pair.
    for (const MapPixel at : {pixel, MapPixel{pixel.x - offset.dx, pixel.y - offset.dy}}) {
      if (at.x < 0 || at.y < 0 || at.x >= header.width || at.y >= header.height) continue;
      const float value =
          slice[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(header.width) +
                static_cast<std::size_t>(at.x)];
      if (std::isfinite(value)) pairs.push_back({r, static_cast<double>(value)});
    }
  }
  return pairs;
}

}  // namespace parian

#include "judge/relight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "base/parallel.h"
#include "judge/pair_kernels.h"
#include "judge/slice_batches.h"

namespace parian {
namespace {

// One channel of each light as a plane, and what leaves.
struct LightPlanes {
  std::vector<LightPlane> irradiance;
  std::vector<std::vector<double>> sums;
};

void check_lights(const TableHeader& header, const std::vector<Image>& lights) {
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const Image& light = lights[l];
    const std::string place = fmt::format("light {}", l);
    if (light.width != header.width || light.height != header.height)
      throw Error({"", place, fmt::format("{} x {} pixels", header.width, header.height),
                   fmt::format("{} x {}", light.width, light.height)});
    if (light.channels != 1 && light.channels != header.channels)
      throw Error(
          {"", place,
           header.channels == 1 ? "1 channel" : fmt::format("1 or {} channels", header.channels),
           fmt::format("{}", light.channels)});
    const auto bad = std::find_if(light.values.begin(), light.values.end(),
                                  [](float value) { return !std::isfinite(value); });
    if (bad != light.values.end())
      throw Error({"", place, "finite values", fmt::format("{}", *bad)});
  }
}

void set_channel(const std::vector<Image>& lights, int channel, LightPlanes& planes) {
  for (std::size_t l = 0; l < lights.size(); ++l) {
    const std::size_t stride = static_cast<std::size_t>(lights[l].channels);
    const std::size_t first = stride == 1 ? 0 : static_cast<std::size_t>(channel);
    std::vector<float> values(planes.sums[l].size());
    for (std::size_t i = 0; i < values.size(); ++i)
      values[i] = lights[l].values[i * stride + first];
    planes.irradiance[l] =
        make_light_plane(std::move(values), static_cast<std::size_t>(lights[l].width));
    std::fill(planes.sums[l].begin(), planes.sums[l].end(), 0.0);
  }
}

// What leaves in row y, gathered from all pairs in which its pixels take part.
void add_row(const TableHeader& header, const SliceBatch& batch, int y, LightPlanes& planes) {
  std::vector<double> wide(static_cast<std::size_t>(header.width));
  const auto add = [&](const float* values, int count, std::size_t to, std::size_t lit_from) {
    widen_measured(values, static_cast<std::size_t>(count), wide.data());
    for (std::size_t l = 0; l < planes.sums.size(); ++l)
      add_lit(wide.data(), planes.irradiance[l], lit_from, static_cast<std::size_t>(count),
              &planes.sums[l][to]);
  };
  for (int i = 0; i < batch.count; ++i) {
    const Offset offset = header.offsets[static_cast<std::size_t>(batch.first + i)];
    const RowPairs pairs = find_row_pairs(header, offset, y);
    const float* slice = batch.slice(0, i);
    if (header.symmetric && pairs.back_count > 0)
      add(slice + pairs.back_at, pairs.back_count, pairs.back_partner, pairs.back_at);
    if (pairs.count > 0) add(slice + pairs.at, pairs.count, pairs.at, pairs.partner);
  }
}

void store_channel(const TableHeader& header, int channel, const LightPlanes& planes,
                   std::vector<Image>& exitance) {
  const double area = header.pixel_pitch_mm * header.pixel_pitch_mm;
  const std::size_t stride = static_cast<std::size_t>(header.channels);
  for (std::size_t l = 0; l < exitance.size(); ++l)
    for (std::size_t i = 0; i < header.pixels(); ++i)
      exitance[l].values[i * stride + static_cast<std::size_t>(channel)] =
          static_cast<float>(area * planes.sums[l][i]);
}

}  // namespace

Image make_flat_light(FlatLight light, int width, int height, int channels) {
  Image image = make_image(width, height, channels, light == FlatLight::uniform ? 1.0f : 0.0f);
  if (light == FlatLight::uniform) return image;
  const double radius = std::min(width, height) / 6.0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool inside = light == FlatLight::line
                              ? std::abs(x - width / 2) <= 1
                              : std::hypot(x - 0.5 * (width - 1), y - 0.5 * (height - 1)) <= radius;
      for (int c = 0; inside && c < channels; ++c) at(image, x, y, c) = 1;
    }
  return image;
}

std::vector<Image> relight(const SliceSource& table, const std::vector<Image>& irradiance,
                           const Progress& progress) {
  const TableHeader& header = table.header();
  check_lights(header, irradiance);
  LightPlanes planes;
  planes.irradiance.resize(irradiance.size());
  planes.sums.assign(irradiance.size(), std::vector<double>(header.pixels()));
  std::vector<Image> exitance(irradiance.size(),
                              make_image(header.width, header.height, header.channels));
  const int offsets = static_cast<int>(header.offsets.size());
  for_each_batch(
      table, nullptr, {}, 0, header.channels, progress, "relighting", [&](const SliceBatch& batch) {
        if (batch.first == 0) set_channel(irradiance, batch.channel, planes);
        parallel_for(static_cast<std::size_t>(header.height),
                     [&](std::size_t y) { add_row(header, batch, static_cast<int>(y), planes); });
        if (batch.first + batch.count == offsets)
          store_channel(header, batch.channel, planes, exitance);
      });
  return exitance;
}

}  // namespace parian

// Profile plots: what was measured around a pixel, against the model.
#include "judge/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error.h"
#include "judge/slice_batches.h"

namespace parian {
namespace {

// The pairs in which one pixel takes part.
struct PixelPairs {
  std::vector<double> r_mm, data, model;
};

void add_pair(const SliceBatch& batch, int i, std::size_t x, double r_mm, PixelPairs& pairs) {
  const float data = batch.slice(0, i)[x];
  if (std::isnan(data)) return;
  pairs.r_mm.push_back(r_mm);
  pairs.data.push_back(data);
  pairs.model.push_back(batch.slice(1, i)[x]);
}

void add_batch(const TableHeader& header, const SliceBatch& batch, PlotPixel pixel,
               PixelPairs& pairs) {
  for (int i = 0; i < batch.count; ++i) {
    const Offset d = header.offsets[static_cast<std::size_t>(batch.first + i)];
    const double r_mm = length_px(d) * header.pixel_pitch_mm;
    const auto add = [&](int x, int y) {
      const PixelRange range = pairs_in_grid(header, d);
      if (x < range.x0 || x >= range.x1 || y < range.y0 || y >= range.y1) return;
      add_pair(batch, i,
               static_cast<std::size_t>(y) * static_cast<std::size_t>(header.width) +
                   static_cast<std::size_t>(x),
               r_mm, pairs);
    };
    add(pixel.x, pixel.y);
    if (d != Offset{}) add(pixel.x - d.dx, pixel.y - d.dy);
  }
}

PlotSeries make_profile_line(const Material& material, PlotPixel pixel, int channel, double r_max) {
  const Profile profile = get_profile(material, channel, pixel.x, pixel.y);
  PlotSeries line{.label = "profile P(r)", .color = {0.02f, 0.02f, 0.025f}};
  constexpr int steps = 256;
  for (int i = 0; i <= steps; ++i) {
    line.x.push_back(r_max * i / steps);
    line.y.push_back(std::exp(eval_log_profile(profile, line.x.back())));
  }
  return line;
}

// Values far below the measured ones (where a model has underflowed) would squeeze the rest.
void drop_below(double floor, PlotSeries& series) {
  for (double& value : series.y)
    if (value < floor) value = 0;
}

Image plot_pixel(const PixelPairs& pairs, const Material* material, PlotPixel pixel, int channel,
                 int channels) {
  constexpr std::array<float, 3> colors[] = {
      {0.75f, 0.04f, 0.02f}, {0.01f, 0.3f, 0.06f}, {0.02f, 0.09f, 0.65f}};
  const char* const names[] = {"red", "green", "blue"};
  Plot plot;
  plot.title = fmt::format("pixel ({}, {}){}", pixel.x, pixel.y,
                           channels == 3 ? fmt::format(", {}", names[channel]) : "");
  plot.x_label = "r [mm]";
  plot.y_label = "R_d [1/mm^2]";
  plot.log_y = true;
  double least = std::numeric_limits<double>::infinity(), r_max = 0;
  for (std::size_t i = 0; i < pairs.data.size(); ++i) {
    if (pairs.data[i] > 0) least = std::min(least, pairs.data[i]);
    r_max = std::max(r_max, pairs.r_mm[i]);
  }
  plot.series.push_back({"table", pairs.r_mm, pairs.data, {0.3f, 0.31f, 0.33f}, true, 5, 0.55});
  plot.series.push_back({"model, same pairs", pairs.r_mm, pairs.model,
                         colors[channels == 3 ? channel : 0], true, 2.4, 1});
  if (material != nullptr && has_profiles(*material) && r_max > 0)
    plot.series.push_back(make_profile_line(*material, pixel, channel, r_max));
  for (std::size_t i = 1; i < plot.series.size() && std::isfinite(least); ++i)
    drop_below(least / 100, plot.series[i]);
  return draw_plot(plot);
}

}  // namespace

std::vector<Image> plot_profiles(const SliceSource& table, const SliceSource& model,
                                 const Material* material, const std::vector<PlotPixel>& pixels,
                                 int channel, const Progress& progress) {
  const TableHeader& header = table.header();
  PARIAN_CHECK_LE(0, channel);
  PARIAN_CHECK_LT(channel, header.channels);
  for (const PlotPixel pixel : pixels)
    if (pixel.x < 0 || pixel.x >= header.width || pixel.y < 0 || pixel.y >= header.height)
      throw Error({table.name(), "pixel to plot",
                   fmt::format("x in [0, {}], y in [0, {}]", header.width - 1, header.height - 1),
                   fmt::format("({}, {})", pixel.x, pixel.y)});
  const std::vector<int> model_offsets = match_offsets(table, model);
  std::vector<PixelPairs> pairs(pixels.size());
  for_each_batch(table, &model, model_offsets, channel, channel + 1, progress, "plotting",
                 [&](const SliceBatch& batch) {
                   for (std::size_t p = 0; p < pixels.size(); ++p)
                     add_batch(header, batch, pixels[p], pairs[p]);
                 });
  std::vector<Image> images;
  for (std::size_t p = 0; p < pixels.size(); ++p)
    images.push_back(plot_pixel(pairs[p], material, pixels[p], channel, header.channels));
  return images;
}

}  // namespace parian

// Fig. 4: data, model and profiles at three points of the chessboard.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/paper_2009/pictures.h"
#include "bench/paper_2009/study.h"
#include "judge/plot.h"
#include "material/material.h"

namespace parian::paper_2009 {
namespace {

constexpr int channel = 1;        // green
constexpr int magnification = 5;  // of the windows
constexpr double decades = 5;

struct PointOfInterest {
  const char* name;
  PlotPixel pixel;
  Color data_color, profile_color;
};
constexpr PointOfInterest points[] = {
    {"a: middle of a dark square", {97, 124}, {0.9f, 0.55f, 0.4f}, {0.5f, 0.06f, 0.01f}},
    {"b: middle of a white square", {124, 124}, {0.45f, 0.6f, 0.95f}, {0.01f, 0.05f, 0.5f}},
    {"c: white, at a dark square", {113, 124}, {0.45f, 0.8f, 0.45f}, {0, 0.2f, 0.02f}}};

// The windows around a pixel: [y][x] over offsets, NaN outside of the disc.
struct Windows {
  Image data, model, ratio, profile;
};

Windows cut_windows(const BssrdfTable& table, const ProfileMap& map, PlotPixel pixel) {
  const int reach = static_cast<int>(radius_px(table.header));
  Windows windows;
  for (Image* image : {&windows.data, &windows.model, &windows.ratio, &windows.profile})
    *image = make_image(2 * reach + 1, 2 * reach + 1, 1, std::nanf(""));
  const Profile profile = get_profile(map, channel, pixel.x, pixel.y);
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      const double data = table_value(table, channel, pixel.x, pixel.y, {dx, dy});
      if (std::isnan(data)) continue;
      const double model = model_value(map, channel, pixel.x, pixel.y, {dx, dy});
      const int x = reach + dx, y = reach + dy;
      at(windows.data, x, y, 0) = static_cast<float>(data);
      at(windows.model, x, y, 0) = static_cast<float>(model);
      at(windows.ratio, x, y, 0) = static_cast<float>(std::log(model / data));
      at(windows.profile, x, y, 0) = static_cast<float>(
          std::exp(eval_log_profile(profile, length_px({dx, dy}) * map.pixel_pitch_mm)));
    }
  return windows;
}

double rms(const Image& image) {
  double sum = 0;
  std::size_t count = 0;
  for (const float value : image.values)
    if (!std::isnan(value)) {
      sum += static_cast<double>(value) * static_cast<double>(value);
      ++count;
    }
  return std::sqrt(sum / static_cast<double>(count));
}

double log_distance(const Image& a, const Image& b) {
  Image ratio = a;
  for (std::size_t i = 0; i < ratio.values.size(); ++i)
    ratio.values[i] = std::log(a.values[i] / b.values[i]);
  return rms(ratio);
}

Image draw_window(const Image& values, const ColorScale& scale, const std::string& title,
                  double pitch) {
  const double edge = values.width / 2.0 * pitch;
  return draw_panel({colorize(values, scale, magnification), title, "dx [mm]", "dy [mm]", -edge,
                     edge, -edge, edge});
}

Image draw_windows(const BssrdfTable& table, const std::vector<Windows>& windows) {
  const double pitch = table.header.pixel_pitch_mm;
  float max = 0;
  for (const Windows& each : windows)
    for (const float value : each.data.values) max = std::max(max, value);
  const ColorScale scale = log_scale(max, decades, "[1/mm^2]");
  const ColorScale errors = diverging_scale(0.5, "ln(model / data)");
  std::vector<std::vector<Image>> rows(4);
  const char* const titles[] = {"data", "model", "error", "its profile"};
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Windows& w = windows[i];
    const Image* const images[] = {&w.data, &w.model, &w.ratio, &w.profile};
    for (std::size_t row = 0; row < rows.size(); ++row)
      rows[row].push_back(draw_window(
          *images[row], row == 2 ? errors : scale,
          row == 0 ? points[i].name : fmt::format("{}: {}", points[i].name[0], titles[row]),
          pitch));
  }
  for (std::size_t row = 0; row < rows.size(); ++row)
    rows[row].push_back(
        draw_color_bar(row == 2 ? errors : scale, windows[0].data.height * magnification));
  return arrange(rows, 6);
}

// All three in one plot: the data scatter, the profiles do not.
Image draw_profiles(const BssrdfTable& table, const ProfileMap& map,
                    const std::vector<Windows>& windows) {
  Plot plot{.title = "data (dots) and profiles (lines) at three points, green",
            .x_label = "r [mm]",
            .y_label = "R_d, P [1/mm^2]",
            .log_y = true,
            .width = 720,
            .height = 460};
  const int reach = static_cast<int>(radius_px(table.header));
  for (std::size_t i = 0; i < windows.size(); ++i) {
    PlotSeries dots{.color = points[i].data_color, .points = true, .size = 3.5};
    for (int y = 0; y <= 2 * reach; ++y)
      for (int x = 0; x <= 2 * reach; ++x) {
        const double value = at(windows[i].data, x, y, 0);
        if (std::isnan(value)) continue;
        dots.x.push_back(length_px({x - reach, y - reach}) * map.pixel_pitch_mm);
        dots.y.push_back(value);
      }
    plot.series.push_back(std::move(dots));
  }
  for (const PointOfInterest& point : points) {
    PlotSeries line{.label = point.name, .color = point.profile_color, .size = 2.5};
    const Profile profile = get_profile(map, channel, point.pixel.x, point.pixel.y);
    for (std::size_t k = 0; k < profile.knots_mm.size(); ++k) {
      line.x.push_back(profile.knots_mm[k]);
      line.y.push_back(std::exp(profile.log_value[k]));
    }
    plot.series.push_back(std::move(line));
  }
  return draw_plot(plot);
}

}  // namespace

void study_points(Study& study) {
  const BssrdfTable& table = get_sample(study, "chessboard");
  const Judged judged = fit_and_judge(table, {});
  const ProfileMap& map = judged.fit.map;
  std::vector<Windows> windows;
  std::vector<PlotPixel> pixels;
  for (const PointOfInterest& point : points) {
    windows.push_back(cut_windows(table, map, point.pixel));
    pixels.push_back(point.pixel);
  }
  write_picture(study, "points", draw_windows(table, windows));
  write_picture(study, "points-profiles", draw_profiles(table, map, windows));
  const Material material = map;
  const std::vector<Image> plots = plot_profiles(
      *make_slices(table), *make_slices(material, table.header), &map, pixels, channel);
  for (std::size_t i = 0; i < plots.size(); ++i)
    write_picture(study, fmt::format("point-{}", points[i].name[0]), plots[i]);

  MarkdownTable out{{"point", "relative error of the pixel", "log RMS, model / data",
                     "log RMS to b: data", "log RMS to b: profiles"},
                    {}};
  for (std::size_t i = 0; i < windows.size(); ++i)
    out.rows.push_back(
        {points[i].name,
         fmt::format("{:.4f}", static_cast<double>(
                                   at(judged.errors.error_image, pixels[i].x, pixels[i].y, 0))),
         fmt::format("{:.3f}", rms(windows[i].ratio)),
         i == 1 ? "" : fmt::format("{:.3f}", log_distance(windows[i].data, windows[1].data)),
         i == 1 ? ""
                : fmt::format("{:.3f}", log_distance(windows[i].profile, windows[1].profile))});
  write_table(study, "points",
              "Over the window of 24 px, green; the relative error over all three channels.", out);
}

}  // namespace parian::paper_2009

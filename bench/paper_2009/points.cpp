// Fig. 4: data, model and profiles at three points of the chessboard.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "bench/common/pictures.h"
#include "bench/paper_2009/study.h"
#include "judge/plot.h"
#include "judge/row_sums.h"
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
    {"a (dark)", {97, 124}, {0.9f, 0.55f, 0.4f}, {0.5f, 0.06f, 0.01f}},
    {"b (white)", {124, 124}, {0.45f, 0.6f, 0.95f}, {0.01f, 0.05f, 0.5f}},
    {"c (edge)", {113, 124}, {0.45f, 0.8f, 0.45f}, {0, 0.2f, 0.02f}}};

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

// Root mean square of ln(a / b) within the distance.
double log_rms(const Image& a, const Image& b, double within_px) {
  double sum = 0;
  int count = 0;
  const int reach = a.width / 2;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const double ratio = std::log(at(a, x, y, 0) / at(b, x, y, 0));
      if (std::isnan(ratio) || length_px({x - reach, y - reach}) > within_px) continue;
      sum += ratio * ratio;
      ++count;
    }
  return std::sqrt(sum / count);
}

Image draw_window(const Image& values, const ColorScale& scale, const std::string& title,
                  double pitch, bool first, bool last) {
  const double edge = values.width / 2.0 * pitch;
  return draw_panel({colorize(values, scale, magnification), title, last ? "dx [mm]" : "",
                     first ? "dy [mm]" : "", -edge, edge, -edge, edge, first ? panel_margin : 6});
}

Image draw_windows(const BssrdfTable& table, const std::vector<Windows>& windows) {
  const double pitch = table.header.pixel_pitch_mm;
  float max = 0;
  for (const Windows& each : windows)
    for (const float value : each.data.values) max = std::max(max, value);
  const ColorScale scale = log_scale(max, decades, "[1/mm^2]");
  const ColorScale errors = diverging_scale(0.5, "ln(model / data)");
  struct Row {
    const char* title;
    Image Windows::*image;
    const ColorScale& scale;
  };
  const Row rows[] = {{"data", &Windows::data, scale},
                      {"its profile", &Windows::profile, scale},
                      {"model", &Windows::model, scale},
                      {"ln(model / data)", &Windows::ratio, errors}};
  std::vector<std::vector<Image>> page;
  for (const Row& row : rows) {
    page.emplace_back();
    for (std::size_t i = 0; i < windows.size(); ++i)
      page.back().push_back(draw_window(windows[i].*row.image, row.scale,
                                        fmt::format("{}: {}", points[i].name, row.title), pitch,
                                        i == 0, &row == std::end(rows) - 1));
    page.back().push_back(draw_color_bar(row.scale, windows[0].data.height * magnification));
  }
  return arrange(page, 6);
}

Image crop(const Image& image, PlotPixel corner, int size) {
  Image part = make_image(size, size, image.channels);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      for (int c = 0; c < image.channels; ++c)
        at(part, x, y, c) = at(image, corner.x + x, corner.y + y, c);
  return part;
}

// A part of the sample with the points, and where the model errs.
Image draw_sample(const BssrdfTable& table, const Image& errors) {
  constexpr int enlarged = 3, size = 128;
  constexpr PlotPixel corner{56, 60};
  const double pitch = table.header.pixel_pitch_mm;
  const auto draw = [&](const Image& picture, const char* title, bool first) {
    return draw_panel({magnify(crop(picture, corner, size), enlarged), title, "x [mm]",
                       first ? "y [mm]" : "", corner.x * pitch, (corner.x + size) * pitch,
                       corner.y * pitch, (corner.y + size) * pitch, first ? panel_margin : 6});
  };
  Image sample = draw(measure_row_sums(*make_slices(table)).albedo, "albedo of the data", true);
  for (const PointOfInterest& point : points)
    mark_pixel(sample, point.pixel.x - corner.x, point.pixel.y - corner.y, enlarged,
               point.profile_color);
  const ColorScale scale{0, 0.35, false, false, "relative error"};
  return arrange({{sample, draw(colorize(errors, scale, 1), "relative error per pixel", false),
                   draw_color_bar(scale, size * enlarged)}},
                 4);
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

void write_distances(const Study& study, const std::vector<Windows>& windows, const Image& errors) {
  MarkdownTable out{{"point", "pixel's relative error", "ln(model / data)", "data, r <= 2 mm",
                     "profiles, r <= 2 mm", "data, r <= 6 mm", "profiles, r <= 6 mm"},
                    {}};
  const Windows& b = windows[1];
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const Windows& w = windows[i];
    const PlotPixel pixel = points[i].pixel;
    out.rows.push_back({points[i].name,
                        fmt::format("{:.4f}", static_cast<double>(at(errors, pixel.x, pixel.y, 0))),
                        fmt::format("{:.3f}", log_rms(w.model, w.data, 24))});
    for (const double within_px : {8.0, 24.0})
      for (const auto& [image, image_b] : {std::pair{&w.data, &b.data}, {&w.profile, &b.profile}})
        out.rows.back().push_back(
            i == 1 ? "" : fmt::format("{:.3f}", log_rms(*image, *image_b, within_px)));
  }
  write_table(study, "points",
              "Root mean squares of logarithms, green: of ln(model / data) around each point, and "
              "of how far data and profiles around it are from those of b.",
              out);
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
  write_picture(study, "points-sample", draw_sample(table, judged.errors.error_image));
  write_picture(study, "points", draw_windows(table, windows));
  write_picture(study, "points-profiles", draw_profiles(table, map, windows));
  const Material material = map;
  const std::vector<Image> plots = plot_profiles(
      *make_slices(table), *make_slices(material, table.header), &material, pixels, channel);
  for (std::size_t i = 0; i < plots.size(); ++i)
    write_picture(study, fmt::format("point-{}", points[i].name[0]), plots[i]);

  write_distances(study, windows, judged.errors.error_image);
}

}  // namespace parian::paper_2009

// Fig. 3: what the profiles along a line of the chessboard are, beside the data and the model.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "bench/common/pictures.h"
#include "bench/paper_2009/study.h"

namespace parian::paper_2009 {
namespace {

constexpr int line_y = 124;       // through the middle of a row of squares
constexpr int channel = 1;        // green
constexpr int magnification = 3;  // of the pictures
constexpr double decades = 5;
constexpr int from_x = 97, to_d = 17;  // the pair that is marked: from a dark square to a white one

struct Line {
  int width = 0, reach = 0;
  double pitch = 1;
};

// value(x, d) over x to the right and d upwards.
Image sample_line(const Line& line, const std::function<double(int x, int d)>& value) {
  Image image = make_image(line.width, 2 * line.reach + 1, 1);
  for (int x = 0; x < line.width; ++x)
    for (int d = -line.reach; d <= line.reach; ++d)
      at(image, x, line.reach - d, 0) = static_cast<float>(value(x, d));
  return image;
}

Image draw_line(const Line& line, const Image& values, const ColorScale& scale,
                const std::string& title, bool last) {
  const double edge = (line.reach + 0.5) * line.pitch;
  return draw_panel({colorize(values, scale, magnification), title, last ? "x [mm]" : "", "d [mm]",
                     0, line.width * line.pitch, edge, -edge});
}

void mark(Image& panel, const Line& line, int x, int d, Color color) {
  mark_pixel(panel, x, line.reach - d, magnification, color);
}

// The sample itself along the line: its diffuse albedo as a colour.
Image draw_strip(const Line& line, const ProfileMap& map) {
  constexpr int rows = 8;
  Image strip = make_image(line.width, rows, 3);
  for (int x = 0; x < line.width; ++x)
    for (int c = 0; c < 3; ++c) {
      const float albedo = static_cast<float>(diffuse_albedo(get_profile(map, c, x, line_y)));
      for (int y = 0; y < rows; ++y) at(strip, x, y, c) = albedo;
    }
  return draw_panel({magnify(strip, magnification), "the sample: albedo of the profiles", "", "", 0,
                     line.width * line.pitch, 0, 1});
}

double largest(const Image& image) {
  double max = 0;
  for (const float value : image.values)
    if (value > max) max = value;
  return max;
}

struct LineImages {
  Image data, profiles, model, ratio;  // ratio: ln(model / data)
};

LineImages sample_images(const Line& line, const BssrdfTable& table, const ProfileMap& map) {
  LineImages images;
  images.data = sample_line(line, [&](int x, int d) {
    return table_value(table, channel, x, line_y, {d, 0});
  });
  images.profiles = sample_line(line, [&](int x, int d) {
    return std::exp(
        eval_log_profile(get_profile(map, channel, x, line_y), std::abs(d) * line.pitch));
  });
  images.model = sample_line(line, [&](int x, int d) {
    const bool inside = x + d >= 0 && x + d < line.width;
    return inside ? model_value(map, channel, x, line_y, {d, 0}) : std::nan("");
  });
  images.ratio = images.model;
  for (std::size_t i = 0; i < images.ratio.values.size(); ++i)
    images.ratio.values[i] = std::log(images.model.values[i] / images.data.values[i]);
  return images;
}

Image draw_errors(const Line& line, const Image& ratio, const ColorScale& scale) {
  double worst = 0;
  for (const float value : ratio.values)
    worst = std::max(worst, std::abs(static_cast<double>(value)));
  return draw_line(line, ratio, scale,
                   fmt::format("error: ln(model / data), at most {:.2f}", worst), true);
}

}  // namespace

void study_line(Study& study) {
  const BssrdfTable& table = get_sample(study, "chessboard");
  const ProfileMap map = fit_and_judge(table, {}).fit.map;
  const Line line{table.header.width, static_cast<int>(radius_px(table.header)),
                  table.header.pixel_pitch_mm};
  const LineImages images = sample_images(line, table, map);
  const ColorScale scale = log_scale(largest(images.data), decades, "[1/mm^2]");
  const ColorScale errors = diverging_scale(0.5, "ln(model / data)");
  Image data = draw_line(line, images.data, scale, "data: R_d(x, x + d)", false);
  Image profiles = draw_line(line, images.profiles, scale, "profiles: P_x(|d|)", false);
  Image model = draw_line(line, images.model, scale, "model: sqrt(P_x(|d|) P_x+d(|d|))", false);
  const Color orange{0.9f, 0.2f, 0}, blue{0.01f, 0.08f, 0.9f}, green{0, 0.35f, 0.03f};
  mark(data, line, from_x, to_d, orange);
  mark(model, line, from_x, to_d, orange);
  mark(profiles, line, from_x, to_d, blue);
  mark(profiles, line, from_x + to_d, -to_d, green);
  const Image bar = draw_color_bar(scale, images.data.height * magnification);
  const Image error_bar = draw_color_bar(errors, images.data.height * magnification);
  write_picture(study, "line",
                arrange({{draw_strip(line, map)},
                         {data, bar},
                         {profiles, bar},
                         {model, bar},
                         {draw_errors(line, images.ratio, errors), error_bar}},
                        4));
}

}  // namespace parian::paper_2009

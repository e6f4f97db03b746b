#include "bench/common/pictures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "judge/false_color.h"
#include "judge/plot.h"

namespace parian {
namespace {

constexpr Color ink{0.012f, 0.014f, 0.02f}, missing_color{0.72f, 0.72f, 0.72f};
constexpr double text_scale = 1.5;

double fraction_of(const ColorScale& scale, double value) {
  if (scale.logarithmic) return std::log(value / scale.min) / std::log(scale.max / scale.min);
  return (value - scale.min) / (scale.max - scale.min);
}

// t in [0, 1]; towards the ends first saturated, then darker.
Color diverging_color(double t) {
  constexpr Color blue{0.02f, 0.09f, 0.5f}, red{0.5f, 0.03f, 0.02f};
  const double s = std::clamp(2 * t - 1, -1.0, 1.0);
  const Color& end = s < 0 ? blue : red;
  Color color;
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = static_cast<float>(1 + std::abs(s) * (static_cast<double>(end[c]) - 1));
  return color;
}

Color color_at(const ColorScale& scale, double t) {
  return scale.diverging ? diverging_color(t) : map_color(t);
}

void paste(Image& image, const Image& part, int left, int top) {
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x)
      for (int c = 0; c < 3; ++c)
        at(image, left + x, top + y, c) = at(part, x, y, part.channels == 3 ? c : 0);
}

void frame(Image& image, const Box& box) {
  fill_box(image, {box.x0 - 1, box.y0 - 1, box.x1 + 1, box.y0}, ink);
  fill_box(image, {box.x0 - 1, box.y1, box.x1 + 1, box.y1 + 1}, ink);
  fill_box(image, {box.x0 - 1, box.y0, box.x0, box.y1}, ink);
  fill_box(image, {box.x1, box.y0, box.x1 + 1, box.y1}, ink);
}

double centred(double middle, const std::string& text, double scale) {
  return std::round(middle - text_width(text, scale) / 2);
}

void draw_x_axis(Image& image, const Panel& panel, const Box& box) {
  if (panel.x_label.empty()) return;
  for (const double tick :
       plot_ticks(std::min(panel.left, panel.right), std::max(panel.left, panel.right), false)) {
    const double x = box.x0 + (tick - panel.left) / (panel.right - panel.left) * (box.x1 - box.x0);
    fill_box(image, {x - 0.5, box.y1, x + 0.5, box.y1 + 5}, ink);
    const std::string label = format_tick(tick);
    draw_text(image, {centred(x, label, text_scale), box.y1 + 8}, label, text_scale, ink);
  }
  draw_text(image, {centred((box.x0 + box.x1) / 2, panel.x_label, text_scale), box.y1 + 25},
            panel.x_label, text_scale, ink);
}

void draw_y_axis(Image& image, const Panel& panel, const Box& box) {
  if (panel.y_label.empty()) return;
  for (const double tick :
       plot_ticks(std::min(panel.top, panel.bottom), std::max(panel.top, panel.bottom), false)) {
    const double y = box.y0 + (tick - panel.top) / (panel.bottom - panel.top) * (box.y1 - box.y0);
    fill_box(image, {box.x0 - 5, y - 0.5, box.x0, y + 0.5}, ink);
    const std::string label = format_tick(tick);
    draw_text(image,
              {std::round(box.x0 - 8 - text_width(label, text_scale)),
               std::round(y - text_height(text_scale) / 2)},
              label, text_scale, ink);
  }
  draw_text(image, {6, std::round((box.y0 + box.y1 + text_width(panel.y_label, text_scale)) / 2)},
            panel.y_label, text_scale, ink, true);
}

}  // namespace

double table_value(const BssrdfTable& table, int channel, int x, int y, Offset d) {
  const TableHeader& header = table.header;
  int index = find_offset(header, d);
  if (index < 0) {  // the other half plane: the same pair from its other end
    index = find_offset(header, {-d.dx, -d.dy});
    x += d.dx;
    y += d.dy;
    d = {-d.dx, -d.dy};
  }
  const PixelRange range = pairs_in_grid(header, d);
  if (index < 0 || x < range.x0 || x >= range.x1 || y < range.y0 || y >= range.y1)
    return std::numeric_limits<double>::quiet_NaN();
  return slice_of(table, channel, index)[y * header.width + x];
}

double model_value(const ProfileMap& map, int channel, int x, int y, Offset d) {
  const double r_mm = length_px(d) * map.pixel_pitch_mm;
  return std::exp(0.5 * (eval_log_profile(get_profile(map, channel, x, y), r_mm) +
                         eval_log_profile(get_profile(map, channel, x + d.dx, y + d.dy), r_mm)));
}

ColorScale log_scale(double max, double decades, std::string label) {
  return {max * std::pow(10.0, -decades), max, true, false, std::move(label)};
}

ColorScale diverging_scale(double max, std::string label) {
  return {-max, max, false, true, std::move(label)};
}

Color color_of(const ColorScale& scale, double value) {
  return std::isnan(value) ? missing_color : color_at(scale, fraction_of(scale, value));
}

Image colorize(const Image& values, const ColorScale& scale, int magnification) {
  Image image = make_image(values.width, values.height, 3);
  for (int y = 0; y < values.height; ++y)
    for (int x = 0; x < values.width; ++x) {
      const Color color = color_of(scale, at(values, x, y, 0));
      for (int c = 0; c < 3; ++c) at(image, x, y, c) = color[static_cast<std::size_t>(c)];
    }
  return magnify(image, magnification);
}

Image draw_panel(const Panel& panel) {
  const int below = panel.x_label.empty() ? 2 : 40, right = 14;
  Image image = make_image(panel.margin_left + panel.picture.width + right,
                           panel_top + panel.picture.height + below, 3, 1);
  const Box box{1.0 * panel.margin_left, panel_top, 1.0 * panel.margin_left + panel.picture.width,
                1.0 * panel_top + panel.picture.height};
  paste(image, panel.picture, panel.margin_left, panel_top);
  frame(image, box);
  draw_text(image, {1.0 * panel.margin_left, 9}, panel.title, text_scale, ink);
  draw_x_axis(image, panel, box);
  draw_y_axis(image, panel, box);
  return image;
}

Image draw_color_bar(const ColorScale& scale, int height) {
  constexpr int bar = 16;
  const auto ticks = plot_ticks(scale.min, scale.max, scale.logarithmic);
  double widest = 0;
  for (const double tick : ticks)
    widest = std::max(widest, text_width(format_tick(tick), text_scale));
  const double label_at = bar + 12 + std::ceil(widest) + 8;
  Image image = make_image(static_cast<int>(label_at) + 16, panel_top + height + 8, 3, 1);
  for (int y = 0; y < height; ++y)
    fill_box(image, {1, 1.0 * panel_top + y, bar, panel_top + y + 1.0},
             color_at(scale, 1 - (y + 0.5) / height));
  frame(image, {1, panel_top, bar, 1.0 * panel_top + height});
  for (const double tick : ticks) {
    const double y = std::round(panel_top + (1 - fraction_of(scale, tick)) * height);
    fill_box(image, {bar, y - 0.5, bar + 5, y + 0.5}, ink);
    draw_text(image, {bar + 9, y - std::floor(text_height(text_scale) / 2)}, format_tick(tick),
              text_scale, ink);
  }
  draw_text(image,
            {label_at, std::round(panel_top + (height + text_width(scale.label, text_scale)) / 2)},
            scale.label, text_scale, ink, true);
  return image;
}

void mark_pixel(Image& panel, double x, double y, int magnification, Color color) {
  const Point centre{panel_margin + (x + 0.5) * magnification,
                     panel_top + (y + 0.5) * magnification};
  const Box all{0, 0, 1.0 * panel.width, 1.0 * panel.height};
  draw_dot(panel, centre, 6, {1, 1, 1}, 1, all);
  draw_dot(panel, centre, 4.5, color, 1, all);
}

Image draw_legend(const std::vector<LegendEntry>& entries, int width) {
  Image image = make_image(width, 20, 3, 1);
  double x = panel_margin;
  for (const LegendEntry& entry : entries) {
    fill_box(image, {x, 8, x + 22, 11}, entry.color);
    draw_text(image, {x + 28, 5}, entry.label, text_scale, ink);
    x += 28 + std::ceil(text_width(entry.label, text_scale)) + 20;
  }
  return image;
}

Image arrange(const std::vector<std::vector<Image>>& rows, int gap) {
  int width = 0, height = 0;
  std::vector<int> tops;
  for (const auto& row : rows) {
    int row_width = -gap, row_height = 0;
    for (const Image& image : row) {
      row_width += image.width + gap;
      row_height = std::max(row_height, image.height);
    }
    tops.push_back(height);
    width = std::max(width, row_width);
    height += row_height + gap;
  }
  Image page = make_image(width, height - gap, 3, 1);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    int left = 0;
    for (const Image& image : rows[i]) {
      paste(page, image, left, tops[i]);
      left += image.width + gap;
    }
  }
  return page;
}

}  // namespace parian

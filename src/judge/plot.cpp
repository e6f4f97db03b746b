#include "judge/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "judge/canvas.h"

namespace parian {
namespace {

constexpr Color white{1, 1, 1}, ink{0.012f, 0.014f, 0.02f}, grid_color{0.78f, 0.79f, 0.81f};
constexpr double text_scale = 1.5, title_scale = 2;
constexpr double margin_right = 18, margin_bottom = 50;

struct Axis {
  double min = 0, max = 1;
  bool logarithmic = false;
  double from = 0, to = 1;  // in pixels
};

bool is_shown(double value, bool logarithmic) {
  return std::isfinite(value) && (!logarithmic || value > 0);
}

double place(const Axis& axis, double value) {
  const double a = axis.logarithmic ? std::log(axis.min) : axis.min;
  const double b = axis.logarithmic ? std::log(axis.max) : axis.max;
  const double t = ((axis.logarithmic ? std::log(value) : value) - a) / (b - a);
  return axis.from + t * (axis.to - axis.from);
}

// The range of all shown points, with 4 % on either side (where values are not negative, a linear
// axis does not go below 0).
Axis make_axis(const Plot& plot, bool of_x) {
  Axis axis;
  axis.logarithmic = of_x ? plot.log_x : plot.log_y;
  double min = std::numeric_limits<double>::infinity(), max = -min;
  for (const PlotSeries& series : plot.series)
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      if (!is_shown(series.x[i], plot.log_x) || !is_shown(series.y[i], plot.log_y)) continue;
      min = std::min(min, of_x ? series.x[i] : series.y[i]);
      max = std::max(max, of_x ? series.x[i] : series.y[i]);
    }
  if (!(min <= max)) min = axis.logarithmic ? 0.1 : 0, max = 1;
  if (axis.logarithmic) {
    const double pad = max > min ? std::pow(max / min, 0.04) : 2.0;
    axis.min = std::max(min / pad, std::numeric_limits<double>::min());
    axis.max = std::min(max * pad, std::numeric_limits<double>::max());
  } else {
    const double pad = max > min ? 0.04 * (max - min) : std::max(0.5 * std::abs(max), 0.5);
    axis.min = min >= 0 ? std::max(0.0, min - pad) : min - pad;
    axis.max = max + pad;
  }
  return axis;
}

void add_steps(double min, double max, double step, std::vector<double>& ticks) {
  for (double i = std::ceil(min / step - 1e-9); i * step <= max + 1e-9 * step; ++i)
    ticks.push_back(i * step == 0 ? 0.0 : i * step);
}

// Factors of every decade within [min, max].
std::vector<double> decade_ticks(double min, double max, const std::vector<double>& factors,
                                 int every) {
  std::vector<double> ticks;
  const int first = static_cast<int>(std::floor(std::log10(min)));
  const int last = static_cast<int>(std::ceil(std::log10(max)));
  for (int k = first; k <= last; ++k) {
    if ((k % every + every) % every != 0) continue;
    for (const double factor : factors) {
      const double value = factor * std::pow(10.0, k);
      if (value >= min * (1 - 1e-9) && value <= max * (1 + 1e-9)) ticks.push_back(value);
    }
  }
  return ticks;
}

struct Layout {
  Axis x, y;
  Box frame;
};

Layout make_layout(const Plot& plot) {
  Layout layout;
  layout.x = make_axis(plot, true);
  layout.y = make_axis(plot, false);
  double widest = 0;
  for (const double tick : plot_ticks(layout.y.min, layout.y.max, layout.y.logarithmic))
    widest = std::max(widest, text_width(format_tick(tick), text_scale));
  const double left = std::ceil(widest) + (plot.y_label.empty() ? 16 : 40);
  const double top = plot.title.empty() ? 14 : 38;
  layout.frame = {left, top, plot.width - margin_right, plot.height - margin_bottom};
  layout.x.from = layout.frame.x0;
  layout.x.to = layout.frame.x1;
  layout.y.from = layout.frame.y1;
  layout.y.to = layout.frame.y0;
  return layout;
}

void draw_grid(Image& image, const Axis& axis, bool of_x, const Box& frame) {
  const auto line = [&](double value, Color color) {
    const double p = std::floor(place(axis, value));
    fill_box(image, of_x ? Box{p, frame.y0, p + 1, frame.y1} : Box{frame.x0, p, frame.x1, p + 1},
             color);
  };
  if (axis.logarithmic && axis.max / axis.min < 1e5)
    for (const double tick : decade_ticks(axis.min, axis.max, {2, 3, 4, 5, 6, 7, 8, 9}, 1))
      line(tick, {0.92f, 0.92f, 0.93f});
  for (const double tick : plot_ticks(axis.min, axis.max, axis.logarithmic)) {
    line(tick, grid_color);
    const std::string label = format_tick(tick);
    const double p = place(axis, tick), width = text_width(label, text_scale);
    const Point at =
        of_x ? Point{std::round(p - width / 2), frame.y1 + 8}
             : Point{std::round(frame.x0 - width - 7), std::round(p - text_height(text_scale) / 2)};
    draw_text(image, at, label, text_scale, ink);
  }
}

void draw_frame(Image& image, const Plot& plot, const Box& frame) {
  fill_box(image, {frame.x0 - 1, frame.y0 - 1, frame.x0, frame.y1 + 1}, ink);
  fill_box(image, {frame.x1, frame.y0 - 1, frame.x1 + 1, frame.y1 + 1}, ink);
  fill_box(image, {frame.x0, frame.y0 - 1, frame.x1, frame.y0}, ink);
  fill_box(image, {frame.x0, frame.y1, frame.x1, frame.y1 + 1}, ink);
  const double x = (frame.x0 + frame.x1) / 2, y = (frame.y0 + frame.y1) / 2;
  draw_text(image, {std::round(x - text_width(plot.title, title_scale) / 2), 12}, plot.title,
            title_scale, ink);
  draw_text(image, {std::round(x - text_width(plot.x_label, text_scale) / 2), plot.height - 20.0},
            plot.x_label, text_scale, ink);
  draw_text(image, {10, std::round(y + text_width(plot.y_label, text_scale) / 2)}, plot.y_label,
            text_scale, ink, true);
}

// Shown points in pixels; a line's parts between points that are not shown.
std::vector<std::vector<Point>> place_series(const Plot& plot, const PlotSeries& series,
                                             const Layout& layout) {
  std::vector<std::vector<Point>> parts(1);
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (is_shown(series.x[i], plot.log_x) && is_shown(series.y[i], plot.log_y))
      parts.back().push_back({place(layout.x, series.x[i]), place(layout.y, series.y[i])});
    else if (!parts.back().empty())
      parts.emplace_back();
  }
  return parts;
}

void draw_series(Image& image, const Plot& plot, const PlotSeries& series, const Layout& layout) {
  const double size = series.size > 0 ? series.size : series.points ? 5 : 2;
  for (const auto& part : place_series(plot, series, layout)) {
    if (!series.points) draw_polyline(image, part, size, series.color, layout.frame);
    for (std::size_t i = 0; series.points && i < part.size(); ++i)
      draw_dot(image, part[i], size / 2, series.color, series.alpha, layout.frame);
  }
}

// The corner of the frame in which a box of this size hides the fewest points.
Box find_legend_box(const Plot& plot, const Layout& layout, double width, double height) {
  const Box& f = layout.frame;
  const double gap = 10;
  Box best;
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (const bool low : {false, true})
    for (const bool left : {false, true}) {
      const double x = left ? f.x0 + gap : f.x1 - gap - width;
      const double y = low ? f.y1 - gap - height : f.y0 + gap;
      std::size_t hidden = 0;
      for (const PlotSeries& series : plot.series)
        for (const auto& part : place_series(plot, series, layout))
          for (const Point p : part)
            hidden +=
                p.x > x - gap && p.x < x + width + gap && p.y > y - gap && p.y < y + height + gap;
      if (hidden >= fewest) continue;
      fewest = hidden;
      best = {x, y, x + width, y + height};
    }
  return best;
}

void draw_legend(Image& image, const Plot& plot, const Layout& layout) {
  constexpr double line_height = 18, sample = 26, pad = 8;
  double widest = 0;
  int lines = 0;
  for (const PlotSeries& series : plot.series) {
    if (series.label.empty()) continue;
    widest = std::max(widest, text_width(series.label, text_scale));
    ++lines;
  }
  if (lines == 0) return;
  const Box box = find_legend_box(plot, layout, std::ceil(widest) + sample + 3 * pad,
                                  lines * line_height + pad);
  fill_box(image, {box.x0 - 1, box.y0 - 1, box.x1 + 1, box.y1 + 1}, grid_color);
  fill_box(image, box, white);
  double y = box.y0 + pad / 2 + line_height / 2;
  for (const PlotSeries& series : plot.series) {
    if (series.label.empty()) continue;
    const double x = box.x0 + pad;
    if (series.points)
      draw_dot(image, {x + sample / 2, y}, 3, series.color, 1, box);
    else
      draw_polyline(image, {{x, y}, {x + sample, y}}, 2.5, series.color, box);
    draw_text(image, {x + sample + pad, std::round(y - text_height(text_scale) / 2)}, series.label,
              text_scale, ink);
    y += line_height;
  }
}

}  // namespace

std::vector<double> plot_ticks(double min, double max, bool logarithmic) {
  std::vector<double> ticks;
  if (logarithmic) {
    const double decades = std::log10(max / min);
    ticks = decade_ticks(min, max, {1}, std::max(1, static_cast<int>(decades / 7)));
    if (ticks.size() < 3) ticks = decade_ticks(min, max, {1, 2, 5}, 1);
    if (ticks.size() >= 2) return ticks;
    ticks.clear();
  }
  const double raw = (max - min) / 6;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  const double step = raw <= decade       ? decade
                      : raw <= 2 * decade ? 2 * decade
                      : raw <= 5 * decade ? 5 * decade
                                          : 10 * decade;
  add_steps(min, max, step, ticks);
  return ticks;
}

std::string format_tick(double value) {
  const double size = std::abs(value);
  if (size == 0 || (size >= 1e-3 && size < 1e5)) return fmt::format("{:.6g}", value);
  const int exponent = static_cast<int>(std::floor(std::log10(size) + 1e-9));
  return fmt::format("{:.4g}e{}", value / std::pow(10.0, exponent), exponent);
}

Image draw_plot(const Plot& plot) {
  PARIAN_CHECK_LE(160, plot.width);
  PARIAN_CHECK_LE(120, plot.height);
  for (const PlotSeries& series : plot.series) PARIAN_CHECK_EQ(series.x.size(), series.y.size());
  Image image = make_image(plot.width, plot.height, 3, 1);
  const Layout layout = make_layout(plot);
  draw_grid(image, layout.x, true, layout.frame);
  draw_grid(image, layout.y, false, layout.frame);
  for (const PlotSeries& series : plot.series) draw_series(image, plot, series, layout);
  draw_frame(image, plot, layout.frame);
  draw_legend(image, plot, layout);
  return image;
}

}  // namespace parian

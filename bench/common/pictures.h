// Pictures of R_d with axes and colour bars, and pages of several.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "image/image.h"
#include "judge/canvas.h"
#include "material/bssrdf_table.h"
#include "material/profile_map.h"

namespace parian {

// R_d between pixel (x, y) and (x + d), in either half plane; NaN where the table has none.
double table_value(const BssrdfTable& table, int channel, int x, int y, Offset d);
// The same of the model (Eq. 3), within the grid.
double model_value(const ProfileMap& map, int channel, int x, int y, Offset d);

// A colour scale: what is shown at its ends, and colours in between.
struct ColorScale {
  double min = 0, max = 1;
  bool logarithmic = false;
  bool diverging = false;  // blue below, white in the middle, red above; else judge/false_color.h
  std::string label;
};
ColorScale log_scale(double max, double decades, std::string label);
ColorScale diverging_scale(double max, std::string label);
// Linear Rec. 709; NaN is light grey.
Color color_of(const ColorScale& scale, double value);

// One channel of values as colours, magnified.
Image colorize(const Image& values, const ColorScale& scale, int magnification);

inline constexpr int panel_margin = 58, panel_top = 26;
struct Panel {
  Image picture;
  std::string title, x_label, y_label;  // empty: neither label nor tick labels of that axis
  double left = 0, right = 1, top = 0, bottom = 1;  // what the edges stand for
  // The picture begins at (margin_left, panel_top) of the result.
  int margin_left = panel_margin;
};
Image draw_panel(const Panel& panel);
Image draw_color_bar(const ColorScale& scale, int height);

// A dot with a white rim at a pixel of a panel's picture.
void mark_pixel(Image& panel, double x, double y, int magnification, Color color);

// Coloured strokes with their meaning in one row, for plots without an empty corner.
struct LegendEntry {
  std::string label;
  Color color;
};
Image draw_legend(const std::vector<LegendEntry>& entries, int width);

// Rows of images, each aligned at the top, on white.
Image arrange(const std::vector<std::vector<Image>>& rows, int gap = 10);

}  // namespace parian

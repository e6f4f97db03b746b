// Plots as images: curves and points on linear or logarithmic axes, with labels. For profile plots
// (data against model) and the error curves of the docs.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/progress.h"
#include "image/image.h"
#include "material/material.h"
#include "material/slices.h"

namespace parian {

struct PlotSeries {
  std::string label;  // empty: not in the legend
  std::vector<double> x, y;
  std::array<float, 3> color{0, 0, 0};  // linear Rec. 709
  bool points = false;                  // dots instead of a line
  double size = 0;                      // line width or dot diameter in pixels; 0: 2 and 5
  double alpha = 1;                     // of dots
};

struct Plot {
  std::string title, x_label, y_label;  // printable ASCII
  bool log_x = false, log_y = false;
  std::vector<PlotSeries> series;
  int width = 640, height = 420;
};

// 3 channels, white ground. Later series lie on top. Values that are not finite, or not positive on
// a logarithmic axis, are left out; a line breaks there.
Image draw_plot(const Plot& plot);

// Values at which an axis is labelled: 1-2-5 steps, or decades where there are enough of them.
std::vector<double> plot_ticks(double min, double max, bool logarithmic);
std::string format_tick(double value);

struct PlotPixel {
  int x = 0, y = 0;
};

// Data against model around each pixel over r, of one channel, on a logarithmic axis: measured
// values R_d of all pairs in which the pixel takes part as grey dots, the model's values at the
// same pairs as coloured dots, and the pixel's own profile P(r) as a line where the material has
// one (`material` may be null). Reads the channel's slices once. Throws Error for a pixel outside
// the grid.
std::vector<Image> plot_profiles(const SliceSource& table, const SliceSource& model,
                                 const Material* material, const std::vector<PlotPixel>& pixels,
                                 int channel, const Progress& progress = {});

}  // namespace parian

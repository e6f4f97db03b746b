// Plots as images: curves and points on linear or logarithmic axes, with labels. For profile plots
// (data against model) and the error curves of the docs.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "image/image.h"
#include "material/profile_map.h"
#include "material/slices.h"

namespace parian {

struct PlotSeries {
  std::string label;
  std::vector<double> x, y;
  std::array<float, 3> color{0, 0, 0};  // linear Rec. 709
  bool points = false;                  // dots instead of a line
};

struct Plot {
  std::string title, x_label, y_label;
  bool log_x = false, log_y = false;
  std::vector<PlotSeries> series;
  int width = 640, height = 420;
};

// Values that are not finite, or not positive on a logarithmic axis, are left out.
Image draw_plot(const Plot& plot);

struct PlotPixel {
  int x = 0, y = 0;
};

// Data against model around each pixel over r: measured values R_d as dots, the model's values at
// the same pairs as dots, and the pixel's own profile P(r) as a line where the material has one.
std::vector<Image> plot_profiles(const SliceSource& table, const SliceSource& model,
                                 const ProfileMap* map, const std::vector<PlotPixel>& pixels,
                                 int channel);

}  // namespace parian

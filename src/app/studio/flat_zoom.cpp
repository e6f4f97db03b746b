#include "app/studio/flat_zoom.h"

#include <algorithm>

namespace parian {
namespace {

constexpr double largest_pixel = 64;
constexpr double least_pixel = 0.02;  // however small the room is

double whole_pixel(int columns, int rows, double width, double height) {
  return std::max(least_pixel, std::min(width / columns, height / rows));
}

}  // namespace

FlatPlace place_flat(const FlatZoom& zoom, int columns, int rows, double width, double height) {
  FlatPlace place;
  place.pixel = zoom.factor * whole_pixel(columns, rows, width, height);
  place.x = width / 2 - zoom.center_x * place.pixel * columns;
  place.y = height / 2 - zoom.center_y * place.pixel * rows;
  return place;
}

FlatZoom zoom_flat(const FlatZoom& zoom, double factor, double x, double y, int columns, int rows,
                   double width, double height) {
  const FlatPlace before = place_flat(zoom, columns, rows, width, height);
  const double whole = whole_pixel(columns, rows, width, height);
  FlatZoom zoomed = zoom;
  zoomed.factor = std::clamp(zoom.factor * factor, 1.0, std::max(1.0, largest_pixel / whole));
  if (zoomed.factor == 1) return {};
  const double pixel = zoomed.factor * whole;
  zoomed.center_x = ((x - before.x) / before.pixel - (x - width / 2) / pixel) / columns;
  zoomed.center_y = ((y - before.y) / before.pixel - (y - height / 2) / pixel) / rows;
  return pan_flat(zoomed, 0, 0, columns, rows, width, height);
}

FlatZoom pan_flat(const FlatZoom& zoom, double dx, double dy, int columns, int rows, double width,
                  double height) {
  if (zoom.factor == 1) return zoom;
  FlatZoom panned = zoom;
  const double pixel = zoom.factor * whole_pixel(columns, rows, width, height);
  panned.center_x = std::clamp(zoom.center_x - dx / (pixel * columns), 0.0, 1.0);
  panned.center_y = std::clamp(zoom.center_y - dy / (pixel * rows), 0.0, 1.0);
  return panned;
}

}  // namespace parian

#include "app/studio/flat_zoom.h"

#include <algorithm>
#include <cmath>

namespace parian {
namespace {

constexpr double largest_pixel = 64;
constexpr double least_pixel = 0.02;  // however small the room is

double whole_pixel(int columns, int rows, double width, double height) {
  return std::max(least_pixel, std::min(width / columns, height / rows));
}

// Of the corner along one side: in the middle where the map is smaller than the room, else so that
// it covers it.
double place_side(double center, double size, double room) {
  if (size <= room) return std::floor((room - size) / 2);
  return std::clamp(room / 2 - center * size, room - size, 0.0);
}

double center_of(double corner, double size, double room) {
  return size <= room ? 0.5 : (room / 2 - corner) / size;
}

}  // namespace

FlatPlace place_flat(const FlatZoom& zoom, int columns, int rows, double width, double height) {
  FlatPlace place;
  place.pixel = zoom.factor * whole_pixel(columns, rows, width, height);
  place.x = place_side(zoom.center_x, place.pixel * columns, width);
  place.y = place_side(zoom.center_y, place.pixel * rows, height);
  return place;
}

FlatZoom zoom_flat(const FlatZoom& zoom, double factor, double x, double y, int columns, int rows,
                   double width, double height) {
  const FlatPlace before = place_flat(zoom, columns, rows, width, height);
  const double whole = whole_pixel(columns, rows, width, height);
  FlatZoom zoomed = zoom;
  zoomed.factor = std::clamp(zoom.factor * factor, 1.0, std::max(1.0, largest_pixel / whole));
  const double pixel = zoomed.factor * whole;
  const double corner_x = x - (x - before.x) / before.pixel * pixel,
               corner_y = y - (y - before.y) / before.pixel * pixel;
  zoomed.center_x = center_of(corner_x, pixel * columns, width);
  zoomed.center_y = center_of(corner_y, pixel * rows, height);
  return pan_flat(zoomed, 0, 0, columns, rows, width, height);
}

FlatZoom pan_flat(const FlatZoom& zoom, double dx, double dy, int columns, int rows, double width,
                  double height) {
  FlatZoom panned = zoom;
  const double pixel = zoom.factor * whole_pixel(columns, rows, width, height);
  panned.center_x -= dx / (pixel * columns);
  panned.center_y -= dy / (pixel * rows);
  // What cannot be seen is not kept, so that panning back starts at once.
  const FlatPlace place = place_flat(panned, columns, rows, width, height);
  panned.center_x = center_of(place.x, pixel * columns, width);
  panned.center_y = center_of(place.y, pixel * rows, height);
  return panned;
}

}  // namespace parian

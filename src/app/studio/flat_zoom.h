// Which part of the map its flat view shows.
#pragma once

namespace parian {

// 1: all of it, in the middle of the room.
struct FlatZoom {
  double factor = 1;
  double center_x = 0.5, center_y = 0.5;  // parts of the map, in the middle of the room
  friend bool operator==(const FlatZoom&, const FlatZoom&) = default;
};

// Pixels of the screen: where the map's upper left corner is in the room, and how large one of its
// pixels is.
struct FlatPlace {
  double x = 0, y = 0;
  double pixel = 1;
};

// Of a map of columns x rows pixels in a room of width x height.
FlatPlace place_flat(const FlatZoom& zoom, int columns, int rows, double width, double height);

// By a factor, up to pixels of 64 x 64 and down to all of the map; what is at (x, y) in the room
// stays there.
FlatZoom zoom_flat(const FlatZoom& zoom, double factor, double x, double y, int columns, int rows,
                   double width, double height);
// What is seen moves by that many pixels of the screen; the map does not leave the middle of the
// room.
FlatZoom pan_flat(const FlatZoom& zoom, double dx, double dy, int columns, int rows, double width,
                  double height);

}  // namespace parian

// Shapes drawn into masks, in pixels: pixel (x, y) covers [x, x + 1) x [y, y + 1). A pixel's weight
// is the part of it that the shape covers, from 4 x 4 points; shapes join what is there (the larger
// weight). Coordinates are finite; a shape without area, or all outside, draws nothing.
#pragma once

#include <vector>

#include "edit/mask.h"

namespace parian {

struct Point2 {
  double x = 0;
  double y = 0;
};

void draw_rectangle(Mask& mask, Point2 min, Point2 max);
// Semi-axes along x and y, turned from x to y.
void draw_ellipse(Mask& mask, Point2 center, Point2 radii, double rotation_deg);
// Inside by the even-odd rule.
void draw_polygon(Mask& mask, const std::vector<Point2>& points);
// A round brush along a line: 1 up to hardness times the radius (hardness in [0, 1]), falling
// smoothly to 0 at the radius, by the distance to the whole line: where it crosses itself nothing
// adds up. A single point is a dab.
void draw_stroke(Mask& mask, const std::vector<Point2>& points, double radius, double hardness);
// From 0 at `from` to 1 at `to`, smooth (3 t^2 - 2 t^3) and constant across.
void draw_gradient(Mask& mask, Point2 from, Point2 to);

}  // namespace parian

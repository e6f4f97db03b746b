// Drawing on images with anti-aliasing: rectangles, lines, dots and text. Pixel (0,0) covers the
// square from (0,0) to (1,1); colours are linear Rec. 709, and images have 3 channels.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "image/image.h"

namespace parian {

using Color = std::array<float, 3>;

struct Point {
  double x = 0, y = 0;
};

struct Box {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

void fill_box(Image& image, Box box, Color color, double alpha = 1);
void draw_dot(Image& image, Point centre, double radius, Color color, double alpha, Box clip);
// Joined segments, none drawn twice where they meet.
void draw_polyline(Image& image, const std::vector<Point>& points, double width, Color color,
                   Box clip);

// Printable ASCII in one line, `scale` pixels per unit of the font, whose capitals are 7 units
// high; other characters become '?'. (x, y) is the top left corner, or, of vertical text, which
// reads upwards, the bottom left corner.
void draw_text(Image& image, Point at, const std::string& text, double scale, Color color,
               bool vertical = false);
double text_width(const std::string& text, double scale);
inline double text_height(double scale) {
  return 7 * scale;
}

}  // namespace parian

// What is drawn over the flat view: shapes and strokes of the selected layer.
#pragma once

#include <imgui.h>

#include "app/studio/studio.h"

namespace parian {

// From the map's mm to the screen.
struct FlatFrame {
  ImVec2 origin;
  float per_mm = 1;
  ImVec2 to_screen(double x, double y) const {
    return {origin.x + static_cast<float>(x) * per_mm, origin.y + static_cast<float>(y) * per_mm};
  }
};

void draw_selection(const Studio& studio, const FlatFrame& frame);
// What the tool `select` would make of the line that is drawn.
void draw_present_selection(const Studio& studio, const FlatFrame& frame);

}  // namespace parian

// What a scripted run sees of the window: a JSON file with the editor's state and where its widgets
// are on the screen, rewritten when it changes. Off unless a path is given.
#pragma once

#include <map>
#include <string>

#include "app/studio/studio.h"

namespace parian {

struct WidgetBox {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // window pixels
};

struct Probe {
  std::string path;
  std::map<std::string, WidgetBox> widgets;  // of the present frame
  std::string last;
  double last_s = -1;
};

// The item that ImGui drew last.
void mark(Probe& probe, const std::string& name);
// At the end of a frame.
void write_probe(Probe& probe, const Studio& studio);

}  // namespace parian

// What a scripted run sees of the window: a JSON file with the editor's state and where its widgets
// are on the screen, rewritten when it changes. Off unless a path is given.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "app/studio/studio.h"

namespace parian {

struct WidgetBox {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // window pixels
  friend bool operator==(const WidgetBox&, const WidgetBox&) = default;
};

// What the window has taken in so far: a script waits for it instead of for time to pass.
struct ProbeInput {
  float mouse_x = 0, mouse_y = 0;
  bool is_down = false;       // any mouse button
  std::uint64_t keys = 0;     // pressed and handled
  std::uint64_t presses = 0;  // of mouse buttons
  int width = 0, height = 0;  // of the window
  bool has_popup = false;
};

struct Probe {
  std::string path;
  ProbeInput input;
  double first_picture_s = -1;  // from the program's start
  double flat_zoom = 1;
  std::map<std::string, WidgetBox> widgets;   // of the present frame
  std::map<std::string, WidgetBox> previous;  // of the one before: what moves cannot be clicked
  std::string last;
  double last_s = -1;
  std::shared_ptr<const Picture> seen;  // whose brightness this is
  double brightness = 0;
};

// At the end of a frame.
void write_probe(Probe& probe, const Studio& studio);

}  // namespace parian

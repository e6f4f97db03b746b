// How long work tells its caller where it is, and learns that it should stop. Algorithms never
// print: the command line draws a bar, the editor a widget.
#pragma once

#include <functional>
#include <string_view>

namespace parian {

// Both functions may be empty. They are called from the thread that called the algorithm.
struct Progress {
  // A stage's name and how much of it is done, 0 to 1.
  std::function<void(std::string_view stage, double done)> report;
  std::function<bool()> is_cancelled;
};

// Reports, and throws make_cancelled_error() when the caller asked to stop.
void advance_progress(const Progress& progress, std::string_view stage, double done);

}  // namespace parian

// The desktop editor.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace parian {

struct StudioOptions {
  std::vector<std::string> files;  // opened at the start
  std::string data_folder;         // bundled samples
  std::string state_folder;        // recent files and autosave; empty: the user's own
  std::string probe;               // for scripted runs (app/studio/probe.h)
  std::string screenshots;         // folder that F12 writes to; empty: the working folder
  int width = 1440, height = 900;
  double scale = 0;  // of text and widgets; 0: the display's
  // Ends the editor at once when it says true; what was not saved is offered again next time.
  std::function<bool()> is_cancelled;
};

// Until its window is closed. Throws Error(resource) where there is no display or no OpenGL.
void run_studio(const StudioOptions& options);

}  // namespace parian

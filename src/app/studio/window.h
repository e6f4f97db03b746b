// A window with an OpenGL context and Dear ImGui in it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace parian {

// A key that went down: capital letters and digits as they are printed on it, else GLFW's code.
struct KeyPress {
  int key = 0;
  bool control = false, shift = false;
};

struct WindowParams {
  int width = 1440, height = 900;
  double scale = 0;  // of text and widgets; 0: the display's
  std::string title;
  // Files dropped on the window.
  std::function<void(const std::vector<std::string>& paths)> on_drop;
};

class Window {
 public:
  // Throws Error(resource) naming what is missing: a display, OpenGL.
  explicit Window(const WindowParams& params);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // Events, then a new frame of ImGui. Waits up to `timeout_s` where nothing happens.
  void begin_frame(double timeout_s);
  // Ends a wait of begin_frame. From any thread, while the window lives.
  static void wake();
  void draw_frame();
  void show_frame();
  // Since the last frame, in order: none is lost, however short.
  std::vector<KeyPress> take_keys();
  bool wants_close() const;
  void keep_open();  // takes back what wants_close says
  void set_title(const std::string& title);
  double scale() const;  // of the display: 1 for about 96 dpi
  // Of the frame that is drawn and not yet shown, RGBA, row 0 on top.
  std::vector<std::uint8_t> read_frame(int& width, int& height) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

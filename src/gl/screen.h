// What a window's own picture needs of OpenGL: the frame itself, and pictures to show in it. All
// need the window's context to be current.
#pragma once

#include <cstdint>
#include <vector>

#include "gl/objects.h"

namespace parian {

// Black; all of it becomes the viewport.
void clear_screen(int width, int height);
// Of the frame that is drawn and not yet shown: [y][x][RGBA], row 0 on top.
std::vector<std::uint8_t> read_screen(int width, int height);

// Pixels on the graphics device that a user interface shows.
class ScreenTexture {
 public:
  // [y][x][RGBA], row 0 on top. `smooth`: linear between pixels where they are enlarged.
  void upload(const std::vector<std::uint8_t>& rgba, int width, int height, bool smooth);
  void* id() const;  // as user interfaces pass OpenGL's names around
  int width() const { return width_; }
  int height() const { return height_; }

 private:
  GlHandle<destroy_texture> handle_;
  int width_ = 0, height_ = 0;
};

}  // namespace parian

#include "gl/screen.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cstddef>

#include "base/check.h"

namespace parian {

void clear_screen(int width, int height) {
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
}

std::vector<std::uint8_t> read_screen(int width, int height) {
  const std::size_t row = 4 * static_cast<std::size_t>(width);
  const auto rows = static_cast<std::size_t>(height);
  std::vector<std::uint8_t> upside_down(row * rows), rgba(row * rows);
  glReadBuffer(GL_BACK);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, upside_down.data());
  for (std::size_t y = 0; y < rows; ++y)
    std::copy_n(upside_down.data() + (rows - 1 - y) * row, row, rgba.data() + y * row);
  return rgba;
}

void ScreenTexture::upload(const std::vector<std::uint8_t>& rgba, int width, int height,
                           bool smooth) {
  PARIAN_CHECK(rgba.size() ==
               4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (handle_.get() == 0) {
    GLuint name = 0;
    glGenTextures(1, &name);
    handle_ = GlHandle<destroy_texture>(name);
  }
  width_ = width;
  height_ = height;
  glBindTexture(GL_TEXTURE_2D, handle_.get());
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, smooth ? GL_LINEAR : GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
               rgba.data());
}

void* ScreenTexture::id() const {
  return std::bit_cast<void*>(static_cast<std::uintptr_t>(handle_.get()));
}

}  // namespace parian

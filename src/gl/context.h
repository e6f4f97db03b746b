// An OpenGL ES 3.0 context without a window, through EGL. Everything in gl/ runs in the context
// that is current; a window's context (the editor's) serves as well.
#pragma once

#include <memory>
#include <string>

namespace parian {

// What the current context can do, as far as the renderer depends on it.
struct GlLimits {
  std::string renderer;  // the driver's name of itself
  std::string version;
  int max_texture_size = 0;
  int max_array_layers = 0;
  int max_draw_buffers = 0;
  bool float_blend = false;  // sums in 32 bits; otherwise in 16
};
// Of the current context. Throws Error(resource) where it is older than OpenGL ES 3.0 or cannot
// draw to float textures (EXT_color_buffer_float).
GlLimits query_limits();

// Current in the thread that made it until it is destroyed.
class OffscreenContext {
 public:
  // A hardware device where there is one, otherwise the software rasteriser. Throws Error(resource)
  // naming what is missing: libraries, a display, a context of version 3.0, float targets.
  OffscreenContext();
  ~OffscreenContext();
  OffscreenContext(OffscreenContext&&) noexcept;
  OffscreenContext& operator=(OffscreenContext&&) noexcept;

  const GlLimits& limits() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

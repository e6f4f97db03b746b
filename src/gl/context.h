// An OpenGL context without a window, through EGL. Everything in gl/ runs in the context
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
// What a context says of itself; `version` is 30 for 3.0.
struct GlFeatures {
  bool is_desktop = false;
  int version = 30;
  bool color_buffer_float = true;  // EXT_color_buffer_float
};
// Throws Error(resource) for a context older than OpenGL ES 3.0 or OpenGL 3.3, or one that cannot
// draw to float textures.
void check_features(const GlFeatures& features, const GlLimits& limits);

// Of the current context. Throws as check_features.
GlLimits query_limits();

// Mesa's rasterisers for the CPU, by GlLimits::renderer.
bool is_software(const std::string& renderer);

// ES 3.0, or the core profile of OpenGL 3.3.
enum class ContextKind { embedded, desktop };

// Current in the thread that made it until it is destroyed.
class OffscreenContext {
 public:
  // A hardware device where there is one, otherwise the software rasteriser. Throws Error(resource)
  // naming what is missing: libraries, a display, a context of that version, float targets.
  explicit OffscreenContext(ContextKind kind = ContextKind::embedded);
  ~OffscreenContext();
  OffscreenContext(OffscreenContext&&) noexcept;
  OffscreenContext& operator=(OffscreenContext&&) noexcept;

  const GlLimits& limits() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace parian

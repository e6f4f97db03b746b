#include "gl/context.h"

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <fmt/format.h>

#include <array>
#include <vector>

#include "base/error.h"

namespace parian {
namespace {

[[noreturn]] void fail(std::string expected, std::string found) {
  throw Error({{}, "OpenGL", std::move(expected), std::move(found)}, ErrorKind::resource);
}

// The loader ends the program where a library is missing, so they are looked for first.
void check_library(const char* name, const char* package) {
  void* library = dlopen(name, RTLD_LAZY | RTLD_LOCAL);
  if (library == nullptr) fail(fmt::format("the library {} ({})", name, package), "none");
  dlclose(library);
}

bool has_client_extension(const char* name) {
  return epoxy_has_egl_extension(EGL_NO_DISPLAY, name);
}

// Hardware first, then Mesa without any surface, then software devices.
std::vector<EGLDisplay> list_displays() {
  std::vector<EGLDisplay> displays, software;
  if (has_client_extension("EGL_EXT_device_enumeration") &&
      has_client_extension("EGL_EXT_platform_device")) {
    std::array<EGLDeviceEXT, 16> devices{};
    EGLint count = 0;
    if (eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count) == 0)
      count = 0;
    for (EGLint i = 0; i < count; ++i) {
      const EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
      const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
      const bool is_software =
          extensions != nullptr &&
          std::string(extensions).find("EGL_MESA_device_software") != std::string::npos;
      (is_software ? software : displays)
          .push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr));
    }
  }
  if (has_client_extension("EGL_MESA_platform_surfaceless"))
    displays.push_back(
        eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
  displays.insert(displays.end(), software.begin(), software.end());
  return displays;
}

// Null where the display gives none.
EGLContext make_context(EGLDisplay display, ContextKind kind) {
  const bool is_desktop = kind == ContextKind::desktop;
  if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context")) return EGL_NO_CONTEXT;
  if (eglBindAPI(is_desktop ? EGL_OPENGL_API : EGL_OPENGL_ES_API) == 0) return EGL_NO_CONTEXT;
  const std::array<EGLint, 5> wanted{EGL_RENDERABLE_TYPE,
                                     is_desktop ? EGL_OPENGL_BIT : EGL_OPENGL_ES3_BIT,
                                     EGL_SURFACE_TYPE, 0, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(display, wanted.data(), &config, 1, &count) == 0 || count == 0)
    return EGL_NO_CONTEXT;
  constexpr std::array<EGLint, 3> embedded{EGL_CONTEXT_CLIENT_VERSION, 3, EGL_NONE};
  constexpr std::array<EGLint, 7> core{EGL_CONTEXT_MAJOR_VERSION,
                                       3,
                                       EGL_CONTEXT_MINOR_VERSION,
                                       3,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                       EGL_NONE};
  const EGLContext context =
      eglCreateContext(display, config, EGL_NO_CONTEXT, is_desktop ? core.data() : embedded.data());
  if (context == EGL_NO_CONTEXT) return context;
  if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != 0) return context;
  eglDestroyContext(display, context);
  return EGL_NO_CONTEXT;
}

int get_integer(GLenum name) {
  GLint value = 0;
  glGetIntegerv(name, &value);
  return value;
}

std::string get_string(GLenum name) {
  const auto* text = reinterpret_cast<const char*>(glGetString(name));
  return text != nullptr ? text : "nothing";
}

}  // namespace

void check_features(const GlFeatures& features, const GlLimits& limits) {
  if (features.version < (features.is_desktop ? 33 : 30))
    fail("OpenGL ES 3.0 or OpenGL 3.3", fmt::format("'{}'", limits.version));
  if (!features.is_desktop && !features.color_buffer_float)
    fail("the extension EXT_color_buffer_float", fmt::format("'{}' without", limits.renderer));
}

bool is_software(const std::string& renderer) {
  const auto is_called = [&](const char* name) { return renderer.find(name) != std::string::npos; };
  return is_called("llvmpipe") || is_called("softpipe") || is_called("swrast");
}

GlLimits query_limits() {
  GlLimits limits;
  limits.renderer = get_string(GL_RENDERER);
  limits.version = get_string(GL_VERSION);
  const GlFeatures features{epoxy_is_desktop_gl(), epoxy_gl_version(),
                            epoxy_has_gl_extension("GL_EXT_color_buffer_float")};
  check_features(features, limits);
  limits.float_blend = features.is_desktop || epoxy_has_gl_extension("GL_EXT_float_blend");
  limits.max_texture_size = get_integer(GL_MAX_TEXTURE_SIZE);
  limits.max_array_layers = get_integer(GL_MAX_ARRAY_TEXTURE_LAYERS);
  limits.max_draw_buffers = get_integer(GL_MAX_DRAW_BUFFERS);
  return limits;
}

struct OffscreenContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  ContextKind kind = ContextKind::embedded;
  GlLimits limits;

  // The display stays initialised: other contexts of the process may share it.
  ~Impl() {
    if (context == EGL_NO_CONTEXT) return;
    // Which context is current is kept for each kind.
    eglBindAPI(kind == ContextKind::desktop ? EGL_OPENGL_API : EGL_OPENGL_ES_API);
    if (eglGetCurrentContext() == context)
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display, context);
  }
};

OffscreenContext::OffscreenContext(ContextKind kind) : impl_(std::make_unique<Impl>()) {
  impl_->kind = kind;
  check_library("libEGL.so.1", "libegl1");
  check_library("libGLESv2.so.2", "libgles2");
  for (EGLDisplay display : list_displays()) {
    if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == 0) continue;
    impl_->context = make_context(display, kind);
    impl_->display = display;
    if (impl_->context == EGL_NO_CONTEXT) continue;
    impl_->limits = query_limits();
    return;
  }
  fail(fmt::format("a display for {} (a graphics driver, or libegl-mesa0 and libgl1-mesa-dri)",
                   kind == ContextKind::desktop ? "OpenGL 3.3" : "OpenGL ES 3.0"),
       "none");
}

OffscreenContext::~OffscreenContext() = default;
OffscreenContext::OffscreenContext(OffscreenContext&&) noexcept = default;
OffscreenContext& OffscreenContext::operator=(OffscreenContext&&) noexcept = default;

const GlLimits& OffscreenContext::limits() const {
  return impl_->limits;
}

}  // namespace parian

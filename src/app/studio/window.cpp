#include "app/studio/window.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "app/studio/theme.h"
#include "base/error.h"
#include "gl/screen.h"

namespace parian {
namespace {

std::string last_glfw_error() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text != nullptr ? text : "no reason given";
}

struct Version {
  int client, major, minor;
  const char* shaders;
};
// The editor's own drawing is content with either.
constexpr std::array<Version, 2> versions{
    Version{GLFW_OPENGL_API, 3, 3, "#version 330 core"},
    Version{GLFW_OPENGL_ES_API, 3, 0, "#version 300 es"},
};

// What is printed on the key, where that is a letter or digit.
int printed_key(int key, int scancode) {
  const char* name = glfwGetKeyName(key, scancode);
  if (name == nullptr || name[0] == 0 || name[1] != 0) return key;
  return std::toupper(static_cast<unsigned char>(name[0]));
}

}  // namespace

struct Window::Impl {
  WindowParams params;
  GLFWwindow* window = nullptr;
  double scale = 1;
  std::vector<KeyPress> keys;
  // ImGui looks at which keys are down once a frame: releases wait for the next one, so that short
  // presses are seen.
  struct Release {
    int key, scancode, mods;
  };
  std::vector<Release> releases;
};

Window::Window(const WindowParams& params) : impl_(std::make_unique<Impl>()) {
  impl_->params = params;
  if (glfwInit() == 0)
    throw Error(
        {{}, "display", "a display for windows (DISPLAY or WAYLAND_DISPLAY)", last_glfw_error()},
        ErrorKind::resource);
  const char* shaders = nullptr;
  for (const Version& version : versions) {
    glfwDefaultWindowHints();
    glfwWindowHint(GLFW_CLIENT_API, version.client);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, version.major);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, version.minor);
    if (version.client == GLFW_OPENGL_API)
      glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SCALE_TO_MONITOR, GLFW_TRUE);
    impl_->window =
        glfwCreateWindow(params.width, params.height, params.title.c_str(), nullptr, nullptr);
    shaders = version.shaders;
    if (impl_->window != nullptr) break;
  }
  if (impl_->window == nullptr) {
    const std::string reason = last_glfw_error();
    glfwTerminate();
    throw Error({{}, "display", "OpenGL 3.3 or OpenGL ES 3.0", reason}, ErrorKind::resource);
  }
  glfwMakeContextCurrent(impl_->window);
  glfwSwapInterval(1);
  glfwSetWindowUserPointer(impl_->window, impl_.get());
  glfwSetDropCallback(impl_->window, [](GLFWwindow* window, int count, const char** paths) {
    const auto* impl = static_cast<Impl*>(glfwGetWindowUserPointer(window));
    if (impl->params.on_drop) impl->params.on_drop({paths, paths + count});
  });
  float x = 1, y = 1;
  glfwGetWindowContentScale(impl_->window, &x, &y);
  const double scale = params.scale > 0 ? params.scale : static_cast<double>(x);
  impl_->scale = std::clamp(scale, 0.5, 4.0);
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;
  ImGui::GetIO().ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  set_theme(static_cast<float>(impl_->scale));
  ImGui_ImplGlfw_InitForOpenGL(impl_->window, true);
  ImGui_ImplOpenGL3_Init(shaders);
  glfwSetKeyCallback(
      impl_->window, [](GLFWwindow* window, int key, int scancode, int action, int mods) {
        auto* impl = static_cast<Impl*>(glfwGetWindowUserPointer(window));
        if (action == GLFW_RELEASE) return impl->releases.push_back({key, scancode, mods});
        ImGui_ImplGlfw_KeyCallback(window, key, scancode, action, mods);
        if (action == GLFW_PRESS)
          impl->keys.push_back({printed_key(key, scancode), (mods & GLFW_MOD_CONTROL) != 0,
                                (mods & GLFW_MOD_SHIFT) != 0});
      });
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(impl_->window);
  glfwTerminate();
}

void Window::begin_frame(double timeout_s) {
  for (const Impl::Release& release : std::exchange(impl_->releases, {}))
    ImGui_ImplGlfw_KeyCallback(impl_->window, release.key, release.scancode, GLFW_RELEASE,
                               release.mods);
  if (timeout_s > 0)
    glfwWaitEventsTimeout(timeout_s);
  else
    glfwPollEvents();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void Window::wake() {
  glfwPostEmptyEvent();
}

void Window::draw_frame() {
  ImGui::Render();
  int width = 0, height = 0;
  glfwGetFramebufferSize(impl_->window, &width, &height);
  clear_screen(width, height);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

void Window::show_frame() {
  glfwSwapBuffers(impl_->window);
}

std::vector<KeyPress> Window::take_keys() {
  return std::exchange(impl_->keys, {});
}

bool Window::wants_close() const {
  return glfwWindowShouldClose(impl_->window) != 0;
}

void Window::keep_open() {
  glfwSetWindowShouldClose(impl_->window, GLFW_FALSE);
}

void Window::set_title(const std::string& title) {
  if (title == impl_->params.title) return;
  impl_->params.title = title;
  glfwSetWindowTitle(impl_->window, title.c_str());
}

double Window::scale() const {
  return impl_->scale;
}

std::vector<std::uint8_t> Window::read_frame(int& width, int& height) const {
  glfwGetFramebufferSize(impl_->window, &width, &height);
  return read_screen(width, height);
}

}  // namespace parian

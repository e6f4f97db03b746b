#include "app/studio/run_studio.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <utility>

#include "app/studio/layout.h"
#include "app/studio/studio_files.h"
#include "app/studio/ui.h"
#include "base/error.h"
#include "image/color.h"
#include "io/image/image_file.h"

namespace parian {
namespace {

std::string user_state_folder() {
  if (const char* state = std::getenv("XDG_STATE_HOME"); state != nullptr && *state != 0)
    return std::string(state) + "/parian";
  if (const char* home = std::getenv("HOME"); home != nullptr && *home != 0)
    return std::string(home) + "/.local/state/parian";
  return {};
}

// What goes wrong while a panel is drawn is a message, and the panel is whole again.
template <typename Draw>
void draw_guarded(Ui& ui, const Draw& draw) {
  try {
    draw(ui);
  } catch (const std::exception& error) {
    report(ui.studio, error.what(), true);
    ImGui::ErrorCheckEndWindowRecover(nullptr, nullptr);
  }
}

constexpr ImGuiWindowFlags panel_flags = ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize |
                                         ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoTitleBar |
                                         ImGuiWindowFlags_NoBringToFrontOnFocus |
                                         ImGuiWindowFlags_NoSavedSettings;

template <typename Draw>
void draw_panel(Ui& ui, const char* name, const PanelBox& box, ImGuiWindowFlags flags,
                const Draw& draw) {
  ImGui::SetNextWindowPos({box.x, box.y});
  ImGui::SetNextWindowSize({box.width, box.height});
  ImGui::Begin(name, nullptr, panel_flags | flags);
  draw_guarded(ui, draw);
  ImGui::End();
}

struct Tab {
  const char* name;
  void (*draw)(Ui&);
};
constexpr Tab upper_tabs[] = {{"Layers", draw_layers},
                              {"Material", draw_material},
                              {"Surface", draw_surface},
                              {"Light", draw_light},
                              {"Compress", draw_compression}};
constexpr Tab lower_tabs[] = {
    {"History", draw_history}, {"Statistics", draw_statistics}, {"Messages", draw_messages}};

template <std::size_t n>
void draw_tabs(Ui& ui, const char* name, const Tab (&tabs)[n]) {
  // Narrow, so that all of them are seen.
  const ImVec2 padding = ImGui::GetStyle().FramePadding;
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0.4f * padding.x, padding.y});
  const bool is_open = ImGui::BeginTabBar(name, ImGuiTabBarFlags_FittingPolicyScroll);
  ImGui::PopStyleVar();
  if (!is_open) return;
  for (const Tab& tab : tabs) {
    ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {0.4f * padding.x, padding.y});
    const bool open = ImGui::BeginTabItem(tab.name);
    ImGui::PopStyleVar();
    mark(ui.probe, std::string("tab/") + tab.name);
    if (!open) continue;
    ImGui::BeginChild(tab.name);
    ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.56f);
    draw_guarded(ui, tab.draw);
    ImGui::PopItemWidth();
    ImGui::EndChild();
    ImGui::EndTabItem();
  }
  ImGui::EndTabBar();
}

void draw_split(Ui& ui, const char* name, Split split, const PanelBox& box, float bar) {
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(0, 0));
  ImGui::PushStyleColor(ImGuiCol_WindowBg, ImGui::GetStyleColorVec4(ImGuiCol_MenuBarBg));
  draw_panel(ui, name, box, ImGuiWindowFlags_NoScrollbar, [&](Ui&) {
    ImGui::InvisibleButton("border", {box.width, box.height});
    mark(ui.probe, name);
    const bool is_across = split == Split::flat || split == Split::tabs;
    if (ImGui::IsItemHovered() || ImGui::IsItemActive())
      ImGui::SetMouseCursor(is_across ? ImGuiMouseCursor_ResizeNS : ImGuiMouseCursor_ResizeEW);
    if (!ImGui::IsItemActive()) return;
    const ImGuiIO& io = ImGui::GetIO();
    const float pixels = is_across ? io.MouseDelta.y : io.MouseDelta.x;
    ui.studio.shares = drag_split(ui.studio.shares, split, pixels, io.DisplaySize.x,
                                  io.DisplaySize.y, ImGui::GetFontSize(), bar);
  });
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
}

// Tools on the left, the view, then the map over its profile, tabs on the right.
void draw_panels(Ui& ui) {
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const float em = ImGui::GetFontSize(), bar = ImGui::GetFrameHeight();
  const float status = bar + 4;
  const Layout layout = make_layout(window.x, window.y, em, status, ui.studio.shares);
  constexpr ImGuiWindowFlags fixed =
      ImGuiWindowFlags_NoScrollbar | ImGuiWindowFlags_NoScrollWithMouse;
  draw_panel(ui, "bar", layout.menu, fixed | ImGuiWindowFlags_MenuBar, draw_menu);
  // Of a low window the wheel reaches all of them.
  draw_panel(ui, "tools", layout.tools, ImGuiWindowFlags_NoScrollbar, draw_toolbar);
  draw_panel(ui, "3-D", layout.view, fixed, draw_view);
  draw_panel(ui, "map", layout.flat, fixed, draw_flat_view);
  draw_panel(ui, "profile", layout.profile, fixed, draw_profile);
  draw_panel(ui, "tabs", layout.tabs, fixed, [](Ui& u) { draw_tabs(u, "upper", upper_tabs); });
  draw_panel(ui, "info", layout.info, fixed, [](Ui& u) { draw_tabs(u, "lower", lower_tabs); });
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, ImVec2(7, 2));
  ImGui::PushStyleColor(ImGuiCol_WindowBg, ImGui::GetStyleColorVec4(ImGuiCol_MenuBarBg));
  draw_panel(ui, "status", layout.status, fixed, draw_status);
  ImGui::PopStyleColor();
  ImGui::PopStyleVar();
  draw_split(ui, "split/map", Split::map, layout.split_map, status);
  draw_split(ui, "split/side", Split::side, layout.split_side, status);
  draw_split(ui, "split/flat", Split::flat, layout.split_flat, status);
  draw_split(ui, "split/tabs", Split::tabs, layout.split_tabs, status);
  draw_notice(ui, layout.view);
}

std::string next_screenshot(const std::string& folder) {
  std::error_code ignored;
  for (int i = 1;; ++i) {
    std::string path = fmt::format("{}/parian-{:03}.png", folder, i);
    if (!std::filesystem::exists(path, ignored)) return path;
  }
}

void save_screenshot(Ui& ui, const std::string& folder) {
  ui.wants_screenshot = false;
  try {
    int width = 0, height = 0;
    const std::vector<std::uint8_t> rgba = ui.window.read_frame(width, height);
    Image image = make_image(width, height, 3);
    for (std::size_t i = 0; i < image.values.size(); ++i)
      image.values[i] = decode_srgb(static_cast<float>(rgba[i / 3 * 4 + i % 3]) / 255.0f);
    const std::string path = next_screenshot(folder);
    save_image(path, image);
    report(ui.studio, "screenshot: " + std::filesystem::path(path).filename().string());
  } catch (const std::exception& error) {
    report(ui.studio, error.what(), true);
  }
}

void note_input(Probe& probe) {
  const ImGuiIO& io = ImGui::GetIO();
  probe.input.mouse_x = io.MousePos.x;
  probe.input.mouse_y = io.MousePos.y;
  probe.input.width = static_cast<int>(io.DisplaySize.x);
  probe.input.height = static_cast<int>(io.DisplaySize.y);
  probe.input.has_popup = ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId);
  probe.input.is_down = false;
  for (int button = 0; button < 3; ++button) {
    probe.input.is_down |= ImGui::IsMouseDown(button);
    if (ImGui::IsMouseClicked(button)) ++probe.input.presses;
  }
}

// One frame; true: the program may end.
bool run_frame(Ui& ui, double now_s) {
  ui.probe.previous = std::exchange(ui.probe.widgets, {});
  ui.studio.is_held = ImGui::IsAnyMouseDown();
  try {
    update(ui.studio, now_s);
    handle_shortcuts(ui);
  } catch (const std::exception& error) {
    report(ui.studio, error.what(), true);
  }
  draw_panels(ui);
  draw_dialogs(ui);
  if (ui.window.wants_close()) {
    ui.wants_quit = true;
    ui.window.keep_open();
  }
  const bool done = draw_quit(ui);
  note_input(ui.probe);
  return done;
}

// New pictures wake the window for as long as it lives.
struct WakeWindow {
  explicit WakeWindow(Studio& woken) : studio(woken) {
    studio.pictures.set_wake([] { Window::wake(); });
  }
  ~WakeWindow() { studio.pictures.set_wake({}); }
  WakeWindow(const WakeWindow&) = delete;
  WakeWindow& operator=(const WakeWindow&) = delete;
  Studio& studio;
};

// Seconds without input until the next frame; pictures end the wait. While one is drawn the window
// leaves it the processor.
double frame_wait(const Studio& studio) {
  const bool edits = studio.editor != nullptr && (studio.editor->activity().busy ||
                                                  studio.editor->snapshot() != studio.snapshot);
  if (edits || studio.is_stale) return 0.002;
  return is_settled(studio) ? 0.1 : 0.03;
}

void set_title(Ui& ui) {
  const Studio& studio = ui.studio;
  const std::string name =
      std::filesystem::path(studio.recipe_path.empty() ? studio.material_path : studio.recipe_path)
          .filename()
          .string();
  ui.window.set_title(name.empty() ? "Parian Studio"
                                   : name + (what_is_unsaved(studio).empty() ? " - " : " * - ") +
                                         "Parian Studio");
}

}  // namespace

void run_studio(const StudioOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto now = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  Studio studio;
  Window window(
      {.width = options.width,
       .height = options.height,
       .scale = options.scale,
       .title = "Parian Studio",
       .on_drop = [&](const std::vector<std::string>& paths) { open_files(studio, paths); }});
  start_studio(studio, {.state_folder = options.state_folder.empty() ? user_state_folder()
                                                                     : options.state_folder,
                        .data_folder = options.data_folder});
  open_files(studio, options.files);
  const WakeWindow wakes(studio);
  Probe probe{.path = options.probe};
  Ui ui{.studio = studio, .probe = probe, .window = window};
  bool done = false;
  while (!done) {
    window.begin_frame(frame_wait(studio));
    done = run_frame(ui, now());
    window.draw_frame();
    if (ui.wants_screenshot)
      save_screenshot(ui, options.screenshots.empty() ? "." : options.screenshots);
    window.show_frame();
    if (probe.first_picture_s < 0 && ui.view_picture != nullptr) probe.first_picture_s = now();
    set_title(ui);
    probe.flat_zoom = ui.flat_zoom.factor;
    write_probe(probe, studio);
    if (options.is_cancelled && options.is_cancelled()) throw make_cancelled_error();
  }
  finish_studio(studio);
}

}  // namespace parian

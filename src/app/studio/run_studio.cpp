#include "app/studio/run_studio.h"

#include <fmt/format.h>
#include <imgui.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>

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

void begin_panel(const char* name, ImVec2 place, ImVec2 size, ImGuiWindowFlags flags = 0) {
  ImGui::SetNextWindowPos(place);
  ImGui::SetNextWindowSize(size);
  ImGui::Begin(name, nullptr,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoBringToFrontOnFocus | flags);
}

void draw_side_tabs(Ui& ui) {
  if (!ImGui::BeginTabBar("side")) return;
  struct Tab {
    const char* name;
    void (*draw)(Ui&);
  };
  constexpr Tab tabs[] = {{"Layers", draw_layers},   {"Material", draw_material},
                          {"Light", draw_light},     {"Compress", draw_compression},
                          {"History", draw_history}, {"Stats", draw_statistics}};
  for (const Tab& tab : tabs) {
    const bool open = ImGui::BeginTabItem(tab.name);
    mark(ui.probe, std::string("tab/") + tab.name);
    if (!open) continue;
    ImGui::BeginChild(tab.name);
    ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.55f);
    tab.draw(ui);
    ImGui::PopItemWidth();
    ImGui::EndChild();
    ImGui::EndTabItem();
  }
  ImGui::EndTabBar();
}

// Tools on the left, the two views and what belongs to them in the middle, tabs on the right.
void draw_panels(Ui& ui) {
  const ImVec2 window = ImGui::GetIO().DisplaySize;
  const float em = ImGui::GetFontSize();
  const float bar = ImGui::GetFrameHeight(), left = 7 * em, right = 25 * em;
  const float middle = std::max(20 * em, window.x - left - right);
  const float split = std::floor(0.6f * middle), bottom = std::floor(0.28f * window.y);
  const float top = window.y - bar - bottom;
  begin_panel("bar", {0, 0}, {window.x, bar}, ImGuiWindowFlags_MenuBar);
  draw_menu(ui);
  ImGui::End();
  begin_panel("tools", {0, bar}, {left, window.y - bar});
  draw_toolbar(ui);
  ImGui::End();
  begin_panel("3-D", {left, bar}, {split, top}, ImGuiWindowFlags_NoScrollWithMouse);
  draw_view(ui);
  ImGui::End();
  begin_panel("map", {left + split, bar}, {middle - split, top},
              ImGuiWindowFlags_NoScrollWithMouse);
  draw_flat_view(ui);
  ImGui::End();
  begin_panel("profile", {left, bar + top}, {split, bottom}, ImGuiWindowFlags_NoScrollWithMouse);
  draw_profile(ui);
  ImGui::End();
  begin_panel("status", {left + split, bar + top}, {middle - split, bottom});
  draw_status(ui);
  ImGui::End();
  begin_panel("side", {left + middle, bar}, {right, window.y - bar});
  draw_side_tabs(ui);
  ImGui::End();
}

std::string next_screenshot(const std::string& folder) {
  std::error_code ignored;
  for (int i = 1;; ++i) {
    const std::string path = fmt::format("{}/parian-{:03}.png", folder, i);
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

// Unsaved recipes are asked about once.
void draw_quit(Ui& ui, bool& done) {
  if (!ui.wants_quit) return;
  const Studio& studio = ui.studio;
  const bool unsaved = studio.snapshot != nullptr && !studio.snapshot->layers.empty() &&
                       studio.snapshot->version != studio.saved_version;
  if (!unsaved) {
    done = true;
    return;
  }
  if (!ImGui::IsPopupOpen("quit")) ImGui::OpenPopup("quit");
  if (!ImGui::BeginPopupModal("quit", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  ImGui::TextUnformatted("The recipe is not saved.");
  if (ImGui::Button("quit without saving")) done = true;
  mark(ui.probe, "quit/yes");
  ImGui::SameLine();
  if (ImGui::Button("stay")) {
    ui.wants_quit = false;
    ImGui::CloseCurrentPopup();
  }
  mark(ui.probe, "quit/no");
  ImGui::EndPopup();
}

}  // namespace

void run_studio(const StudioOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const auto now = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  Studio studio;
  Window window({.width = options.width,
                 .height = options.height,
                 .title = "Parian Studio",
                 .on_drop = [&](const std::string& path) { open_file(studio, path); }});
  start_studio(studio, {.state_folder = options.state_folder.empty() ? user_state_folder()
                                                                     : options.state_folder,
                        .data_folder = options.data_folder});
  for (const std::string& file : options.files) open_file(studio, file);
  Probe probe{.path = options.probe};
  Ui ui{.studio = studio, .probe = probe, .window = window};
  bool done = false;
  while (!done) {
    // While something moves as fast as the display, else a few times a second.
    const bool rests = is_settled(studio);
    window.begin_frame(rests ? 0.1 : 0.01);
    probe.widgets.clear();
    update(studio, now());
    handle_shortcuts(ui);
    draw_panels(ui);
    draw_dialogs(ui);
    if (window.wants_close()) {
      ui.wants_quit = true;
      window.keep_open();
    }
    draw_quit(ui, done);
    window.draw_frame();
    if (ui.wants_screenshot)
      save_screenshot(ui, options.screenshots.empty() ? "." : options.screenshots);
    window.show_frame();
    write_probe(probe, studio);
    if (options.is_cancelled && options.is_cancelled()) throw make_cancelled_error();
  }
  finish_studio(studio);
}

}  // namespace parian

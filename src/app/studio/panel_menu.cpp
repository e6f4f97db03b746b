// Menu bar, keyboard, and the help page.
#include <imgui.h>

#include <algorithm>

#include "app/studio/studio_files.h"
#include "app/studio/tools.h"
#include "app/studio/ui.h"

namespace parian {
namespace {

struct Shortcut {
  const char *keys, *what;
};
constexpr Shortcut shortcuts[] = {
    {"Ctrl+O", "open: table, map, blend, mesh, recipe, scene, environment, photograph"},
    {"Ctrl+S, Ctrl+Shift+S", "save the recipe; under another name"},
    {"Ctrl+Z, Ctrl+Y", "undo, redo (also Ctrl+Shift+Z): layers, light, camera"},
    {"Ctrl+Q", "quit"},
    {"1 … 9, 0", "tools, from top to bottom"},
    {"V, Shift+V", "next view mode, previous one"},
    {"M", "show the selection on the mesh"},
    {"F, Shift+F", "frame the mesh; all of the map"},
    {"W", "wireframe on and off"},
    {"Space", "the selected layer on and off"},
    {"Delete", "remove the selected layer"},
    {"[ and ]", "smaller and larger brush"},
    {"- and +", "darker and brighter, by half a stop"},
    {"Escape", "cancel what runs; close messages"},
    {"F1", "this page"},
    {"F12", "screenshot"},
};
constexpr Shortcut mouse[] = {
    {"drag", "with the orbit tool: turn the object"},
    {"middle button", "pan, in the 3-D view and on the flat map"},
    {"wheel", "zoom, in both"},
    {"right button", "turn the chosen lamp, with any tool"},
    {"Ctrl and right button", "turn the environment"},
    {"Ctrl and click", "on a number: type it"},
    {"borders of panels", "drag them"},
    {"files", "drop them on the window to open them"},
};

// GLFW's codes.
constexpr int key_space = 32, key_escape = 256, key_delete = 261, key_f1 = 290, key_f12 = 301;

void draw_shortcuts(const char* title, const Shortcut* first, const Shortcut* last) {
  ImGui::TextDisabled("%s", title);
  for (; first != last; ++first) {
    ImGui::TextUnformatted(first->keys);
    ImGui::SameLine(ImGui::GetFontSize() * 13);
    ImGui::TextWrapped("%s", first->what);
  }
  ImGui::Spacing();
}

void draw_open_items(Ui& ui) {
  Studio& studio = ui.studio;
  if (ImGui::MenuItem("Open…", "Ctrl+O")) start_dialog(ui, FileDialog::Action::open, "");
  mark(ui.probe, "menu/open");
  if (ImGui::BeginMenu("Open recent", !studio.recent.empty())) {
    const std::vector<std::string> recent = studio.recent;
    for (const std::string& path : recent)
      if (ImGui::MenuItem(path.c_str())) open_file(studio, path);
    ImGui::EndMenu();
  }
  if (ImGui::MenuItem("Second material…", nullptr, false, studio.snapshot != nullptr))
    start_dialog(ui, FileDialog::Action::open_second, "");
  mark(ui.probe, "menu/second");
  explain("a map or blend beside this one, to pick profiles and stamp patterns from");
  if (ImGui::MenuItem("Material from photograph…", nullptr, false, studio.snapshot != nullptr))
    start_dialog(ui, FileDialog::Action::open_photograph, "");
  mark(ui.probe, "menu/photograph");
}

void draw_save_items(Ui& ui) {
  using Action = FileDialog::Action;
  const bool has_map = ui.studio.snapshot != nullptr;
  if (ImGui::MenuItem("Save recipe", "Ctrl+S", false, has_map)) save_present_recipe(ui);
  mark(ui.probe, "menu/save recipe");
  if (ImGui::MenuItem("Save recipe as…", "Ctrl+Shift+S", false, has_map))
    start_dialog(ui, Action::save_recipe, "recipe.json");
  mark(ui.probe, "menu/save recipe as");
  if (ImGui::MenuItem("Save scene as…", nullptr, false, ui.studio.stage != nullptr))
    start_dialog(ui, Action::save_scene, "scene.json");
  mark(ui.probe, "menu/save scene as");
  explain("mesh, material, layers, lights and camera, as `parian render` takes them");
  if (ImGui::MenuItem("Export map…", nullptr, false, has_map))
    start_dialog(ui, Action::save_map, "map.h5");
  mark(ui.probe, "menu/export map");
  if (ImGui::MenuItem("Export blend…", nullptr, false, ui.studio.shown_compressed.has_value()))
    start_dialog(ui, Action::save_blend, "material.kbm");
  mark(ui.probe, "menu/export blend");
  explain("the one that is chosen under Compress");
  if (ImGui::MenuItem("Export picture…")) start_dialog(ui, Action::save_picture, "picture.png");
  mark(ui.probe, "menu/export picture");
  if (ImGui::MenuItem("Screenshot", "F12")) ui.wants_screenshot = true;
}

void draw_file_menu(Ui& ui) {
  const bool open = ImGui::BeginMenu("File");
  mark(ui.probe, "menu/file");
  if (!open) return;
  draw_open_items(ui);
  ImGui::Separator();
  draw_save_items(ui);
  ImGui::Separator();
  if (ImGui::MenuItem("Quit", "Ctrl+Q")) ui.wants_quit = true;
  ImGui::EndMenu();
}

void draw_edit_menu(Ui& ui) {
  const bool open = ImGui::BeginMenu("Edit");
  mark(ui.probe, "menu/edit");
  if (!open) return;
  const HistoryView view = view_history(ui.studio);
  if (ImGui::MenuItem("Undo", "Ctrl+Z", false, view.position > 0)) undo(ui.studio);
  mark(ui.probe, "menu/undo");
  if (ImGui::MenuItem("Redo", "Ctrl+Y", false, view.position < view.rows.size())) redo(ui.studio);
  mark(ui.probe, "menu/redo");
  ImGui::EndMenu();
}

void frame_mesh(Studio& studio) {
  if (studio.stage == nullptr) return;
  const Orbit whole = frame_stage(*studio.stage, studio.view_width, studio.view_height);
  studio.orbit.target = whole.target;
  studio.orbit.distance_mm = whole.distance_mm;
  touch_view(studio);
}

void set_mode(Studio& studio, ViewMode mode) {
  studio.mode = mode;
  touch_view(studio);
}

void step_mode(Studio& studio, bool back) {
  const std::size_t count = view_mode_names().size();
  set_mode(studio, static_cast<ViewMode>(
                       (static_cast<std::size_t>(studio.mode) + (back ? count - 1 : 1)) % count));
}

void draw_view_menu(Ui& ui) {
  Studio& studio = ui.studio;
  const bool open = ImGui::BeginMenu("View");
  mark(ui.probe, "menu/view");
  if (!open) return;
  for (std::size_t i = 0; i < view_mode_names().size(); ++i)
    if (ImGui::MenuItem(view_mode_names()[i].c_str(), nullptr,
                        i == static_cast<std::size_t>(studio.mode)))
      set_mode(studio, static_cast<ViewMode>(i));
  ImGui::Separator();
  if (ImGui::MenuItem("Frame the mesh", "F")) frame_mesh(studio);
  if (ImGui::MenuItem("All of the map", "Shift+F")) ui.flat_zoom = {};
  if (ImGui::MenuItem("Selection on the mesh", "M", studio.show_selection)) {
    studio.show_selection = !studio.show_selection;
    touch_view(studio);
  }
  if (ImGui::MenuItem("Panels as at first")) studio.shares = {};
  ImGui::EndMenu();
}

void switch_layer(Studio& studio) {
  const LayerSnapshot* layer = selected_layer(studio);
  if (layer == nullptr) return;
  Document changed = layer->source;
  set(changed, "enabled", !layer->enabled);
  studio.editor->post((layer->enabled ? "hide " : "show ") + layer->name,
                      set_layer(*studio.selected_layer, changed));
  touch_map(studio);
}

void drop_layer(Studio& studio) {
  const LayerSnapshot* layer = selected_layer(studio);
  if (layer == nullptr) return;
  studio.editor->post("remove " + layer->name, remove_layer(*studio.selected_layer));
  touch_map(studio);
}

void cancel_all(Studio& studio) {
  for (const JobView& job : studio.jobs.views()) studio.jobs.cancel(job.name);
  if (studio.editor != nullptr) studio.editor->cancel();
  studio.unseen_errors = 0;
}

void add_exposure(Studio& studio, double stops) {
  studio.exposure = std::clamp(studio.exposure + stops, -5.0, 5.0);
  touch_view(studio);
}

void handle_command(Ui& ui, const KeyPress& key) {
  switch (key.key) {
    case 'O':
      return start_dialog(ui, FileDialog::Action::open, "");
    case 'S':
      if (key.shift) return start_dialog(ui, FileDialog::Action::save_recipe, "recipe.json");
      return save_present_recipe(ui);
    case 'Q':
      ui.wants_quit = true;
      return;
    case 'Y':
      return redo(ui.studio);
    case 'Z':
      return key.shift ? redo(ui.studio) : undo(ui.studio);
    default:
      return;
  }
}

// That of the map's strokes has the bounds of its slider, that of masks those of the mesh.
void scale_brush(Studio& studio, double factor) {
  if (studio.tool == Tool::mask) {
    if (studio.stage == nullptr) return;
    const auto size = static_cast<double>(diagonal(studio.stage->box));
    double& radius = studio.mask.brush.radius_mm;
    radius = std::clamp(radius * factor, 1e-3 * size, 0.5 * size);
  } else if (studio.snapshot != nullptr) {
    const BrushBounds bounds = brush_bounds(studio);
    studio.brush_radius_mm =
        std::clamp(studio.brush_radius_mm * factor, bounds.least_mm, bounds.most_mm);
  }
}

// Of the map's layers and brush.
void handle_map_key(Studio& studio, int key) {
  switch (key) {
    case '[':
      return scale_brush(studio, 0.8);
    case ']':
      return scale_brush(studio, 1.25);
    case key_space:
      return switch_layer(studio);
    case key_delete:
      return drop_layer(studio);
    default:
      return;
  }
}

void handle_key(Ui& ui, const KeyPress& key) {
  Studio& studio = ui.studio;
  const int tool = key.key == '0' ? 9 : key.key - '1';
  if (tool >= 0 && tool < static_cast<int>(tool_names().size()))
    choose_tool(studio, static_cast<Tool>(tool));
  switch (key.key) {
    case key_f1:
      ui.shows_help = !ui.shows_help;
      return;
    case key_escape:
      return cancel_all(studio);
    case 'V':
      return step_mode(studio, key.shift);
    case 'W':
      return set_mode(studio,
                      studio.mode == ViewMode::wireframe ? ViewMode::shaded : ViewMode::wireframe);
    case 'M':
      studio.show_selection = !studio.show_selection;
      return touch_view(studio);
    case 'F':
      if (key.shift)
        ui.flat_zoom = {};
      else
        frame_mesh(studio);
      return;
    case '-':
      return add_exposure(studio, -0.5);
    case '+':
    case '=':
      return add_exposure(studio, 0.5);
    default:
      return handle_map_key(studio, key.key);
  }
}

}  // namespace

void draw_menu(Ui& ui) {
  if (!ImGui::BeginMenuBar()) return;
  draw_file_menu(ui);
  draw_edit_menu(ui);
  draw_view_menu(ui);
  if (ImGui::BeginMenu("Help")) {
    if (ImGui::MenuItem("Keys and mouse", "F1")) ui.shows_help = true;
    ImGui::EndMenu();
  }
  ImGui::EndMenuBar();
}

void draw_help(Ui& ui) {
  if (!ui.shows_help) return;
  const ImVec2 room = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowSize({std::min(ImGui::GetFontSize() * 44, room.x), 0}, ImGuiCond_Appearing);
  ImGui::SetNextWindowPos({room.x / 2, room.y / 2}, ImGuiCond_Appearing, {0.5f, 0.5f});
  if (ImGui::Begin("Keys and mouse", &ui.shows_help,
                   ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoSavedSettings)) {
    draw_shortcuts("keys", std::begin(shortcuts), std::end(shortcuts));
    draw_shortcuts("mouse", std::begin(mouse), std::end(mouse));
    ImGui::TextWrapped(
        "Strokes on the flat map or on the mesh become layers of a recipe, listed on the right. "
        "The map that was opened never changes: every layer can be switched off, moved and "
        "changed later.");
  }
  ImGui::End();
}

void handle_shortcuts(Ui& ui) {
  const std::vector<KeyPress> keys = ui.window.take_keys();
  ui.probe.input.keys += keys.size();
  for (const KeyPress& key : keys) ui.wants_screenshot |= key.key == key_f12;
  if (ImGui::GetIO().WantTextInput || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) return;
  // What is being dragged is no entry yet, and a stroke has the tool that it was begun with.
  if (ImGui::IsAnyMouseDown()) return;
  for (const KeyPress& key : keys)
    if (key.control)
      handle_command(ui, key);
    else
      handle_key(ui, key);
}

}  // namespace parian

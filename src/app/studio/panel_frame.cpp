// Menu bar, tools, status line, shortcuts, help and files.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <filesystem>

#include "app/studio/tools.h"
#include "app/studio/ui.h"

namespace parian {
namespace {

struct Shortcut {
  const char *keys, *what;
};
constexpr Shortcut shortcuts[] = {
    {"Ctrl+O", "open: table, map, blend, mesh, recipe, scene, environment, photograph"},
    {"Ctrl+S", "save the recipe"},
    {"Ctrl+Z, Ctrl+Y", "undo, redo (also Ctrl+Shift+Z)"},
    {"1 ... 8", "tools, from top to bottom"},
    {"V", "next view mode"},
    {"M", "show the selection on the mesh"},
    {"F", "frame the mesh"},
    {"Delete", "remove the selected layer"},
    {"[ and ]", "smaller and larger brush"},
    {"F1", "this page"},
    {"F12", "screenshot"},
    {"drag", "with the orbit tool: turn; middle button: pan; wheel: zoom"},
    {"right button or Shift", "drag the lamp"},
};

// GLFW's codes.
constexpr int key_delete = 261, key_f1 = 290, key_f12 = 301;

constexpr const char* tool_help[] = {
    "turn the object (1)",
    "drag the lamp (2)",
    "scribble on what shall change: all that looks like it is selected (3)",
    "scribble on what shall stay (4)",
    "select by brush (5)",
    "pick a profile, and inspect it (6)",
    "paint with the picked profile (7)",
    "stamp: drag a rectangle around a pattern, then click where it goes (8)",
};

const char* action_name(FileDialog::Action action) {
  switch (action) {
    case FileDialog::Action::open:
      return "open";
    case FileDialog::Action::save_recipe:
      return "save recipe";
    case FileDialog::Action::save_map:
      return "save map";
    case FileDialog::Action::save_picture:
      return "save picture";
    default:
      return "save blend";
  }
}

void start_dialog(Ui& ui, FileDialog::Action action, const std::string& name) {
  ui.dialog.action = action;
  ui.dialog.name = name;
  ui.dialog.wants_open = true;
}

void save_present_recipe(Ui& ui) {
  if (ui.studio.recipe_path.empty())
    start_dialog(ui, FileDialog::Action::save_recipe, "recipe.json");
  else
    save_recipe(ui.studio, ui.studio.recipe_path);
}

void finish_dialog(Ui& ui) {
  const std::string path = (std::filesystem::path(ui.dialog.folder) / ui.dialog.name).string();
  switch (ui.dialog.action) {
    case FileDialog::Action::open:
      return open_file(ui.studio, path);
    case FileDialog::Action::save_recipe:
      return save_recipe(ui.studio, path);
    case FileDialog::Action::save_map:
      return save_map(ui.studio, path);
    case FileDialog::Action::save_picture:
      return save_picture(ui.studio, path);
    case FileDialog::Action::save_compressed:
      if (ui.studio.shown_compressed) save_compressed(ui.studio, *ui.studio.shown_compressed, path);
  }
}

struct Entry {
  std::string name;
  bool is_folder = false;
};
std::vector<Entry> list_folder(const std::string& folder) {
  std::vector<Entry> entries;
  std::error_code failure;
  constexpr std::size_t most = 5000;
  for (std::filesystem::directory_iterator at(folder, failure), end; !failure && at != end;
       at.increment(failure)) {
    if (entries.size() == most) break;
    std::error_code ignored;
    const std::string name = at->path().filename().string();
    if (!name.starts_with('.')) entries.push_back({name, at->is_directory(ignored)});
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.is_folder != b.is_folder ? a.is_folder : a.name < b.name;
  });
  return entries;
}

void draw_file_dialog(Ui& ui) {
  if (ui.dialog.wants_open) {
    ui.dialog.wants_open = false;
    if (ui.dialog.folder.empty()) ui.dialog.folder = std::filesystem::current_path().string();
    ImGui::OpenPopup("file");
  }
  ImGui::SetNextWindowSize({ImGui::GetFontSize() * 44, ImGui::GetFontSize() * 30},
                           ImGuiCond_Appearing);
  if (!ImGui::BeginPopupModal("file", nullptr)) return;
  ImGui::TextUnformatted(action_name(ui.dialog.action));
  ImGui::InputText("folder", &ui.dialog.folder);
  mark(ui.probe, "file/folder");
  ImGui::BeginChild("files", {0, -3 * ImGui::GetFrameHeightWithSpacing()}, true);
  if (ImGui::Selectable("..", false, ImGuiSelectableFlags_DontClosePopups))
    ui.dialog.folder = std::filesystem::path(ui.dialog.folder).parent_path().string();
  bool done = false;
  for (const Entry& entry : list_folder(ui.dialog.folder)) {
    const std::string label = entry.is_folder ? entry.name + "/" : entry.name;
    if (!ImGui::Selectable(
            label.c_str(), entry.name == ui.dialog.name,
            ImGuiSelectableFlags_DontClosePopups | ImGuiSelectableFlags_AllowDoubleClick))
      continue;
    if (entry.is_folder) {
      ui.dialog.folder = (std::filesystem::path(ui.dialog.folder) / entry.name).string();
    } else {
      ui.dialog.name = entry.name;
      done = ImGui::IsMouseDoubleClicked(0);
    }
  }
  ImGui::EndChild();
  done |= ImGui::InputText("name", &ui.dialog.name, ImGuiInputTextFlags_EnterReturnsTrue);
  mark(ui.probe, "file/name");
  done |= ImGui::Button(action_name(ui.dialog.action));
  mark(ui.probe, "file/ok");
  ImGui::SameLine();
  if (ImGui::Button("cancel")) ImGui::CloseCurrentPopup();
  if (done && !ui.dialog.name.empty()) {
    finish_dialog(ui);
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

void draw_help(Ui& ui) {
  if (!ui.shows_help) return;
  ImGui::SetNextWindowSize({ImGui::GetFontSize() * 40, 0}, ImGuiCond_Appearing);
  if (ImGui::Begin("help", &ui.shows_help)) {
    for (const Shortcut& shortcut : shortcuts) {
      ImGui::TextUnformatted(shortcut.keys);
      ImGui::SameLine(ImGui::GetFontSize() * 11);
      ImGui::TextWrapped("%s", shortcut.what);
    }
    ImGui::Separator();
    ImGui::TextWrapped(
        "Strokes become layers of a recipe, in the list on the right. A layer's numbers are "
        "dragged, or typed after Ctrl and a click. The map itself never changes.");
  }
  ImGui::End();
}

void draw_recovery(Ui& ui) {
  Studio& studio = ui.studio;
  if (!studio.recoverable) return;
  if (!ImGui::IsPopupOpen("recover")) ImGui::OpenPopup("recover");
  if (!ImGui::BeginPopupModal("recover", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) return;
  ImGui::TextUnformatted("The last run ended without saving its recipe.");
  if (ImGui::Button("take it up again")) {
    recover(studio);
    ImGui::CloseCurrentPopup();
  }
  mark(ui.probe, "recover/yes");
  ImGui::SameLine();
  if (ImGui::Button("leave it")) {
    studio.recoverable.reset();
    ImGui::CloseCurrentPopup();
  }
  mark(ui.probe, "recover/no");
  ImGui::EndPopup();
}

void draw_file_menu(Ui& ui) {
  Studio& studio = ui.studio;
  if (ImGui::MenuItem("Open...", "Ctrl+O")) start_dialog(ui, FileDialog::Action::open, "");
  mark(ui.probe, "menu/open");
  if (ImGui::BeginMenu("Recent", !studio.recent.empty())) {
    const std::vector<std::string> recent = studio.recent;
    for (const std::string& path : recent)
      if (ImGui::MenuItem(path.c_str())) open_file(studio, path);
    ImGui::EndMenu();
  }
  ImGui::Separator();
  if (ImGui::MenuItem("Save recipe", "Ctrl+S")) save_present_recipe(ui);
  mark(ui.probe, "menu/save recipe");
  if (ImGui::MenuItem("Save recipe as..."))
    start_dialog(ui, FileDialog::Action::save_recipe, "recipe.json");
  mark(ui.probe, "menu/save recipe as");
  if (ImGui::MenuItem("Export map...")) start_dialog(ui, FileDialog::Action::save_map, "map.h5");
  mark(ui.probe, "menu/export map");
  if (ImGui::MenuItem("Export picture..."))
    start_dialog(ui, FileDialog::Action::save_picture, "picture.png");
  mark(ui.probe, "menu/export picture");
  if (ImGui::MenuItem("Screenshot", "F12")) ui.wants_screenshot = true;
  ImGui::Separator();
  if (ImGui::MenuItem("Quit", "Ctrl+Q")) ui.wants_quit = true;
}

void handle_command(Ui& ui, const KeyPress& key) {
  Studio& studio = ui.studio;
  if (key.key == 'O') start_dialog(ui, FileDialog::Action::open, "");
  if (key.key == 'S') save_present_recipe(ui);
  if (key.key == 'Q') ui.wants_quit = true;
  const bool redoes = key.key == 'Y' || (key.shift && key.key == 'Z');
  if (studio.editor == nullptr || (!redoes && key.key != 'Z')) return;
  if (redoes)
    studio.editor->redo();
  else
    studio.editor->undo();
  touch_map(studio);
}

void handle_key(Ui& ui, const KeyPress& key) {
  Studio& studio = ui.studio;
  const int tool = key.key - '1';
  if (tool >= 0 && tool < static_cast<int>(tool_names().size()))
    studio.tool = static_cast<Tool>(tool);
  switch (key.key) {
    case key_f1:
      ui.shows_help = !ui.shows_help;
      return;
    case key_f12:
      ui.wants_screenshot = true;
      return;
    case 'V':
      studio.mode = static_cast<ViewMode>((static_cast<std::size_t>(studio.mode) + 1) %
                                          view_mode_names().size());
      return touch_view(studio);
    case 'M':
      studio.show_selection = !studio.show_selection;
      return touch_view(studio);
    case 'F':
      studio.orbit = frame_stage(*studio.stage, studio.view_width, studio.view_height);
      return touch_view(studio);
    case '[':
      studio.brush_radius_mm *= 0.8;
      return;
    case ']':
      studio.brush_radius_mm *= 1.25;
      return;
    case key_delete:
      if (const LayerSnapshot* layer = selected_layer(studio); layer != nullptr) {
        studio.editor->post("remove " + layer->name, remove_layer(*studio.selected_layer));
        touch_map(studio);
      }
      return;
    default:
      return;
  }
}

}  // namespace

void draw_menu(Ui& ui) {
  Studio& studio = ui.studio;
  if (!ImGui::BeginMenuBar()) return;
  const bool file = ImGui::BeginMenu("File");
  mark(ui.probe, "menu/file");
  if (file) {
    draw_file_menu(ui);
    ImGui::EndMenu();
  }
  const bool edit = ImGui::BeginMenu("Edit");
  mark(ui.probe, "menu/edit");
  if (edit) {
    const bool can_undo = studio.snapshot != nullptr && !studio.snapshot->history.empty();
    const bool can_redo = studio.snapshot != nullptr && !studio.snapshot->future.empty();
    if (ImGui::MenuItem("Undo", "Ctrl+Z", false, can_undo)) {
      studio.editor->undo();
      touch_map(studio);
    }
    mark(ui.probe, "menu/undo");
    if (ImGui::MenuItem("Redo", "Ctrl+Y", false, can_redo)) {
      studio.editor->redo();
      touch_map(studio);
    }
    mark(ui.probe, "menu/redo");
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("View")) {
    if (ImGui::MenuItem("Frame the mesh", "F")) {
      studio.orbit = frame_stage(*studio.stage, studio.view_width, studio.view_height);
      touch_view(studio);
    }
    ImGui::EndMenu();
  }
  if (ImGui::BeginMenu("Help")) {
    if (ImGui::MenuItem("Keys and tools", "F1")) ui.shows_help = true;
    ImGui::EndMenu();
  }
  ImGui::EndMenuBar();
}

void draw_toolbar(Ui& ui) {
  Studio& studio = ui.studio;
  const std::vector<std::string>& names = tool_names();
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_selected = static_cast<std::size_t>(studio.tool) == i;
    if (is_selected)
      ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button(names[i].c_str(), {-1, 0})) studio.tool = static_cast<Tool>(i);
    if (is_selected) ImGui::PopStyleColor();
    mark(ui.probe, "tool/" + names[i]);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", tool_help[i]);
  }
}

void draw_status(Ui& ui) {
  Studio& studio = ui.studio;
  for (const JobView& job : studio.jobs.views()) {
    if (job.name == "flat" || job.name == "measured") continue;
    const std::string text = fmt::format("{}: {} {:.0f} %", job.name, job.stage, 100 * job.done);
    ImGui::ProgressBar(static_cast<float>(job.done), {ImGui::GetFontSize() * 22, 0}, text.c_str());
    ImGui::SameLine();
    ImGui::PushID(job.name.c_str());
    if (ImGui::SmallButton("cancel")) {
      studio.jobs.cancel(job.name);
      if (job.name == "refine") studio.refine = false;
    }
    ImGui::PopID();
  }
  if (studio.editor != nullptr) {
    const EditorActivity activity = studio.editor->activity();
    if (activity.busy) {
      ImGui::ProgressBar(static_cast<float>(activity.done), {ImGui::GetFontSize() * 22, 0},
                         activity.stage.c_str());
      ImGui::SameLine();
      if (ImGui::SmallButton("cancel##edit")) studio.editor->cancel();
    }
  }
  constexpr std::size_t shown = 30;
  const std::size_t count = studio.messages.size();
  for (std::size_t i = count; i-- > (count > shown ? count - shown : 0);) {
    const Message& message = studio.messages[i];
    if (message.is_error) ImGui::PushStyleColor(ImGuiCol_Text, ImVec4(1, 0.55f, 0.45f, 1));
    ImGui::TextWrapped("%s", message.text.c_str());
    if (message.is_error) ImGui::PopStyleColor();
  }
}

void draw_dialogs(Ui& ui) {
  draw_file_dialog(ui);
  draw_recovery(ui);
  draw_help(ui);
}

void handle_shortcuts(Ui& ui) {
  const std::vector<KeyPress> keys = ui.window.take_keys();
  if (ImGui::GetIO().WantTextInput || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) return;
  for (const KeyPress& key : keys)
    if (key.control)
      handle_command(ui, key);
    else
      handle_key(ui, key);
}

}  // namespace parian

// Windows that ask: which file, whether to recover, whether to quit.
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/studio/scene_file.h"
#include "app/studio/studio_files.h"
#include "app/studio/ui.h"

namespace parian {
namespace {

const char* action_name(FileDialog::Action action) {
  switch (action) {
    case FileDialog::Action::open:
      return "Open";
    case FileDialog::Action::open_second:
      return "Open second material";
    case FileDialog::Action::open_layer:
      return "Material over this one";
    case FileDialog::Action::open_photograph:
      return "Material from photograph";
    case FileDialog::Action::choose:
      return "Choose";
    case FileDialog::Action::save_recipe:
      return "Save recipe";
    case FileDialog::Action::save_scene:
      return "Save scene";
    case FileDialog::Action::save_map:
      return "Export map";
    case FileDialog::Action::save_picture:
      return "Export picture";
    default:
      return "Export blend";
  }
}

bool is_opening(FileDialog::Action action) {
  return action <= FileDialog::Action::choose;
}

void finish_dialog(Ui& ui) {
  Studio& studio = ui.studio;
  const std::string path = (std::filesystem::path(ui.dialog.folder) / ui.dialog.name).string();
  switch (ui.dialog.action) {
    case FileDialog::Action::open:
    case FileDialog::Action::open_photograph:
      return open_file(studio, path);
    case FileDialog::Action::open_second:
      return open_second(studio, path);
    case FileDialog::Action::open_layer:
      return open_layer(studio, path);
    case FileDialog::Action::choose:
      // It may open a dialog of its own, with another continuation.
      return std::exchange(ui.dialog.then, {})(ui, path);
    case FileDialog::Action::save_recipe:
      return save_recipe(studio, path);
    case FileDialog::Action::save_scene:
      return save_scene(studio, path);
    case FileDialog::Action::save_map:
      return save_map(studio, path);
    case FileDialog::Action::save_picture:
      return save_picture(studio, path);
    case FileDialog::Action::save_blend:
      if (studio.shown_compressed) save_compressed(studio, *studio.shown_compressed, path);
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

// True: a file was chosen by a double click.
bool draw_entries(FileDialog& dialog) {
  if (ImGui::Selectable("..", false, ImGuiSelectableFlags_DontClosePopups))
    dialog.folder = std::filesystem::path(dialog.folder).parent_path().string();
  bool done = false;
  for (const Entry& entry : list_folder(dialog.folder)) {
    const std::string label = entry.is_folder ? entry.name + "/" : entry.name;
    if (!ImGui::Selectable(
            label.c_str(), entry.name == dialog.name,
            ImGuiSelectableFlags_DontClosePopups | ImGuiSelectableFlags_AllowDoubleClick))
      continue;
    if (entry.is_folder) {
      dialog.folder = (std::filesystem::path(dialog.folder) / entry.name).string();
    } else {
      dialog.name = entry.name;
      done = ImGui::IsMouseDoubleClicked(0);
    }
  }
  return done;
}

void draw_file_dialog(Ui& ui) {
  FileDialog& dialog = ui.dialog;
  if (dialog.wants_open) {
    dialog.wants_open = false;
    std::error_code ignored;
    if (dialog.folder.empty()) dialog.folder = std::filesystem::current_path(ignored).string();
    ImGui::OpenPopup("file");
  }
  const ImVec2 room = ImGui::GetIO().DisplaySize;
  const float em = ImGui::GetFontSize();
  ImGui::SetNextWindowSize({std::min(44 * em, room.x), std::min(30 * em, room.y)},
                           ImGuiCond_Appearing);
  ImGui::SetNextWindowPos({room.x / 2, room.y / 2}, ImGuiCond_Appearing, {0.5f, 0.5f});
  if (!ImGui::BeginPopupModal("file", nullptr, ImGuiWindowFlags_NoTitleBar)) return;
  const bool chooses = dialog.action == FileDialog::Action::choose;
  ImGui::TextUnformatted(chooses ? dialog.title.c_str() : action_name(dialog.action));
  ImGui::SetNextItemWidth(-4 * em);
  ImGui::InputText("folder", &dialog.folder);
  mark(ui.probe, "file/folder");
  ImGui::BeginChild("files", {0, -2.4f * ImGui::GetFrameHeightWithSpacing()}, true);
  bool done = draw_entries(dialog);
  ImGui::EndChild();
  ImGui::SetNextItemWidth(-4 * em);
  done |= ImGui::InputText("name", &dialog.name, ImGuiInputTextFlags_EnterReturnsTrue);
  mark(ui.probe, "file/name");
  const bool can = !dialog.name.empty();
  ImGui::BeginDisabled(!can);
  std::error_code ignored;
  const bool replaces =
      can && !is_opening(dialog.action) &&
      std::filesystem::exists(std::filesystem::path(dialog.folder) / dialog.name, ignored);
  done |= ImGui::Button(replaces ? "Replace the file" : action_name(dialog.action));
  ImGui::EndDisabled();
  mark(ui.probe, "file/ok");
  ImGui::SameLine();
  const bool leaves = ImGui::Button("Cancel");
  mark(ui.probe, "file/cancel");
  if (leaves || ImGui::IsKeyPressed(ImGui::GetKeyIndex(ImGuiKey_Escape))) {
    ImGui::CloseCurrentPopup();
  } else if (done && can) {
    finish_dialog(ui);
    ImGui::CloseCurrentPopup();
  }
  ImGui::EndPopup();
}

// A question with two answers, in the middle of the window. Each press counts once.
enum class Answer { none, yes, no };
Answer ask(Ui& ui, const char* name, const char* question, const char* yes, const char* no) {
  Answer answer = Answer::none;
  if (!ImGui::IsPopupOpen(name)) ImGui::OpenPopup(name);
  const ImVec2 room = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({room.x / 2, room.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  if (!ImGui::BeginPopupModal(name, nullptr,
                              ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar))
    return answer;
  ImGui::TextUnformatted(question);
  ImGui::Spacing();
  if (ImGui::Button(yes)) answer = Answer::yes;
  mark(ui.probe, std::string(name) + "/yes");
  ImGui::SameLine();
  if (ImGui::Button(no)) answer = Answer::no;
  mark(ui.probe, std::string(name) + "/no");
  if (answer != Answer::none) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return answer;
}

void draw_recovery(Ui& ui) {
  if (!ui.studio.recoverable) return;
  switch (ask(ui, "recover", "The last run ended without saving its work.", "Take it up again",
              "Throw it away")) {
    case Answer::yes:
      return recover(ui.studio);
    case Answer::no:
      return discard_recoverable(ui.studio);
    case Answer::none:
      return;
  }
}

}  // namespace

void start_dialog(Ui& ui, FileDialog::Action action, const std::string& name) {
  ui.dialog.action = action;
  ui.dialog.name = name;
  ui.dialog.wants_open = true;
}

void choose_file(Ui& ui, const std::string& title,
                 std::function<void(Ui&, const std::string& path)> then) {
  ui.dialog.title = title;
  ui.dialog.then = std::move(then);
  start_dialog(ui, FileDialog::Action::choose, "");
}

void save_present_recipe(Ui& ui) {
  if (ui.studio.recipe_path.empty())
    start_dialog(ui, FileDialog::Action::save_recipe, "recipe.json");
  else
    save_recipe(ui.studio, ui.studio.recipe_path);
}

void draw_dialogs(Ui& ui) {
  draw_file_dialog(ui);
  draw_recovery(ui);
  draw_help(ui);
}

bool draw_quit(Ui& ui) {
  if (!ui.wants_quit) return false;
  const std::string unsaved = what_is_unsaved(ui.studio);
  if (unsaved.empty()) return true;
  switch (ask(ui, "quit", unsaved.c_str(), "Quit without saving", "Stay")) {
    case Answer::yes:
      return true;
    case Answer::no:
      ui.wants_quit = false;
      return false;
    case Answer::none:
      return false;
  }
  return false;
}

}  // namespace parian

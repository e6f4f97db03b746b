// The window's panels. Each draws one part of the studio and turns what is done there into calls of
// studio.h and tools.h; nothing is computed here.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/studio/flat_zoom.h"
#include "app/studio/probe.h"
#include "app/studio/studio.h"
#include "app/studio/window.h"
#include "gl/screen.h"

namespace parian {

struct Ui;

// A choice of files by walking through folders.
struct FileDialog {
  enum class Action {
    open,
    open_second,
    open_layer,
    open_photograph,
    choose,
    save_recipe,
    save_scene,
    save_map,
    save_picture,
    save_blend
  };
  Action action = Action::open;
  bool wants_open = false;
  std::string folder, name;
  std::string title;  // of `choose`
  std::function<void(Ui&, const std::string& path)> then;
};

struct Ui {
  Studio& studio;
  Probe& probe;
  Window& window;
  ScreenTexture view, flat;
  std::shared_ptr<const Picture> view_picture;  // what the texture shows
  std::uint64_t flat_id = 0;
  FlatZoom flat_zoom;
  FileDialog dialog;
  bool shows_help = false;
  bool wants_quit = false;
  bool wants_screenshot = false;
  // The layer whose text is being edited, and the text.
  std::optional<std::size_t> text_layer;
  std::string text, text_before;
  std::array<double, 2> bounds{};                      // of the property that a threshold compares
  std::array<std::uint64_t, 4> bounds_of{};            // map, its state, property and channel
  std::string edited_key;                              // of the parameter that was changed last
  std::pair<std::size_t, std::size_t> history_seen{};  // position and rows: what is new is shown
  std::optional<double> shape_drag;                    // the point of the shape curve that is held
  std::vector<std::array<float, 2>> view_stroke;       // a stroke on the mesh, on the screen
};

void draw_menu(Ui& ui);
void draw_toolbar(Ui& ui);
void draw_view(Ui& ui);
void draw_flat_view(Ui& ui);
void draw_profile(Ui& ui);
void draw_status(Ui& ui);
void draw_notice(Ui& ui, const PanelBox& view);
void draw_layers(Ui& ui);
void draw_material(Ui& ui);
void draw_light(Ui& ui);
void draw_surface(Ui& ui);
void draw_compression(Ui& ui);
void draw_history(Ui& ui);
void draw_statistics(Ui& ui);
void draw_messages(Ui& ui);
void draw_help(Ui& ui);
void draw_dialogs(Ui& ui);
// True: the program may end. Unsaved recipes are asked about.
bool draw_quit(Ui& ui);
void handle_shortcuts(Ui& ui);
void start_dialog(Ui& ui, FileDialog::Action action, const std::string& name);
void save_present_recipe(Ui& ui);
// Any file, for what `then` does with it.
void choose_file(Ui& ui, const std::string& title,
                 std::function<void(Ui&, const std::string& path)> then);

// Sliders for described parameters inside a document: sets changed keys there and returns true.
// `ended`: a drag was let go.
bool draw_params(Ui& ui, const ParamList& params, Document& document, bool& ended);

// The same for the many of strokes: most of them are folded away.
bool draw_folded_params(Ui& ui, const ParamList& params, Document& document, bool& ended);

// The selection of a layer, and strokes under "strokes", with parameters of their own or without.
bool draw_place(Ui& ui, Document& part, const char* key, bool& ended);
bool draw_selection_form(Ui& ui, Document& layer, bool& ended);
// The bounds of a threshold, each on a slider of the property's range.
bool draw_threshold(Ui& ui, const ParamList& params, Document& part, bool& ended);
bool draw_stroke_list(Ui& ui, Document& holder, bool with_adjust, bool& ended);

// The item that ImGui drew last, for scripted runs.
void mark(Probe& probe, const std::string& name);
// A list that drops down; each entry is marked as group/name.
bool draw_names(Ui& ui, const std::string& group, const std::vector<std::string>& names,
                std::size_t& value);
template <typename Enum>
bool draw_choice(Ui& ui, const std::string& group, const std::vector<std::string>& names,
                 Enum& value) {
  auto index = static_cast<std::size_t>(value);
  if (!draw_names(ui, group, names, index)) return false;
  value = static_cast<Enum>(index);
  return true;
}
// The next item stands beside the last one where there is room for its width, else below.
void flow(float width);
// Help for the item that ImGui drew last.
void explain(const char* text);

}  // namespace parian

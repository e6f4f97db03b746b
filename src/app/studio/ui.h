// The window's panels. Each draws one part of the studio and turns what is done there into calls of
// studio.h and tools.h; nothing is computed here.
#pragma once

#include <optional>
#include <string>

#include "app/studio/probe.h"
#include "app/studio/studio.h"
#include "app/studio/window.h"
#include "gl/screen.h"

namespace parian {

// A choice of files by walking through folders.
struct FileDialog {
  enum class Action { open, save_recipe, save_map, save_picture, save_compressed };
  Action action = Action::open;
  bool wants_open = false;
  std::string folder, name;
};

struct Ui {
  Studio& studio;
  Probe& probe;
  Window& window;
  ScreenTexture view, flat;
  std::uint64_t view_id = 0, flat_id = 0;  // of what the textures show
  bool view_is_refined = false;
  FileDialog dialog;
  bool shows_help = false;
  bool wants_quit = false;
  bool wants_screenshot = false;
  std::string screenshot_path;
  // The layer whose text is being edited, and the text.
  std::optional<std::size_t> text_layer;
  std::string text;
  bool text_is_old = true;
  std::optional<double> shape_drag;  // the point of the shape curve that is held
};

void draw_menu(Ui& ui);
void draw_toolbar(Ui& ui);
void draw_view(Ui& ui);
void draw_flat_view(Ui& ui);
void draw_profile(Ui& ui);
void draw_status(Ui& ui);
void draw_layers(Ui& ui);
void draw_material(Ui& ui);
void draw_light(Ui& ui);
void draw_compression(Ui& ui);
void draw_history(Ui& ui);
void draw_statistics(Ui& ui);
void draw_dialogs(Ui& ui);
void handle_shortcuts(Ui& ui);

// Sliders for described parameters inside a document: sets changed keys there and returns true.
// `ended`: a drag was let go.
bool draw_params(Ui& ui, const ParamList& params, Document& document, bool& ended);

}  // namespace parian

// The recipe: its layers and their parameters.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <filesystem>

#include "app/studio/strokes.h"
#include "app/studio/tools.h"
#include "app/studio/ui.h"
#include "base/error.h"
#include "io/json/json.h"

namespace parian {
namespace {

void draw_switch(Ui& ui, std::size_t i) {
  Studio& studio = ui.studio;
  const LayerSnapshot& layer = studio.snapshot->layers[i];
  bool enabled = layer.enabled;
  if (ImGui::Checkbox("##on", &enabled)) {
    Document changed = layer.source;
    set(changed, "enabled", enabled);
    studio.editor->post((enabled ? "show " : "hide ") + layer.name, set_layer(i, changed));
    touch_map(studio);
  }
  mark(ui.probe, fmt::format("layer/{}/on", i));
  explain("on or off (Space)");
}

void draw_move_buttons(Ui& ui, std::size_t i) {
  Studio& studio = ui.studio;
  const std::string& name = studio.snapshot->layers[i].name;
  const auto move = [&](std::size_t to) {
    studio.editor->post("move " + name, move_layer(i, to));
    studio.selected_layer = to;
    touch_map(studio);
  };
  // The list shows the last layer on top.
  if (ImGui::ArrowButton("up", ImGuiDir_Up) && i + 1 < studio.snapshot->layers.size()) move(i + 1);
  mark(ui.probe, fmt::format("layer/{}/up", i));
  explain("apply later");
  ImGui::SameLine(0, 2);
  if (ImGui::ArrowButton("down", ImGuiDir_Down) && i > 0) move(i - 1);
  mark(ui.probe, fmt::format("layer/{}/down", i));
  explain("apply earlier");
  ImGui::SameLine(0, 2);
  if (ImGui::Button("×", {ImGui::GetFrameHeight(), 0})) {
    studio.editor->post("remove " + name, remove_layer(i));
    touch_map(studio);
  }
  mark(ui.probe, fmt::format("layer/{}/remove", i));
  explain("remove (Delete)");
}

void draw_row(Ui& ui, std::size_t i) {
  Studio& studio = ui.studio;
  const LayerSnapshot& layer = studio.snapshot->layers[i];
  ImGui::PushID(static_cast<int>(i));
  draw_switch(ui, i);
  ImGui::SameLine();
  const float buttons = 3 * ImGui::GetFrameHeight() + 12;
  const float room = std::max(1.0f, ImGui::GetContentRegionAvail().x - buttons);
  const std::string label =
      layer.name == layer.kind ? layer.name : fmt::format("{} ({})", layer.name, layer.kind);
  ImGui::AlignTextToFramePadding();
  if (ImGui::Selectable(label.c_str(), studio.selected_layer == i, 0, {room, 0})) {
    studio.selected_layer = i;
    studio.part.clear();
    studio.selected_stroke = 0;
    studio.flat_is_stale = true;
    if (studio.show_selection) touch_view(studio);
  }
  mark(ui.probe, fmt::format("layer/{}", i));
  ImGui::SameLine();
  draw_move_buttons(ui, i);
  ImGui::PopID();
}

const OperationKind* find_kind(const std::string& name) {
  for (const OperationKind& kind : operation_kinds())
    if (kind.name == name) return &kind;
  return nullptr;
}

// Numbers that every layer has beside those of its operation.
struct LayerNumbers {
  double opacity = 1;
};
ParamList describe(LayerNumbers& numbers) {
  return {{.name = "opacity",
           .help = "factor on the selection",
           .target = &numbers.opacity,
           .min = 0,
           .max = 1}};
}

bool draw_name(Ui& ui, const LayerSnapshot& layer, Document& changed, bool& ended) {
  std::string name = layer.name;
  const bool edits =
      ImGui::InputText("name", &name, ImGuiInputTextFlags_EnterReturnsTrue) && !name.empty();
  mark(ui.probe, "layer name");
  if (!edits) return false;
  set(changed, "name", name);
  ui.edited_key = "name";
  return ended = true;
}

// Places and profiles that operations take from the map.
bool draw_sources(Ui& ui, const LayerSnapshot& layer, Document& changed, bool& ended) {
  bool edits = false;
  for (const char* key : {"min", "max", "to"}) edits |= draw_place(ui, changed, key, ended);
  if (layer.kind != "blend") return edits;
  ImGui::BeginDisabled(!ui.studio.picked);
  if (ImGui::Button("mix in the picked profile")) {
    set(changed, "from", describe_picked(*ui.studio.picked));
    ui.edited_key = "profile";
    edits = ended = true;
  }
  ImGui::EndDisabled();
  mark(ui.probe, "take picked");
  return edits;
}

bool draw_operation(Ui& ui, const LayerSnapshot& layer, Document& changed, bool& ended) {
  const OperationKind* kind = find_kind(layer.kind);
  if (kind == nullptr || !kind->params) return false;
  const bool open = ImGui::CollapsingHeader((layer.kind + "###operation").c_str(),
                                            ImGuiTreeNodeFlags_DefaultOpen);
  mark(ui.probe, "section/operation");
  if (!open) return false;
  const OperationKind::Params params = kind->params();
  bool edits = draw_sources(ui, layer, changed, ended);
  if (layer.kind == "interpolate") {
    edits |= draw_stroke_list(ui, changed, true, ended);
    return draw_folded_params(ui, params.list, changed, ended) || edits;
  }
  return draw_params(ui, params.list, changed, ended) || edits;
}

bool draw_selection(Ui& ui, Document& changed, bool& ended) {
  const bool open = ImGui::CollapsingHeader("selection", ImGuiTreeNodeFlags_DefaultOpen);
  mark(ui.probe, "section/selection");
  return open && draw_selection_form(ui, changed, ended);
}

// Name, opacity, parameters of the operation, and the selection.
void draw_controls(Ui& ui, std::size_t index) {
  const LayerSnapshot& layer = ui.studio.snapshot->layers[index];
  const bool has_selection = takes_selection(layer.kind);
  Document changed = layer.source;
  bool ended = false, edits = draw_name(ui, layer, changed, ended);
  LayerNumbers numbers;
  if (has_selection) edits |= draw_params(ui, describe(numbers), changed, ended);
  edits |= draw_operation(ui, layer, changed, ended);
  if (has_selection) edits |= draw_selection(ui, changed, ended);
  if (edits)
    change_layer(ui.studio, std::move(changed), layer.name + ": " + ui.edited_key,
                 fmt::format("params {} {} {}", index, ui.edited_key, ui.studio.drags));
  if (ended) ++ui.studio.drags;
}

void draw_text(Ui& ui, std::size_t index) {
  const LayerSnapshot& layer = ui.studio.snapshot->layers[index];
  if (!ImGui::CollapsingHeader("as text")) {
    ui.text_layer.reset();
    return;
  }
  const std::string present = format_document(layer.source);
  // Text that nobody has touched follows the layer.
  if (ui.text_layer != index || (ui.text == ui.text_before && present != ui.text_before)) {
    ui.text = ui.text_before = present;
    ui.text_layer = index;
  }
  ImGui::InputTextMultiline("##text", &ui.text, {-1, ImGui::GetTextLineHeight() * 12});
  const bool applies = ImGui::Button("apply");
  mark(ui.probe, "apply text");
  if (applies) {
    try {
      ui.studio.editor->post("text of " + layer.name,
                             set_layer(index, parse_document(ui.text, layer.name)));
      touch_map(ui.studio);
    } catch (const Error& error) {
      report(ui.studio, error.what(), true);
    }
  }
  ImGui::SameLine();
  if (ImGui::Button("read again")) ui.text_layer.reset();
}

void draw_add(Ui& ui) {
  Studio& studio = ui.studio;
  if (ImGui::Button("Add layer", {ImGui::GetContentRegionAvail().x, 0}))
    ImGui::OpenPopup("add layer");
  mark(ui.probe, "add layer");
  if (!ImGui::BeginPopup("add layer")) return;
  for (const OperationKind& kind : operation_kinds()) {
    if (ImGui::MenuItem(kind.name.c_str())) {
      try {
        add_layer(studio, make_starting_layer(studio, kind.name));
      } catch (const Error& error) {
        report(studio, error.what(), true);
      }
    }
    mark(ui.probe, "add layer/" + kind.name);
    ImGui::SameLine(9 * ImGui::GetFontSize());
    ImGui::TextDisabled("%s", kind.summary.c_str());
  }
  ImGui::EndPopup();
}

}  // namespace

void draw_layers(Ui& ui) {
  Studio& studio = ui.studio;
  if (studio.snapshot == nullptr) return ImGui::TextDisabled("No map is open.");
  if (studio.is_homogeneous)
    return ImGui::TextWrapped("A homogeneous material has no layers: see Material.");
  draw_add(ui);
  for (std::size_t i = studio.snapshot->layers.size(); i-- > 0;) draw_row(ui, i);
  ImGui::TextDisabled("%s", std::filesystem::path(studio.material_path).filename().c_str());
  explain(studio.material_path.c_str());
  if (studio.snapshot->layers.empty())
    ImGui::TextWrapped("Scribble on the flat map or on the mesh, or add a layer.");
  if (selected_layer(studio) == nullptr) return;
  const std::size_t index = *studio.selected_layer;
  ImGui::Separator();
  draw_controls(ui, index);
  const EditReport& kept = studio.snapshot->layers[index].report;
  if (kept.clamped_albedo + kept.clamped_range > 0)
    ImGui::TextDisabled("%zu albedos and %zu ranges kept at their limits", kept.clamped_albedo,
                        kept.clamped_range);
  draw_text(ui, index);
}

}  // namespace parian

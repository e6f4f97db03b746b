// The recipe: its layers, their parameters, and its history.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <filesystem>

#include "app/studio/tools.h"
#include "app/studio/ui.h"
#include "base/error.h"
#include "io/json/json.h"

namespace parian {
namespace {

void post_layer(Ui& ui, std::size_t index, Document layer, const std::string& label,
                const std::string& what) {
  Studio& studio = ui.studio;
  studio.editor->post(label, set_layer(index, std::move(layer)),
                      fmt::format("{} {} {}", what, index, studio.drags));
  touch_map(studio);
}

void draw_row(Ui& ui, std::size_t i) {
  Studio& studio = ui.studio;
  const LayerSnapshot& layer = studio.snapshot->layers[i];
  ImGui::PushID(static_cast<int>(i));
  bool enabled = layer.enabled;
  if (ImGui::Checkbox("##on", &enabled)) {
    Document changed = layer.source;
    set(changed, "enabled", enabled);
    studio.editor->post((enabled ? "show " : "hide ") + layer.name,
                        set_layer(i, std::move(changed)));
    touch_map(studio);
  }
  mark(ui.probe, fmt::format("layer/{}/on", i));
  ImGui::SameLine();
  const bool is_selected = studio.selected_layer == i;
  const float room = ImGui::GetContentRegionAvail().x - 4.6f * ImGui::GetFrameHeight();
  if (ImGui::Selectable(fmt::format("{} ({})", layer.name, layer.kind).c_str(), is_selected, 0,
                        {room, 0})) {
    studio.selected_layer = i;
    studio.flat_is_stale = true;
    if (studio.show_selection) touch_view(studio);
  }
  mark(ui.probe, fmt::format("layer/{}", i));
  const auto move = [&](std::size_t to) {
    studio.editor->post("move " + layer.name, move_layer(i, to));
    studio.selected_layer = to;
    touch_map(studio);
  };
  ImGui::SameLine();
  if (ImGui::ArrowButton("up", ImGuiDir_Up) && i > 0) move(i - 1);
  ImGui::SameLine();
  if (ImGui::ArrowButton("down", ImGuiDir_Down) && i + 1 < studio.snapshot->layers.size())
    move(i + 1);
  ImGui::SameLine();
  if (ImGui::SmallButton("x")) {
    studio.editor->post("remove " + layer.name, remove_layer(i));
    touch_map(studio);
  }
  mark(ui.probe, fmt::format("layer/{}/remove", i));
  ImGui::PopID();
}

const OperationKind* find_kind(const std::string& name) {
  for (const OperationKind& kind : operation_kinds())
    if (kind.name == name) return &kind;
  return nullptr;
}

// Parameters of the operation, opacity, and the selection's edge.
void draw_controls(Ui& ui, std::size_t index) {
  const LayerSnapshot& layer = ui.studio.snapshot->layers[index];
  Document changed = layer.source;
  bool ended = false, edits = false;
  const OperationKind* kind = find_kind(layer.kind);
  static double opacity = 1;
  opacity = 1;
  edits |= draw_params(ui,
                       {{.name = "opacity",
                         .help = "factor on the selection",
                         .target = &opacity,
                         .min = 0,
                         .max = 1}},
                       changed, ended);
  if (kind != nullptr && kind->params) {
    const OperationKind::Params params = kind->params();
    edits |= draw_params(ui, params.list, changed, ended);
  }
  if (edits) post_layer(ui, index, std::move(changed), layer.name, "params");
  if (ended) ++ui.studio.drags;
}

void draw_text(Ui& ui, std::size_t index) {
  const LayerSnapshot& layer = ui.studio.snapshot->layers[index];
  if (!ImGui::CollapsingHeader("as text")) {
    ui.text_layer.reset();
    return;
  }
  if (ui.text_layer != index) {
    ui.text = format_document(layer.source);
    ui.text_layer = index;
  }
  ImGui::InputTextMultiline("##text", &ui.text, {-1, ImGui::GetTextLineHeight() * 12});
  if (ImGui::Button("apply")) {
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

}  // namespace

void draw_layers(Ui& ui) {
  Studio& studio = ui.studio;
  if (studio.snapshot == nullptr) return ImGui::TextUnformatted("no map");
  if (studio.is_homogeneous)
    return ImGui::TextWrapped("A homogeneous material has no layers: see Material.");
  if (ImGui::Button("add layer")) ImGui::OpenPopup("add layer");
  mark(ui.probe, "add layer");
  if (ImGui::BeginPopup("add layer")) {
    for (const OperationKind& kind : operation_kinds()) {
      if (ImGui::MenuItem(kind.name.c_str()))
        add_layer(studio, make_default_layer(kind.name, kind.name));
      mark(ui.probe, "add layer/" + kind.name);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", kind.summary.c_str());
    }
    ImGui::EndPopup();
  }
  ImGui::Separator();
  for (std::size_t i = studio.snapshot->layers.size(); i-- > 0;) draw_row(ui, i);
  ImGui::TextDisabled("%s", std::filesystem::path(studio.material_path).filename().c_str());
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", studio.material_path.c_str());
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

void draw_history(Ui& ui) {
  Studio& studio = ui.studio;
  if (studio.snapshot == nullptr) return;
  const auto& past = studio.snapshot->history;
  const auto& next = studio.snapshot->future;
  const auto undo_to = [&](std::size_t steps) {
    for (std::size_t i = 0; i < steps; ++i) studio.editor->undo();
    touch_map(studio);
  };
  if (ImGui::Selectable("as opened", past.empty())) undo_to(past.size());
  for (std::size_t i = 0; i < past.size(); ++i)
    if (ImGui::Selectable(fmt::format("{}##{}", past[i], i).c_str(), i + 1 == past.size()))
      undo_to(past.size() - 1 - i);
  for (std::size_t i = 0; i < next.size(); ++i) {
    ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    if (ImGui::Selectable(fmt::format("{}##next{}", next[i], i).c_str())) {
      for (std::size_t k = 0; k <= i; ++k) studio.editor->redo();
      touch_map(studio);
    }
    ImGui::PopStyleColor();
  }
}

}  // namespace parian

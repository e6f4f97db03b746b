// The selection of a layer: a tree of parts, and the form of the one that is chosen.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <utility>

#include "app/studio/tools.h"
#include "app/studio/ui.h"

namespace parian {
namespace {

const SelectionKind& kind_of(const std::string& type) {
  const std::vector<SelectionKind>& kinds = selection_kinds();
  const auto found = std::find_if(kinds.begin(), kinds.end(),
                                  [&](const SelectionKind& kind) { return kind.name == type; });
  return found != kinds.end() ? *found : kinds.front();
}

bool takes_key(const SelectionKind& kind, const char* key) {
  return std::find(kind.keys.begin(), kind.keys.end(), key) != kind.keys.end();
}

PartStart make_start(const Studio& studio) {
  const EditState& state = studio.snapshot->after;
  return {.state = state,
          .at_mm = {(studio.inspected.x + 0.5) * state.pixel_pitch_mm,
                    (studio.inspected.y + 0.5) * state.pixel_pitch_mm},
          .brush_mm = studio.brush_radius_mm};
}

// Images need a file first; all other kinds start with something to see.
void choose_image(Ui& ui, bool adds) {
  choose_file(ui, "Choose the selection's picture", [adds](Ui& u, const std::string& path) {
    Studio& studio = u.studio;
    const LayerSnapshot* layer = selected_layer(studio);
    if (layer == nullptr) return;
    PartStart start = make_start(studio);
    start.file = path;
    Document changed = layer->source;
    const Document* present = find(changed, "selection");
    Document selection = present != nullptr ? *present : make_part("image", start);
    if (present != nullptr && adds) {
      studio.part = add_part(selection, selected_part(studio), make_part("image", start));
    } else if (present != nullptr) {
      const PartPath where = selected_part(studio);
      set_part(selection, where, change_part(*find_part(selection, where), "image", start));
    }
    set(changed, "selection", std::move(selection));
    change_layer(studio, std::move(changed), layer->name + ": image");
  });
}

// The kind that was chosen in an open menu.
std::optional<std::string> draw_kinds(Ui& ui, const std::string& group, bool with_sets) {
  std::optional<std::string> chosen;
  for (const SelectionKind& kind : selection_kinds()) {
    if (!with_sets && is_set(kind.name)) continue;
    if (ImGui::MenuItem(kind.name.c_str())) chosen = kind.name;
    mark(ui.probe, group + "/" + kind.name);
    ImGui::SameLine(7 * ImGui::GetFontSize());
    ImGui::TextDisabled("%s", kind.summary.c_str());
  }
  return chosen;
}

// What was done in the tree.
struct TreeAction {
  std::optional<PartPath> chosen, removed, raised;
};

std::string describe_part(const Document& part) {
  const std::string type = part_type(part);
  std::string text = type;
  const Document* invert = find(part, "invert");
  if (invert != nullptr && as_bool(*invert)) text = "not " + text;
  if (is_set(type)) return fmt::format("{} of {}", text, as_array(get(part, "of")).size());
  if (type == "propagate") {
    const std::size_t strokes = as_array(get(part, "strokes")).size();
    return fmt::format("{}, {} stroke{}", text, strokes, strokes == 1 ? "" : "s");
  }
  if (type == "threshold") return text + " " + as_string(get(part, "property"));
  return text;
}

void draw_tree(Ui& ui, const Document& part, PartPath& path, TreeAction& action) {
  ImGui::PushID(path.empty() ? 0 : static_cast<int>(path.back()));
  std::string name = "part";
  for (const std::size_t index : path) name += fmt::format("/{}", index);
  const float frame = ImGui::GetFrameHeight();
  const float indent = static_cast<float>(path.size()) * ImGui::GetFontSize();
  ImGui::SetCursorPosX(ImGui::GetCursorPosX() + indent);
  const float room = std::max(1.0f, ImGui::GetContentRegionAvail().x - 2 * frame - 10);
  ImGui::AlignTextToFramePadding();
  if (ImGui::Selectable(describe_part(part).c_str(), selected_part(ui.studio) == path, 0,
                        {room, 0}))
    action.chosen = path;
  mark(ui.probe, name);
  ImGui::SameLine();
  ImGui::BeginDisabled(path.empty() || path.back() == 0);
  if (ImGui::ArrowButton("earlier", ImGuiDir_Up)) action.raised = path;
  mark(ui.probe, name + "/earlier");
  explain("before its neighbour: of a difference the first is what the others are taken from");
  ImGui::EndDisabled();
  ImGui::SameLine(0, 2);
  if (ImGui::Button("×", {frame, 0})) action.removed = path;
  mark(ui.probe, name + "/remove");
  explain(path.empty() ? "remove the selection: the layer works on all of the map" : "remove");
  if (is_set(part_type(part))) {
    const Document::Array& parts = as_array(get(part, "of"));
    ImGui::PushID("of");
    for (std::size_t i = 0; i < parts.size(); ++i) {
      path.push_back(i);
      draw_tree(ui, parts[i], path, action);
      path.pop_back();
    }
    ImGui::PopID();
  }
  ImGui::PopID();
}

std::size_t count_rows(const Document& part) {
  std::size_t rows = 1;
  if (is_set(part_type(part)))
    for (const Document& inner : as_array(get(part, "of"))) rows += count_rows(inner);
  return rows;
}

// True: the selection changed; empty then where nothing is left of it.
bool draw_parts(Ui& ui, std::optional<Document>& selection) {
  constexpr std::size_t most_rows = 7;
  const std::size_t rows = count_rows(*selection);
  TreeAction action;
  PartPath path;
  if (rows > most_rows)
    ImGui::BeginChild("parts", {0, most_rows * ImGui::GetFrameHeightWithSpacing()}, true);
  draw_tree(ui, *selection, path, action);
  if (rows > most_rows) ImGui::EndChild();
  if (action.chosen) ui.studio.part = *action.chosen;
  if (action.raised) {
    ui.studio.part = raise_part(*selection, *action.raised);
    ui.edited_key = "order of parts";
  }
  if (action.removed) {
    ui.studio.part.clear();
    ui.edited_key = "removed part";
    if (!remove_part(*selection, *action.removed)) selection.reset();
  }
  return action.raised || action.removed;
}

// A part more, or the first. True: it is there.
bool draw_add(Ui& ui, std::optional<Document>& selection) {
  Studio& studio = ui.studio;
  const char* label = selection ? "Add part" : "Select a part of the map";
  if (ImGui::Button(label, {ImGui::GetContentRegionAvail().x, 0})) ImGui::OpenPopup("add part");
  mark(ui.probe, "add part");
  explain(selection ? "beside the chosen part: shapes of a union, an intersection or a difference"
                    : "or draw on the map or the mesh: select, brush, scribble");
  if (!ImGui::BeginPopup("add part")) return false;
  const std::optional<std::string> kind = draw_kinds(ui, "add part", !selection);
  ImGui::EndPopup();
  if (!kind) return false;
  if (*kind == "image") {
    choose_image(ui, true);
    return false;
  }
  Document part = make_part(*kind, make_start(studio));
  if (selection)
    studio.part = add_part(*selection, selected_part(studio), std::move(part));
  else
    selection = std::move(part);
  ui.edited_key = "new " + *kind;
  return true;
}

bool draw_kind(Ui& ui, Document& part) {
  const std::string type = part_type(part);
  const bool open = ImGui::BeginCombo("kind", type.c_str(), ImGuiComboFlags_HeightLargest);
  mark(ui.probe, "selection kind");
  if (!open) return false;
  const std::optional<std::string> kind = draw_kinds(ui, "selection kind", true);
  ImGui::EndCombo();
  if (!kind || *kind == type) return false;
  if (*kind == "image") {
    choose_image(ui, false);
    return false;
  }
  part = change_part(part, *kind, make_start(ui.studio));
  ui.edited_key = "kind of selection";
  return true;
}

bool draw_places(Ui& ui, Document& part, bool& ended) {
  bool changed = false;
  for (const char* key : {"min", "max", "center", "radii", "from", "to", "at"})
    changed |= draw_place(ui, part, key, ended);
  if (const Document* points = find(part, "points"))
    ImGui::TextDisabled("%zu points", as_array(*points).size());
  const bool has_places = find_outline(part, size_of(ui.studio.snapshot->after)).points.empty();
  if (has_places || ui.studio.tool == Tool::select) return changed;
  if (ImGui::Button("draw on the map")) ui.studio.tool = Tool::select;
  mark(ui.probe, "draw places");
  explain("takes the tool 'select': drag on the flat map, or drag the handles (9)");
  return changed;
}

bool draw_image(Ui& ui, Document& part, bool& ended) {
  if (part_type(part) != "image") return false;
  std::string file = as_string(get(part, "file"));
  const bool changed =
      ImGui::InputText("file", &file, ImGuiInputTextFlags_EnterReturnsTrue) && !file.empty();
  mark(ui.probe, "image file");
  explain(file.c_str());
  if (ImGui::Button("another picture…")) choose_image(ui, false);
  mark(ui.probe, "choose image");
  if (!changed) return false;
  set(part, "file", file);
  ui.edited_key = "file";
  return ended = true;
}

bool draw_table(Ui& ui, Document& part, bool& ended) {
  const Document* distance = find(part, "distance");
  if (distance == nullptr || as_string(*distance) != "bssrdf") {
    if (find(part, "table") == nullptr) return false;
    remove_key(part, "table");  // of another distance it would be an error
    return true;
  }
  const Document* table = find(part, "table");
  std::string file = table != nullptr ? as_string(*table) : std::string();
  if (!ImGui::InputTextWithHint("table", "the map itself", &file,
                                ImGuiInputTextFlags_EnterReturnsTrue))
    return false;
  remove_key(part, "table");
  if (!file.empty()) set(part, "table", file);
  ui.edited_key = "table";
  return ended = true;
}

bool draw_numbers(Ui& ui, Document& part, bool& ended) {
  const SelectionKind& kind = kind_of(part_type(part));
  const OperationKind::Params params = kind.params();
  if (kind.name == "threshold") return draw_threshold(ui, params.list, part, ended);
  const bool changed = draw_folded_params(ui, params.list, part, ended);
  return (takes_key(kind, "table") && draw_table(ui, part, ended)) || changed;
}

bool draw_unit(Ui& ui, Document& part, bool& ended) {
  auto index = static_cast<std::size_t>(is_relative(part) ? 1 : 0);
  const bool changed = draw_names(ui, "unit", {"mm", "relative to the map"}, index);
  ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
  ImGui::TextUnformatted("unit");
  if (!changed) return false;
  convert_unit(part, index == 1, size_of(ui.studio.snapshot->after));
  ui.edited_key = "unit";
  return ended = true;
}

bool draw_part_form(Ui& ui, Document& part, bool& ended) {
  if (draw_kind(ui, part)) return ended = true;
  bool changed = draw_places(ui, part, ended);
  changed |= draw_image(ui, part, ended);
  if (part_type(part) == "propagate") changed |= draw_stroke_list(ui, part, false, ended);
  changed |= draw_numbers(ui, part, ended);
  const OperationKind::Params modifiers = make_modifier_params();
  changed |= draw_params(ui, modifiers.list, part, ended);
  changed |= draw_unit(ui, part, ended);
  return changed;
}

}  // namespace

bool draw_place(Ui& ui, Document& part, const char* key, bool& ended) {
  const Document* node = find(part, key);
  if (node == nullptr) return false;
  std::vector<double> place = as_numbers(*node);
  if (place.size() != 2) return false;
  const float speed = is_relative(part) ? 0.002f : 0.02f;
  const bool changed = ImGui::DragScalarN(key, ImGuiDataType_Double, place.data(), 2, speed,
                                          nullptr, nullptr, "%.4g");
  ended |= ImGui::IsItemDeactivatedAfterEdit();
  mark(ui.probe, std::string("place/") + key);
  explain(is_relative(part) ? "x and y, parts of the map's width and height" : "x and y in mm");
  if (!changed) return false;
  set(part, key, Document::Array{place[0], place[1]});
  ui.edited_key = key;
  return true;
}

bool draw_selection_form(Ui& ui, Document& layer, bool& ended) {
  const Document* present = find(layer, "selection");
  std::optional<Document> selection = present != nullptr ? std::optional(*present) : std::nullopt;
  ImGui::PushID("selection");
  if (!selection) ImGui::TextDisabled("on all of the map");
  bool changed = selection && draw_parts(ui, selection);
  changed |= draw_add(ui, selection);
  ended |= changed;
  if (selection && !changed) {
    const PartPath path = selected_part(ui.studio);
    Document part = *find_part(*selection, path);
    changed = draw_part_form(ui, part, ended);
    if (changed) set_part(*selection, path, std::move(part));
  }
  ImGui::PopID();
  if (!changed) return false;
  remove_key(layer, "selection");
  if (selection) set(layer, "selection", *std::move(selection));
  return true;
}

}  // namespace parian

#include <algorithm>

#include "app/studio/panel_overlay.h"
#include "app/studio/tools.h"

namespace parian {
namespace {

constexpr ImU32 positive_color = IM_COL32(255, 220, 60, 255);
constexpr ImU32 negative_color = IM_COL32(255, 60, 220, 255);
constexpr ImU32 faint_color = IM_COL32(255, 255, 255, 150);
constexpr ImU32 shadow_color = IM_COL32(0, 0, 0, 160);

void draw_line(const FlatFrame& frame, const PartOutline& outline, ImU32 color, float width) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  std::vector<ImVec2> line;
  line.reserve(outline.points.size());
  for (const Place& place : outline.points) line.push_back(frame.to_screen(place[0], place[1]));
  const ImDrawFlags flags = outline.is_closed ? ImDrawFlags_Closed : 0;
  const int count = static_cast<int>(line.size());
  if (count == 1) list->AddCircleFilled(line.front(), 1.5f * width, color);
  list->AddPolyline(line.data(), count, shadow_color, flags, width + 1.5f);
  list->AddPolyline(line.data(), count, color, flags, width);
}

// Of a scribble; the selected one is wider.
void draw_strokes(const Studio& studio, const FlatFrame& frame, const Document& holder,
                  bool is_selected) {
  const Document* strokes = find(holder, "strokes");
  if (strokes == nullptr) return;
  const MapSize size = size_of(studio.snapshot->after);
  const Document::Array& array = as_array(*strokes);
  for (std::size_t i = 0; i < array.size(); ++i) {
    Document stroke = array[i];
    set(stroke, "type", "stroke");
    const Document* positive = find(stroke, "positive");
    const bool is_negative = positive != nullptr && !as_bool(*positive);
    const bool is_wide = is_selected && array.size() > 1 && i == studio.selected_stroke;
    draw_line(frame, find_outline(stroke, size), is_negative ? negative_color : positive_color,
              is_wide ? 4 : 2);
  }
}

void draw_tree(const Studio& studio, const FlatFrame& frame, const Document& part, PartPath& path,
               const PartPath& selected) {
  const std::string type = part_type(part);
  if (is_set(type)) {
    const Document::Array& parts = as_array(get(part, "of"));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      path.push_back(i);
      draw_tree(studio, frame, parts[i], path, selected);
      path.pop_back();
    }
    return;
  }
  if (type == "propagate") return draw_strokes(studio, frame, part, path == selected);
  const PartOutline outline = find_outline(part, size_of(studio.snapshot->after));
  draw_line(frame, outline, path == selected || type == "stroke" ? positive_color : faint_color, 2);
  if (type != "gradient") return;
  // Where it is whole.
  const ImVec2 end = frame.to_screen(outline.points[1][0], outline.points[1][1]);
  ImGui::GetWindowDrawList()->AddCircleFilled(end, 0.35f * ImGui::GetFontSize(), positive_color);
}

void draw_handles(const Studio& studio, const FlatFrame& frame, const Document& part) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float half = 0.24f * ImGui::GetFontSize();
  for (const Place& place : find_handles(part, size_of(studio.snapshot->after))) {
    const ImVec2 at = frame.to_screen(place[0], place[1]);
    list->AddRectFilled({at.x - half - 1, at.y - half - 1}, {at.x + half + 1, at.y + half + 1},
                        shadow_color);
    list->AddRectFilled({at.x - half, at.y - half}, {at.x + half, at.y + half}, positive_color);
  }
}

}  // namespace

void draw_selection(const Studio& studio, const FlatFrame& frame) {
  const LayerSnapshot* layer = selected_layer(studio);
  if (layer == nullptr) return;
  if (layer->kind == "interpolate") draw_strokes(studio, frame, layer->source, true);
  const Document* selection = find(layer->source, "selection");
  if (selection == nullptr) return;
  PartPath path;
  const PartPath selected = selected_part(studio);
  draw_tree(studio, frame, *selection, path, selected);
  if (studio.tool == Tool::select) draw_handles(studio, frame, *find_part(*selection, selected));
}

void draw_present_selection(const Studio& studio, const FlatFrame& frame) {
  const StrokeLine& line = studio.stroke.lines.front();
  const LayerSnapshot* layer = selected_layer(studio);
  const Document* selection = layer != nullptr ? find(layer->source, "selection") : nullptr;
  Document part{Document::Object{{"type", "rectangle"}}};
  if (selection != nullptr) {
    const Document& present = *find_part(*selection, selected_part(studio));
    if (!is_set(part_type(present))) part = present;
  }
  const std::string type = part_type(part);
  if (type == "propagate" || type == "polygon" || type == "stroke")
    return draw_line(frame, {line, type == "polygon"}, positive_color, 2);
  if (type == "rectangle") place_part(part, {{{0, 0}, {1, 1}}});
  if (draw_part(part, line, size_of(studio.snapshot->after)))
    draw_line(frame, find_outline(part, size_of(studio.snapshot->after)), positive_color, 2);
}

}  // namespace parian

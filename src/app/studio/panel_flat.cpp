// The flat view of the map, or of the second material, and what the mouse does in it.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>

#include "app/studio/panel_overlay.h"
#include "app/studio/pictures.h"
#include "app/studio/tools.h"
#include "app/studio/ui.h"

namespace parian {
namespace {

constexpr ImU32 positive_color = IM_COL32(255, 220, 60, 255);
constexpr ImU32 negative_color = IM_COL32(255, 60, 220, 255);
constexpr ImU32 frame_color = IM_COL32(255, 255, 255, 200);
constexpr ImU32 shadow_color = IM_COL32(0, 0, 0, 160);

// White on black: seen on any map.
void draw_outline(const FlatFrame& frame, const std::array<double, 4>& box) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 low = frame.to_screen(box[0], box[1]), high = frame.to_screen(box[2], box[3]);
  list->AddRect(low, high, shadow_color, 0, 0, 3);
  list->AddRect(low, high, frame_color, 0, 0, 1);
}

void draw_marks(const Studio& studio, const FlatFrame& frame, bool on_second) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  if (!on_second) {
    const double pitch = studio.snapshot->after.pixel_pitch_mm;
    const ImVec2 at =
        frame.to_screen((studio.inspected.x + 0.5) * pitch, (studio.inspected.y + 0.5) * pitch);
    const float radius = 0.36f * ImGui::GetFontSize();
    list->AddCircle(at, radius, shadow_color, 12, 0.6f * radius);
    list->AddCircle(at, radius, frame_color, 12, 0.3f * radius);
  }
  const bool has_stamp = studio.stamp_source && studio.stamp_source->map.empty() != on_second;
  if (has_stamp) draw_outline(frame, studio.stamp_source->box_mm);
}

void draw_present_stroke(const Studio& studio, const FlatFrame& frame) {
  if (studio.stroke.lines.empty()) return;
  if (studio.tool == Tool::select) return draw_present_selection(studio, frame);
  ImDrawList* list = ImGui::GetWindowDrawList();
  const auto &first = studio.stroke.lines.front().front(),
             &last = studio.stroke.lines.back().back();
  if (studio.tool == Tool::stamp)
    return draw_outline(frame, {first[0], first[1], last[0], last[1]});
  for (const StrokeLine& points : studio.stroke.lines) {
    std::vector<ImVec2> line;
    line.reserve(points.size());
    for (const auto& point : points) line.push_back(frame.to_screen(point[0], point[1]));
    list->AddPolyline(
        line.data(), static_cast<int>(line.size()),
        studio.tool == Tool::scribble_minus ? negative_color : positive_color, 0,
        std::max(2.0f, static_cast<float>(2 * studio.brush_radius_mm) * frame.per_mm));
  }
}

void draw_brush(const Studio& studio, const FlatFrame& frame) {
  const bool is_brush =
      draws_on_map(studio.tool) && studio.tool != Tool::stamp && studio.tool != Tool::select;
  if (!ImGui::IsItemHovered() || !is_brush) return;
  const auto radius = std::max(1.0f, static_cast<float>(studio.brush_radius_mm) * frame.per_mm);
  ImGui::GetWindowDrawList()->AddCircle(
      ImGui::GetIO().MousePos, radius,
      studio.tool == Tool::scribble_minus ? negative_color : positive_color, 24, 1.5f);
}

void handle_flat_mouse(Ui& ui, const FlatFrame& frame, bool on_second) {
  Studio& studio = ui.studio;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const double x = static_cast<double>((mouse.x - frame.origin.x) / frame.per_mm),
               y = static_cast<double>((mouse.y - frame.origin.y) / frame.per_mm);
  if (ImGui::IsItemActivated() && !on_second)
    grab_handle(studio, x, y, static_cast<double>(0.6f * ImGui::GetFontSize() / frame.per_mm));
  if (studio.grabbed) {
    if (ImGui::IsItemActive()) drag_handle(studio, x, y);
    if (!ImGui::IsItemDeactivated()) return;
    studio.grabbed.reset();
    ++studio.drags;
    return;
  }
  if (draws_on_map(studio.tool)) {
    if (ImGui::IsItemActive()) extend_stroke(studio, x, y, on_second);
    if (ImGui::IsItemDeactivated()) finish_stroke(studio);
    return;
  }
  if (!ImGui::IsItemActive()) return;
  if (on_second) return pick_second(studio, x, y);
  if (const auto pixel = pixel_at(studio.snapshot->after, x, y)) pick_pixel(studio, *pixel);
}

void draw_flat_options(Ui& ui) {
  Studio& studio = ui.studio;
  const float em = ImGui::GetFontSize();
  ImGui::SetNextItemWidth(7.5f * em);
  if (draw_choice(ui, "flat mode", flat_mode_names(), studio.flat_mode))
    studio.flat_is_stale = true;
  explain("a property of the map, the selected layer's selection, or the sample under a light");
  ImGui::SameLine();
  const BrushBounds bounds = brush_bounds(studio);
  const float room = std::max(4 * em, ImGui::GetContentRegionAvail().x);
  ImGui::SetNextItemWidth(room);
  const auto speed = static_cast<float>(0.01 * studio.brush_radius_mm);
  ImGui::DragScalar("##brush", ImGuiDataType_Double, &studio.brush_radius_mm, speed,
                    &bounds.least_mm, &bounds.most_mm, room > 8 * em ? "brush %.2f mm" : "%.2f mm",
                    ImGuiSliderFlags_AlwaysClamp);
  mark(ui.probe, "brush");
  explain("radius of strokes: drag to the left and right ([ and ])");
  if (studio.second == nullptr) return;
  std::size_t source = studio.flat_shows_second ? 1 : 0;
  ImGui::SetNextItemWidth(std::max(4 * em, ImGui::GetContentRegionAvail().x));
  if (draw_names(
          ui, "flat source",
          {"this map", "second: " + std::filesystem::path(studio.second->path).filename().string()},
          source)) {
    studio.flat_shows_second = source == 1;
    studio.flat_is_stale = true;
  }
}

}  // namespace

void draw_flat_view(Ui& ui) {
  Studio& studio = ui.studio;
  const std::shared_ptr<const EditorSnapshot> snapshot = studio.snapshot;
  if (snapshot == nullptr) return ImGui::TextDisabled("no map is open");
  const EditState* shown = &snapshot->after;
  draw_flat_options(ui);
  if (studio.flat_picture == nullptr) return;
  if (ui.flat_id != studio.flat_id) {
    ui.flat.upload(encode_picture(*studio.flat_picture), studio.flat_picture->width,
                   studio.flat_picture->height, /*smooth=*/false);
    ui.flat_id = studio.flat_id;
  }
  const bool on_second = studio.flat_shows_second && studio.second != nullptr;
  if (on_second) shown = &studio.second->state;
  const double pitch = shown->pixel_pitch_mm;
  const ImVec2 room = ImGui::GetContentRegionAvail(), corner = ImGui::GetCursorScreenPos();
  const auto columns = static_cast<float>(ui.flat.width()),
             rows = static_cast<float>(ui.flat.height());
  const float zoom_factor = std::max(0.02f, std::min(room.x / columns, room.y / rows));
  const ImVec2 size{columns * zoom_factor, rows * zoom_factor};
  const FlatFrame frame{{corner.x + std::max(0.0f, std::floor((room.x - size.x) / 2)),
                         corner.y + std::max(0.0f, std::floor((room.y - size.y) / 2))},
                        zoom_factor / static_cast<float>(pitch)};
  ImGui::SetCursorScreenPos(frame.origin);
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImVec2 end{frame.origin.x + size.x, frame.origin.y + size.y};
  list->AddImage(ui.flat.id(), frame.origin, end);
  ImGui::InvisibleButton("flat", {std::max(1.0f, size.x), std::max(1.0f, size.y)});
  mark(ui.probe, "flat");
  handle_flat_mouse(ui, frame, on_second);
  list->PushClipRect(frame.origin, end, true);
  if (!on_second) draw_selection(studio, frame);
  draw_marks(studio, frame, on_second);
  draw_present_stroke(studio, frame);
  draw_brush(studio, frame);
  list->PopClipRect();
}

}  // namespace parian

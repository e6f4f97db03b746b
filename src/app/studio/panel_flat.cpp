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
constexpr ImU32 grid_color = IM_COL32(0, 0, 0, 60);

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
  if (ImGui::IsItemActivated() && ImGui::IsMouseClicked(0) && !on_second)
    grab_handle(studio, x, y, static_cast<double>(0.6f * ImGui::GetFontSize() / frame.per_mm));
  if (studio.grabbed) {
    if (ImGui::IsItemActive()) drag_handle(studio, x, y);
    if (!ImGui::IsItemDeactivated()) return;
    studio.grabbed.reset();
    ++studio.drags;
    return;
  }
  if (draws_on_map(studio.tool)) {
    if (ImGui::IsItemActive() && ImGui::IsMouseDown(0)) extend_stroke(studio, x, y, on_second);
    if (ImGui::IsItemDeactivated()) finish_stroke(studio);
    return;
  }
  if (!ImGui::IsItemActive() || !ImGui::IsMouseDown(0)) return;
  if (on_second) return pick_second(studio, x, y);
  if (const auto pixel = pixel_at(studio.snapshot->after, x, y)) pick_pixel(studio, *pixel);
}

// Where the map is drawn.
struct FlatRoom {
  ImVec2 corner, size;
  int columns = 1, rows = 1;

  FlatPlace place(const FlatZoom& zoom) const {
    return place_flat(zoom, columns, rows, static_cast<double>(size.x),
                      static_cast<double>(size.y));
  }
};

FlatRoom take_room(Ui& ui) {
  const ImVec2 left = ImGui::GetContentRegionAvail();
  return {ImGui::GetCursorScreenPos(),
          {std::max(1.0f, left.x), std::max(1.0f, left.y)},
          ui.flat.width(),
          ui.flat.height()};
}

// The wheel zooms about the pointer, the middle button pans.
void move_flat(Ui& ui, const FlatRoom& room) {
  const ImGuiIO& io = ImGui::GetIO();
  const auto width = static_cast<double>(room.size.x), height = static_cast<double>(room.size.y);
  if (ImGui::IsItemHovered() && io.MouseWheel != 0)
    ui.flat_zoom = zoom_flat(ui.flat_zoom, std::pow(1.25, static_cast<double>(io.MouseWheel)),
                             static_cast<double>(io.MousePos.x - room.corner.x),
                             static_cast<double>(io.MousePos.y - room.corner.y), room.columns,
                             room.rows, width, height);
  if (ImGui::IsItemActive() && ImGui::IsMouseDown(2))
    ui.flat_zoom =
        pan_flat(ui.flat_zoom, static_cast<double>(io.MouseDelta.x),
                 static_cast<double>(io.MouseDelta.y), room.columns, room.rows, width, height);
}

// Between large pixels.
void draw_pixel_grid(const FlatFrame& frame, float pixel, ImVec2 low, ImVec2 high) {
  constexpr float least_pixel = 14;
  if (pixel < least_pixel) return;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const auto first = [&](float from, float origin) {
    return origin + pixel * std::ceil((from - origin) / pixel);
  };
  for (float x = first(low.x, frame.origin.x); x < high.x; x += pixel)
    list->AddLine({x, low.y}, {x, high.y}, grid_color, 1);
  for (float y = first(low.y, frame.origin.y); y < high.y; y += pixel)
    list->AddLine({low.x, y}, {high.x, y}, grid_color, 1);
}

void draw_flat_options(Ui& ui) {
  Studio& studio = ui.studio;
  const float em = ImGui::GetFontSize();
  ImGui::SetNextItemWidth(7.5f * em);
  if (draw_choice(ui, "flat mode", flat_mode_names(), studio.flat_mode))
    studio.flat_is_stale = true;
  explain("a property of the map, the selected layer's selection, or the sample under a light");
  const float spacing = ImGui::GetStyle().ItemSpacing.x, fit = 2.6f * em;
  flow(5 * em + spacing + fit);
  const BrushBounds bounds = brush_bounds(studio);
  const float room = std::max(4 * em, ImGui::GetContentRegionAvail().x - fit - spacing);
  ImGui::SetNextItemWidth(room);
  const auto speed = static_cast<float>(0.01 * studio.brush_radius_mm);
  ImGui::DragScalar("##brush", ImGuiDataType_Double, &studio.brush_radius_mm, speed,
                    &bounds.least_mm, &bounds.most_mm, room > 8 * em ? "brush %.2f mm" : "%.2f mm",
                    ImGuiSliderFlags_AlwaysClamp);
  mark(ui.probe, "brush");
  explain("radius of strokes: drag to the left and right ([ and ])");
  ImGui::SameLine();
  ImGui::BeginDisabled(ui.flat_zoom == FlatZoom{});
  if (ImGui::Button("fit", {fit, 0})) ui.flat_zoom = {};
  ImGui::EndDisabled();
  mark(ui.probe, "flat fit");
  explain("all of the map (Shift+F). Wheel: zoom. Middle button: pan");
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
    const bool has_other_size = studio.flat_picture->width != ui.flat.width() ||
                                studio.flat_picture->height != ui.flat.height();
    if (has_other_size) ui.flat_zoom = {};
    ui.flat.upload(encode_picture(*studio.flat_picture), studio.flat_picture->width,
                   studio.flat_picture->height, /*smooth=*/false);
    ui.flat_id = studio.flat_id;
  }
  const bool on_second = studio.flat_shows_second && studio.second != nullptr;
  if (on_second) shown = &studio.second->state;
  const FlatRoom room = take_room(ui);
  const FlatPlace place = room.place(ui.flat_zoom);
  const FlatFrame frame{
      {room.corner.x + static_cast<float>(place.x), room.corner.y + static_cast<float>(place.y)},
      static_cast<float>(place.pixel / shown->pixel_pitch_mm)};
  const auto pixel = static_cast<float>(place.pixel);
  const ImVec2 end{frame.origin.x + pixel * static_cast<float>(room.columns),
                   frame.origin.y + pixel * static_cast<float>(room.rows)};
  // What of it is seen.
  const ImVec2 low{std::max(frame.origin.x, room.corner.x),
                   std::max(frame.origin.y, room.corner.y)},
      high{std::min(end.x, room.corner.x + room.size.x),
           std::min(end.y, room.corner.y + room.size.y)};
  ImGui::SetCursorScreenPos(low);
  ImDrawList* list = ImGui::GetWindowDrawList();
  ImGui::InvisibleButton("flat", {std::max(1.0f, high.x - low.x), std::max(1.0f, high.y - low.y)},
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonMiddle);
  mark(ui.probe, "flat");
  handle_flat_mouse(ui, frame, on_second);
  move_flat(ui, room);
  list->PushClipRect(low, high, true);
  list->AddImage(ui.flat.id(), frame.origin, end);
  draw_pixel_grid(frame, pixel, low, high);
  if (!on_second) draw_selection(studio, frame);
  draw_marks(studio, frame, on_second);
  draw_present_stroke(studio, frame);
  draw_brush(studio, frame);
  list->PopClipRect();
}

}  // namespace parian

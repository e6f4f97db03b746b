// The 3-D view and the flat view, and what the mouse does in them.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "app/studio/pictures.h"
#include "app/studio/property_picture.h"
#include "app/studio/tools.h"
#include "app/studio/ui.h"

namespace parian {
namespace {

constexpr ImU32 positive_color = IM_COL32(255, 220, 60, 255);
constexpr ImU32 negative_color = IM_COL32(255, 60, 220, 255);
constexpr ImU32 frame_color = IM_COL32(255, 255, 255, 160);

template <typename Enum>
bool draw_choice(Ui& ui, const char* label, const std::string& group,
                 const std::vector<std::string>& names, Enum& value) {
  const auto present = static_cast<std::size_t>(value);
  bool changed = false;
  const bool open = ImGui::BeginCombo(label, names[present].c_str());
  mark(ui.probe, group);
  if (!open) return false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (ImGui::Selectable(names[i].c_str(), i == present)) {
      value = static_cast<Enum>(i);
      changed = true;
    }
    mark(ui.probe, group + "/" + names[i]);
  }
  ImGui::EndCombo();
  return changed;
}

void upload_view(Ui& ui) {
  Studio& studio = ui.studio;
  const bool has_refined =
      studio.refined != nullptr && studio.refined->id == studio.request_id && !studio.is_stale;
  const Picture* shown = has_refined ? studio.refined.get() : studio.picture.get();
  if (shown == nullptr || (shown->id == ui.view_id && has_refined == ui.view_is_refined)) return;
  ui.view.upload(shown->rgba, shown->width, shown->height, /*smooth=*/true);
  ui.view_id = shown->id;
  ui.view_is_refined = has_refined;
}

bool is_drawing_tool(Tool tool) {
  return tool != Tool::orbit && tool != Tool::light && tool != Tool::eyedropper;
}

void drag_light(Studio& studio, ImVec2 delta) {
  const double scale = 180.0 / std::max(1, studio.view_height);
  studio.lighting.azimuth_deg =
      std::remainder(studio.lighting.azimuth_deg + static_cast<double>(delta.x) * scale, 360.0);
  studio.lighting.elevation_deg =
      std::clamp(studio.lighting.elevation_deg - static_cast<double>(delta.y) * scale, -89.0, 89.0);
  touch_view(studio);
}

// On the mesh strokes run over the map under it.
void stroke_on_mesh(Studio& studio, ImVec2 at, bool picks) {
  if (studio.is_homogeneous || studio.snapshot == nullptr || studio.stage == nullptr) return;
  const Camera camera = make_camera(studio.orbit, studio.view_width, studio.view_height);
  const SampleGrid grid{studio.snapshot->after.width, studio.snapshot->after.height,
                        studio.snapshot->after.pixel_pitch_mm};
  const std::optional<MapPlace> place =
      pick(*studio.stage, grid, camera, static_cast<double>(at.x), static_cast<double>(at.y));
  if (!place) return;
  const double x = (place->x + 0.5) * grid.pixel_pitch_mm,
               y = (place->y + 0.5) * grid.pixel_pitch_mm;
  if (picks) {
    if (const auto pixel = pixel_at(studio, x, y)) pick_pixel(studio, *pixel);
    return;
  }
  // A stroke does not run across the seam between tiles: it ends there.
  if (!studio.stroke.empty()) {
    const double jump = std::hypot(x - studio.stroke.back()[0], y - studio.stroke.back()[1]);
    if (jump > 0.25 * grid.width * grid.pixel_pitch_mm) return finish_stroke(studio);
  }
  extend_stroke(studio, x, y);
}

void handle_view_mouse(Ui& ui, ImVec2 origin) {
  Studio& studio = ui.studio;
  const ImGuiIO& io = ImGui::GetIO();
  const ImVec2 at{io.MousePos.x - origin.x, io.MousePos.y - origin.y};
  const bool hovered = ImGui::IsItemHovered(), active = ImGui::IsItemActive();
  if (hovered && io.MouseWheel != 0) {
    zoom(studio.orbit, static_cast<double>(io.MouseWheel));
    touch_view(studio);
  }
  const bool draws = is_drawing_tool(studio.tool) && !io.KeyShift;
  if (hovered && ImGui::IsMouseClicked(0) && studio.tool == Tool::eyedropper)
    stroke_on_mesh(studio, at, true);
  if (active && draws && ImGui::IsMouseDown(0)) stroke_on_mesh(studio, at, false);
  if (ImGui::IsItemDeactivated() && draws) finish_stroke(studio);
  const bool moved = io.MouseDelta.x != 0 || io.MouseDelta.y != 0;
  if (!active || !moved) return;
  const auto dx = static_cast<double>(io.MouseDelta.x), dy = static_cast<double>(io.MouseDelta.y);
  if (ImGui::IsMouseDown(2)) {
    pan(studio.orbit, dx, dy, studio.view_height);
    touch_view(studio);
  } else if (ImGui::IsMouseDown(1) || studio.tool == Tool::light || io.KeyShift) {
    drag_light(studio, io.MouseDelta);
  } else if (studio.tool == Tool::orbit) {
    turn(studio.orbit, dx, dy, studio.view_height);
    touch_view(studio);
  }
}

// From the map's mm to the screen.
struct FlatFrame {
  ImVec2 origin;
  float per_mm = 1;
  ImVec2 to_screen(double x, double y) const {
    return {origin.x + static_cast<float>(x) * per_mm, origin.y + static_cast<float>(y) * per_mm};
  }
};

void draw_points(const Document& points, const FlatFrame& frame, ImU32 color, float width) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  std::vector<ImVec2> line;
  for (const Document& point : std::get<Document::Array>(points.value)) {
    const std::vector<double> at = as_numbers(point);
    if (at.size() == 2) line.push_back(frame.to_screen(at[0], at[1]));
  }
  if (line.size() == 1) list->AddCircleFilled(line.front(), std::max(2.0f, width / 2), color);
  list->AddPolyline(line.data(), static_cast<int>(line.size()), color, 0, std::max(2.0f, width));
}

// Strokes of the selected layer's selection.
void draw_strokes(const Studio& studio, const FlatFrame& frame) {
  const LayerSnapshot* layer = selected_layer(studio);
  if (layer == nullptr) return;
  const Document* selection = find(layer->source, "selection");
  if (selection == nullptr || !std::holds_alternative<Document::Object>(selection->value)) return;
  for (const char* key : {"strokes", "of"}) {
    const Document* strokes = find(*selection, key);
    if (strokes == nullptr || !std::holds_alternative<Document::Array>(strokes->value)) continue;
    for (const Document& stroke : std::get<Document::Array>(strokes->value)) {
      if (!std::holds_alternative<Document::Object>(stroke.value)) continue;
      const Document* points = find(stroke, "points");
      if (points == nullptr || find(stroke, "unit") != nullptr) continue;
      const Document* positive = find(stroke, "positive");
      const bool is_negative = positive != nullptr && !as_bool(*positive);
      draw_points(*points, frame, is_negative ? negative_color : positive_color, 2);
    }
  }
}

void draw_marks(const Studio& studio, const FlatFrame& frame) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const double pitch = studio.snapshot->after.pixel_pitch_mm;
  const ImVec2 at =
      frame.to_screen((studio.inspected.x + 0.5) * pitch, (studio.inspected.y + 0.5) * pitch);
  list->AddCircle(at, 5, frame_color, 12, 1.5f);
  if (studio.stamp_source) {
    const auto& box = *studio.stamp_source;
    list->AddRect(frame.to_screen(box[0], box[1]), frame.to_screen(box[2], box[3]), frame_color);
  }
  if (studio.stroke.empty()) return;
  if (studio.tool == Tool::stamp) {
    list->AddRect(frame.to_screen(studio.stroke.front()[0], studio.stroke.front()[1]),
                  frame.to_screen(studio.stroke.back()[0], studio.stroke.back()[1]),
                  positive_color);
    return;
  }
  std::vector<ImVec2> line;
  line.reserve(studio.stroke.size());
  for (const auto& point : studio.stroke) line.push_back(frame.to_screen(point[0], point[1]));
  list->AddPolyline(line.data(), static_cast<int>(line.size()),
                    studio.tool == Tool::scribble_minus ? negative_color : positive_color, 0,
                    std::max(2.0f, static_cast<float>(2 * studio.brush_radius_mm) * frame.per_mm));
}

void handle_flat_mouse(Ui& ui, const FlatFrame& frame) {
  Studio& studio = ui.studio;
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  const double x = static_cast<double>((mouse.x - frame.origin.x) / frame.per_mm),
               y = static_cast<double>((mouse.y - frame.origin.y) / frame.per_mm);
  const bool draws = is_drawing_tool(studio.tool);
  if (ImGui::IsItemActive() && draws) {
    extend_stroke(studio, x, y);
    return;
  }
  if (ImGui::IsItemDeactivated() && draws) return finish_stroke(studio);
  if (ImGui::IsItemActive())
    if (const auto pixel = pixel_at(studio, x, y)) pick_pixel(studio, *pixel);
}

}  // namespace

void draw_view(Ui& ui) {
  Studio& studio = ui.studio;
  ImGui::PushItemWidth(ImGui::GetFontSize() * 8);
  if (draw_choice(ui, "##mode", "view mode", view_mode_names(), studio.mode)) touch_view(studio);
  ImGui::SameLine();
  if (ImGui::Checkbox("selection", &studio.show_selection)) touch_view(studio);
  mark(ui.probe, "show selection");
  ImGui::SameLine();
  if (ImGui::Checkbox("refine", &studio.refine)) touch_view(studio);
  mark(ui.probe, "refine");
  ImGui::SameLine();
  auto exposure = static_cast<float>(studio.exposure);
  if (ImGui::SliderFloat("stops", &exposure, -5, 5, "%.1f")) {
    studio.exposure = static_cast<double>(exposure);
    touch_view(studio);
  }
  ImGui::PopItemWidth();
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const int width = std::max(32, static_cast<int>(room.x)),
            height = std::max(32, static_cast<int>(room.y));
  if (width != studio.view_width || height != studio.view_height) {
    studio.view_width = width;
    studio.view_height = height;
    touch_view(studio);
  }
  upload_view(ui);
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  const ImVec2 size{static_cast<float>(width), static_cast<float>(height)};
  if (ui.view.width() > 0)
    ImGui::GetWindowDrawList()->AddImage(ui.view.id(), origin,
                                         {origin.x + size.x, origin.y + size.y});
  ImGui::InvisibleButton("view", size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  mark(ui.probe, "view");
  handle_view_mouse(ui, origin);
}

void draw_flat_view(Ui& ui) {
  Studio& studio = ui.studio;
  if (studio.snapshot == nullptr) return ImGui::TextUnformatted("no map");
  ImGui::PushItemWidth(ImGui::GetFontSize() * 8);
  if (draw_choice(ui, "##flat mode", "flat mode", flat_mode_names(), studio.flat_mode))
    studio.flat_is_stale = true;
  ImGui::SameLine();
  const double pitch = studio.snapshot->after.pixel_pitch_mm;
  const double least = 0.25 * pitch, most = 0.25 * pitch * studio.snapshot->after.width;
  ImGui::SliderScalar("brush, mm", ImGuiDataType_Double, &studio.brush_radius_mm, &least, &most,
                      "%.2f", ImGuiSliderFlags_Logarithmic);
  ImGui::PopItemWidth();
  if (studio.flat_picture == nullptr) return;
  if (ui.flat_id != studio.flat_id) {
    ui.flat.upload(encode_picture(*studio.flat_picture, 0), studio.flat_picture->width,
                   studio.flat_picture->height, /*smooth=*/false);
    ui.flat_id = studio.flat_id;
  }
  const ImVec2 room = ImGui::GetContentRegionAvail(), corner = ImGui::GetCursorScreenPos();
  const auto columns = static_cast<float>(ui.flat.width()),
             rows = static_cast<float>(ui.flat.height());
  const float zoom_factor = std::max(0.1f, std::min(room.x / columns, room.y / rows));
  const FlatFrame frame{{corner.x + std::floor((room.x - columns * zoom_factor) / 2), corner.y},
                        zoom_factor / static_cast<float>(pitch)};
  const ImVec2 size{columns * zoom_factor, rows * zoom_factor};
  ImGui::SetCursorScreenPos(frame.origin);
  ImGui::GetWindowDrawList()->AddImage(ui.flat.id(), frame.origin,
                                       {frame.origin.x + size.x, frame.origin.y + size.y});
  ImGui::InvisibleButton("flat", size);
  mark(ui.probe, "flat");
  handle_flat_mouse(ui, frame);
  draw_strokes(studio, frame);
  draw_marks(studio, frame);
}

}  // namespace parian

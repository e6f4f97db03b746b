// The 3-D view, and what the mouse does in it.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/studio/mask_tool.h"
#include "app/studio/tools.h"
#include "app/studio/ui.h"
#include "scene/camera.h"

namespace parian {
namespace {

constexpr ImU32 positive_color = IM_COL32(255, 220, 60, 200);
constexpr ImU32 negative_color = IM_COL32(255, 60, 220, 200);
constexpr ImU32 faint_color = IM_COL32(255, 255, 255, 130);

void upload_view(Ui& ui) {
  Studio& studio = ui.studio;
  const bool has_refined =
      studio.refined != nullptr && studio.refined->id == studio.request_id && !studio.is_stale;
  const std::shared_ptr<const Picture>& shown = has_refined ? studio.refined : studio.picture;
  if (shown == nullptr || shown == ui.view_picture) return;
  ui.view.upload(shown->rgba, shown->width, shown->height, /*smooth=*/true);
  ui.view_picture = shown;
}

void drag_light(Studio& studio, ImVec2 delta, bool environment) {
  const double scale = 180.0 / std::max(1, studio.view_height);
  const std::size_t turned = find_light(studio.lighting, studio.selected_light, environment);
  if (turned == studio.lighting.size() || studio.stage == nullptr) return;
  turn_light(studio.lighting[turned], static_cast<double>(delta.x) * scale,
             -static_cast<double>(delta.y) * scale, center(studio.stage->box));
  touch_view(studio);
}

// On the mesh strokes run over the map under it.
void stroke_on_mesh(Ui& ui, ImVec2 at, ImVec2 origin, bool picks) {
  Studio& studio = ui.studio;
  if (studio.is_homogeneous || studio.snapshot == nullptr || studio.stage == nullptr) return;
  const std::array to{static_cast<double>(at.x), static_cast<double>(at.y)};
  if (picks) {
    const std::optional<std::array<double, 2>> place = mesh_to_map(studio, to[0], to[1]);
    if (!place) return;
    if (const auto pixel = pixel_at(studio.snapshot->after, (*place)[0], (*place)[1]))
      pick_pixel(studio, *pixel);
    return;
  }
  std::array from = to;
  if (!ui.view_stroke.empty())
    from = {static_cast<double>(ui.view_stroke.back()[0] - origin.x),
            static_cast<double>(ui.view_stroke.back()[1] - origin.y)};
  extend_mesh_stroke(studio, from, to);
  ui.view_stroke.push_back({origin.x + at.x, origin.y + at.y});
}

// Only what was pressed here paints.
void paint_on_mesh(Studio& studio, ImVec2 at) {
  const ImGuiIO& io = ImGui::GetIO();
  const std::array to{static_cast<double>(at.x), static_cast<double>(at.y)};
  const std::array from{static_cast<double>(at.x - io.MouseDelta.x),
                        static_cast<double>(at.y - io.MouseDelta.y)};
  if (ImGui::IsItemActivated() && ImGui::IsMouseClicked(0)) {
    begin_mask_stroke(studio, io.KeyCtrl);
    extend_mask_stroke(studio, to, to);
  } else if (ImGui::IsMouseDown(0)) {
    extend_mask_stroke(studio, from, to);
  }
}

void drag_camera(Studio& studio, const ImGuiIO& io) {
  const auto dx = static_cast<double>(io.MouseDelta.x), dy = static_cast<double>(io.MouseDelta.y);
  if (ImGui::IsMouseDown(2)) {
    pan(studio.orbit, dx, dy, studio.view_height);
    touch_view(studio);
  } else if (ImGui::IsMouseDown(1) || studio.tool == Tool::light) {
    drag_light(studio, io.MouseDelta, io.KeyCtrl);
  } else if (studio.tool == Tool::orbit) {
    turn(studio.orbit, dx, dy, studio.view_height);
    touch_view(studio);
  }
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
  const bool draws = draws_on_map(studio.tool);
  if (active && ImGui::IsMouseDown(0) && studio.tool == Tool::eyedropper)
    stroke_on_mesh(ui, at, origin, true);
  if (active && draws && ImGui::IsMouseDown(0)) stroke_on_mesh(ui, at, origin, false);
  if (active && studio.tool == Tool::mask) paint_on_mesh(studio, at);
  if (ImGui::IsItemDeactivated()) {
    if (draws) finish_stroke(studio);
    finish_mask_stroke(studio);
    ui.view_stroke.clear();
  }
  if (active && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0)) drag_camera(studio, io);
}

// As large as the brush is where it would touch the mesh.
void draw_mask_brush(const Studio& studio, ImVec2 origin) {
  if (!ImGui::IsItemHovered() || studio.stage == nullptr) return;
  const ImGuiIO& io = ImGui::GetIO();
  const Camera camera = make_view_camera(studio, 1);
  const std::optional<SurfacePoint> point =
      find_point(*studio.stage, camera, static_cast<double>(io.MousePos.x - origin.x),
                 static_cast<double>(io.MousePos.y - origin.y));
  const CameraFrame frame = make_camera_frame(camera);
  const auto depth =
      static_cast<double>(point ? dot(point->position - camera.position, frame.forward)
                                : length(camera.target - camera.position));
  const double per_mm = studio.view_height / (2 * frame.half_height * std::max(1e-6, depth));
  const bool erases = studio.mask.brush.erases != io.KeyCtrl;
  const ImU32 color = erases ? negative_color : positive_color;
  const auto radius = static_cast<float>(studio.mask.brush.radius_mm * per_mm);
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddCircle(io.MousePos, std::max(1.0f, radius), color, 32, 1.5f);
  const auto inner = static_cast<float>(1 - studio.mask.brush.softness) * radius;
  if (inner > 3) list->AddCircle(io.MousePos, inner, faint_color, 32, 1);
}

// The stroke that is being drawn, and how large the brush is where it would touch.
void draw_brush(const Ui& ui, ImVec2 origin) {
  const Studio& studio = ui.studio;
  if (studio.tool == Tool::mask) return draw_mask_brush(studio, origin);
  if (!draws_on_map(studio.tool) || studio.tool == Tool::stamp || studio.tool == Tool::select ||
      studio.is_homogeneous)
    return;
  const ImU32 color = studio.tool == Tool::scribble_minus ? negative_color : positive_color;
  const CameraFrame frame =
      make_camera_frame(make_camera(studio.orbit, studio.view_width, studio.view_height));
  const double per_mm =
      studio.view_height / (2 * frame.half_height * std::max(1e-6, studio.orbit.distance_mm));
  const auto radius = std::max(1.0f, static_cast<float>(studio.brush_radius_mm * per_mm));
  std::vector<ImVec2> line;
  line.reserve(ui.view_stroke.size());
  for (const auto& [x, y] : ui.view_stroke) line.emplace_back(x, y);
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddPolyline(line.data(), static_cast<int>(line.size()), color, 0, 2 * radius);
  if (ImGui::IsItemHovered()) list->AddCircle(ImGui::GetIO().MousePos, radius, color, 24, 1.5f);
}

// Where the lamps are, seen from the eye: balls lit from there, hollow where they come from behind;
// the one that dragging turns is large.
void draw_lamps(const Studio& studio, ImVec2 origin, ImVec2 size) {
  const CameraFrame frame = make_camera_frame(make_camera(studio.orbit, 64, 64));
  const float em = ImGui::GetFontSize(), radius = 1.3f * em;
  if (size.x < 6 * em || size.y < 6 * em || studio.stage == nullptr) return;
  const std::size_t turned = find_light(studio.lighting, studio.selected_light, false);
  const ImVec2 middle{origin.x + size.x - 2 * em, origin.y + size.y - 2 * em};
  ImDrawList* list = ImGui::GetWindowDrawList();
  bool has_lamps = false;
  for (std::size_t i = 0; i < studio.lighting.size(); ++i) {
    const StageLight& light = studio.lighting[i];
    if (!light.enabled || light.kind == LightKind::environment) continue;
    const Vec3 towards = direction_to(light, center(studio.stage->box));
    const float right = dot(towards, frame.right), up = dot(towards, frame.up);
    const ImVec2 spot{middle.x + right * radius, middle.y - up * radius};
    const ImU32 color = i == turned ? positive_color : faint_color;
    const float ball = (i == turned ? 0.34f : 0.22f) * em;
    if (!has_lamps) list->AddCircle(middle, radius, faint_color, 24, 1);
    has_lamps = true;
    list->AddLine(middle, spot, faint_color, 1);
    if (dot(towards, frame.forward) > 0)
      list->AddCircle(spot, ball, color, 12, 1.5f);
    else
      list->AddCircleFilled(spot, ball, color, 12);
  }
}

void draw_view_options(Ui& ui) {
  Studio& studio = ui.studio;
  const float em = ImGui::GetFontSize();
  ImGui::SetNextItemWidth(8 * em);
  if (draw_choice(ui, "view mode", view_mode_names(), studio.mode)) touch_view(studio);
  explain("what the view shows (V); difference: four times what the edits have changed");
  flow(ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x +
       ImGui::CalcTextSize("selection").x);
  if (ImGui::Checkbox("selection", &studio.show_selection)) touch_view(studio);
  mark(ui.probe, "show selection");
  explain("in red: the selected layer's selection; with the tool 'mask' the painted mask (M)");
  flow(5.5f * em);
  ImGui::SetNextItemWidth(5.5f * em);
  if (draw_choice(ui, "still", still_names(), studio.still)) touch_view(studio);
  explain("how good the picture becomes while nothing moves; exact: by the CPU renderer");
  flow(5.5f * em);
  const float room = std::max(4 * em, ImGui::GetContentRegionAvail().x);
  ImGui::SetNextItemWidth(room);
  auto exposure = static_cast<float>(studio.exposure);
  if (ImGui::DragFloat("##exposure", &exposure, 0.02f, -5, 5,
                       room > 11 * em ? "exposure %+.1f stops" : "%+.1f stops",
                       ImGuiSliderFlags_AlwaysClamp)) {
    studio.exposure = static_cast<double>(exposure);
    touch_view(studio);
  }
  mark(ui.probe, "exposure");
  explain("exposure: drag to the left and right (- and +)");
}

}  // namespace

void draw_view(Ui& ui) {
  Studio& studio = ui.studio;
  draw_view_options(ui);
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const int width = std::max(16, static_cast<int>(room.x)),
            height = std::max(16, static_cast<int>(room.y));
  if (width != studio.view_width || height != studio.view_height) {
    studio.view_width = width;
    studio.view_height = height;
    touch_view(studio);
  }
  upload_view(ui);
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  const ImVec2 size{static_cast<float>(width), static_cast<float>(height)};
  ImGui::InvisibleButton("view", size,
                         ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight |
                             ImGuiButtonFlags_MouseButtonMiddle);
  mark(ui.probe, "view");
  handle_view_mouse(ui, origin);
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->PushClipRect(origin, {origin.x + size.x, origin.y + size.y}, true);
  if (ui.view.width() > 0)
    list->AddImage(ui.view.id(), origin, {origin.x + size.x, origin.y + size.y});
  draw_brush(ui, origin);
  draw_lamps(studio, origin, size);
  list->PopClipRect();
}

}  // namespace parian

// The lights around the stage.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "app/studio/ui.h"

namespace parian {
namespace {

constexpr std::size_t most_lights = 64;  // of a scene description
// Of the strength sliders; off is a switch of its own.
constexpr double darkest = 1e-3, strongest = 10;

std::string name_of(const StageLight& light, std::size_t index) {
  std::string name =
      fmt::format("{} {}", light_kind_names()[static_cast<std::size_t>(light.kind)], index + 1);
  if (light.kind != LightKind::environment) return name;
  const std::string source = light.sky->sky.empty()
                                 ? std::filesystem::path(light.sky->file).filename().string()
                                 : light.sky->sky;
  return source.empty() ? name : fmt::format("{}: {}", name, source);
}

void draw_row(Ui& ui, std::size_t i) {
  Studio& studio = ui.studio;
  StageLight& light = studio.lighting[i];
  ImGui::PushID(static_cast<int>(i));
  if (ImGui::Checkbox("##on", &light.enabled)) touch_view(studio);
  mark(ui.probe, fmt::format("light/{}/on", i));
  explain("on or off");
  ImGui::SameLine();
  const float room = std::max(1.0f, ImGui::GetContentRegionAvail().x - ImGui::GetFrameHeight() - 6);
  ImGui::AlignTextToFramePadding();
  if (ImGui::Selectable(name_of(light, i).c_str(), studio.selected_light == i, 0, {room, 0}))
    studio.selected_light = i;
  mark(ui.probe, fmt::format("light/{}", i));
  ImGui::SameLine();
  const bool removes = ImGui::Button("×", {ImGui::GetFrameHeight(), 0});
  mark(ui.probe, fmt::format("light/{}/remove", i));
  explain("remove");
  ImGui::PopID();
  if (!removes) return;
  studio.lighting.erase(studio.lighting.begin() + static_cast<std::ptrdiff_t>(i));
  if (studio.selected_light > i) --studio.selected_light;
  touch_view(studio);
}

void add_light(Studio& studio, const StageLight& light) {
  studio.selected_light = studio.lighting.size();
  studio.lighting.push_back(light);
  touch_view(studio);
}

// A new lamp comes from the left of the camera, so that it is seen to be there.
StageLight make_lamp(const Studio& studio, LightKind kind) {
  const double distance = 1.5 * static_cast<double>(length(extent(studio.stage->box)));
  StageLight light{.kind = kind};
  set_angles(light, {studio.orbit.yaw_deg - 60, 30, distance}, center(studio.stage->box));
  const auto power = static_cast<float>(kind == LightKind::point ? distance * distance : 1);
  light.power = {power, power, power};
  return light;
}

void draw_add(Ui& ui) {
  Studio& studio = ui.studio;
  ImGui::BeginDisabled(studio.stage == nullptr || studio.lighting.size() >= most_lights);
  if (ImGui::Button("Add light", {ImGui::GetContentRegionAvail().x, 0}))
    ImGui::OpenPopup("add light");
  ImGui::EndDisabled();
  mark(ui.probe, "add light");
  if (!ImGui::BeginPopup("add light")) return;
  if (ImGui::MenuItem("lamp")) add_light(studio, make_lamp(studio, LightKind::directional));
  mark(ui.probe, "add light/lamp");
  explain("far away: from one direction");
  if (ImGui::MenuItem("point light")) add_light(studio, make_lamp(studio, LightKind::point));
  mark(ui.probe, "add light/point");
  for (const char* sky : {"studio", "clear"}) {
    if (ImGui::MenuItem(fmt::format("environment: {}", sky).c_str()))
      add_light(studio, make_sky_light(sky));
    mark(ui.probe, fmt::format("add light/{}", sky));
  }
  ImGui::EndPopup();
}

bool slide(Ui& ui, const char* label, double& value, double low, double high, const char* format,
           ImGuiSliderFlags flags = 0) {
  const bool changed =
      ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &low, &high, format, flags);
  mark(ui.probe, std::string("light/") + label);
  return changed;
}

// The power is a colour whose largest channel is 1, times the strength, times the unit that the
// strength is shown in.
bool draw_power(Ui& ui, StageLight& light, double unit) {
  const float most = std::max({light.power.x, light.power.y, light.power.z});
  float color[3] = {1, 1, 1};
  if (most > 0) {
    color[0] = light.power.x / most;
    color[1] = light.power.y / most;
    color[2] = light.power.z / most;
  }
  double strength = static_cast<double>(most) / unit;
  bool changed =
      slide(ui, "strength", strength, darkest, strongest, "%.3f", ImGuiSliderFlags_Logarithmic);
  explain(light.kind == LightKind::environment ? "factor of its image"
                                               : "irradiance at the middle of the object");
  if (ImGui::ColorEdit3("colour", color, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR)) {
    const float brightest = std::max({color[0], color[1], color[2], 1e-3f});
    for (float& channel : color) channel = std::max(0.0f, channel / brightest);
    changed = true;
  }
  mark(ui.probe, "light/colour");
  explain("linear Rec. 709; the brightest channel is 1");
  if (changed)
    light.power = Rgb{color[0], color[1], color[2]} * static_cast<float>(strength * unit);
  return changed;
}

bool draw_lamp(Ui& ui, StageLight& light) {
  const Stage& stage = *ui.studio.stage;
  const bool is_point = light.kind == LightKind::point;
  const Vec3 middle = center(stage.box);
  LightAngles angles = angles_of(light, middle);
  const double size = static_cast<double>(length(extent(stage.box)));
  bool changed = draw_power(ui, light, is_point ? std::pow(angles.distance_mm, 2) : 1);
  bool turned = slide(ui, "azimuth", angles.azimuth_deg, -180, 180, "%.0f°");
  turned |= slide(ui, "elevation", angles.elevation_deg, -89, 89, "%.0f°");
  if (is_point)
    turned |= slide(ui, "distance", angles.distance_mm, 0.05 * size, 20 * size, "%.1f mm",
                    ImGuiSliderFlags_Logarithmic);
  if (turned) set_angles(light, angles, middle);
  return changed || turned;
}

}  // namespace

void draw_light(Ui& ui) {
  Studio& studio = ui.studio;
  if (studio.stage == nullptr) return;
  draw_add(ui);
  for (std::size_t i = 0; i < studio.lighting.size(); ++i) draw_row(ui, i);
  if (studio.lighting.empty()) ImGui::TextWrapped("No light: the object is black.");
  if (studio.selected_light < studio.lighting.size()) {
    ImGui::Separator();
    StageLight& light = studio.lighting[studio.selected_light];
    bool changed = false;
    if (light.kind == LightKind::environment) {
      changed = draw_power(ui, light, 1);
      changed |= slide(ui, "rotation", light.rotation_deg, -180, 180, "%.0f°");
      ImGui::TextWrapped("Open or drop an EXR or HDR file for another environment.");
    } else {
      changed = draw_lamp(ui, light);
    }
    if (changed) touch_view(studio);
  }
  ImGui::Spacing();
  ImGui::TextWrapped(
      "The right mouse button turns the lamp that is chosen here, with Ctrl the environment.");
}

}  // namespace parian

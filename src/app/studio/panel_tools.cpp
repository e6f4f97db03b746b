// The tools, with pictures of them.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/studio/ui.h"
#include "image/color.h"
#include "material/properties.h"

namespace parian {
namespace {

constexpr const char* tool_help[] = {
    "Turn the object. Middle button: pan. Wheel: zoom. (1)",
    "Drag the lamp around the object; with Ctrl the environment. (2)",
    "Scribble on what shall change, here or on the mesh: all that looks like it is meant. (3)",
    "Scribble on what shall stay as it is. (4)",
    "Select by brush. (5)",
    "Pick a profile, of this map, of the mesh, or of the second material, and inspect it. (6)",
    "Paint with the picked profile. (7)",
    "Drag a rectangle around a pattern, then click where it goes. (8)",
    "Drag across what to select, or drag the handles. Other shapes: under Layers. (9)",
    "Paint on the mesh where the layer lies that is chosen under Surface; with Ctrl erase. (0)",
};

// Pictures in a square from (-1, -1) to (1, 1).
struct Icon {
  ImVec2 center;
  float size = 1;
  ImU32 color = 0;
  ImDrawList* list = nullptr;

  ImVec2 at(float x, float y) const { return {center.x + x * size, center.y + y * size}; }
  void line(ImVec2 a, ImVec2 b, float width = 0.16f) const {
    list->AddLine(at(a.x, a.y), at(b.x, b.y), color, width * size);
  }
  void ring(float radius, float width = 0.16f) const {
    list->AddCircle(center, radius * size, color, 24, width * size);
  }
  void curve(ImVec2 a, ImVec2 b, ImVec2 c, ImVec2 d, float width) const {
    list->AddBezierCubic(at(a.x, a.y), at(b.x, b.y), at(c.x, c.y), at(d.x, d.y), color,
                         width * size);
  }
};

void draw_orbit_icon(const Icon& icon) {
  icon.list->PathArcTo(icon.center, 0.8f * icon.size, -0.6f, 4.4f, 24);
  icon.list->PathStroke(icon.color, 0, 0.16f * icon.size);
  icon.list->AddTriangleFilled(icon.at(0.95f, -0.85f), icon.at(0.95f, -0.15f),
                               icon.at(0.3f, -0.45f), icon.color);
}

void draw_light_icon(const Icon& icon) {
  icon.list->AddCircleFilled(icon.center, 0.38f * icon.size, icon.color, 20);
  for (int i = 0; i < 8; ++i) {
    const float a = 0.785398f * static_cast<float>(i);
    icon.line({0.6f * std::cos(a), 0.6f * std::sin(a)}, {0.95f * std::cos(a), 0.95f * std::sin(a)});
  }
}

void draw_scribble_icon(const Icon& icon, bool plus) {
  icon.curve({-1, 0.4f}, {-0.5f, -1.1f}, {-0.2f, 1.6f}, {0.3f, 0.1f}, 0.18f);
  icon.line({0.35f, -0.5f}, {0.95f, -0.5f});
  if (plus) icon.line({0.65f, -0.8f}, {0.65f, -0.2f});
}

void draw_brush_icon(const Icon& icon) {
  icon.line({0.9f, -0.9f}, {0.05f, -0.05f}, 0.22f);
  icon.list->AddTriangleFilled(icon.at(0.15f, -0.2f), icon.at(0.3f, 0.05f), icon.at(-0.9f, 0.9f),
                               icon.color);
  icon.list->AddCircleFilled(icon.at(-0.2f, 0.25f), 0.36f * icon.size, icon.color, 16);
}

void draw_pick_icon(const Icon& icon) {
  icon.line({-0.85f, 0.85f}, {0.15f, -0.15f}, 0.2f);
  icon.line({-0.1f, -0.4f}, {0.4f, 0.1f}, 0.24f);
  icon.list->AddCircleFilled(icon.at(0.5f, -0.5f), 0.38f * icon.size, icon.color, 16);
}

void draw_paint_icon(const Icon& icon) {
  icon.list->AddCircleFilled(icon.at(0, 0.3f), 0.58f * icon.size, icon.color, 24);
  icon.list->AddTriangleFilled(icon.at(-0.5f, 0.05f), icon.at(0, -0.95f), icon.at(0.5f, 0.05f),
                               icon.color);
}

void draw_stamp_icon(const Icon& icon) {
  icon.list->AddRect(icon.at(-0.85f, -0.85f), icon.at(0.85f, 0.85f), icon.color, 0, 0,
                     0.14f * icon.size);
  for (const auto& [x, y] : {std::array{-0.6f, -0.6f}, std::array{0.0f, 0.0f}})
    icon.list->AddRectFilled(icon.at(x, y), icon.at(x + 0.6f, y + 0.6f), icon.color);
}

void draw_select_icon(const Icon& icon) {
  constexpr std::array dashes{-0.85f, -0.2f, 0.45f};
  for (const float from : dashes)
    for (const float side : {-0.85f, 0.85f}) {
      icon.line({from, side}, {from + 0.4f, side});
      icon.line({side, from}, {side, from + 0.4f});
    }
}

// A ball half painted.
void draw_mask_icon(const Icon& icon) {
  icon.ring(0.8f, 0.14f);
  icon.list->PathArcTo(icon.center, 0.8f * icon.size, 0.785398f, 3.926991f, 20);
  icon.list->PathFillConvex(icon.color);
}

void draw_icon(Tool tool, const Icon& icon) {
  switch (tool) {
    case Tool::orbit:
      return draw_orbit_icon(icon);
    case Tool::light:
      return draw_light_icon(icon);
    case Tool::scribble_plus:
    case Tool::scribble_minus:
      return draw_scribble_icon(icon, tool == Tool::scribble_plus);
    case Tool::brush:
      return draw_brush_icon(icon);
    case Tool::eyedropper:
      return draw_pick_icon(icon);
    case Tool::paint:
      return draw_paint_icon(icon);
    case Tool::stamp:
      return draw_stamp_icon(icon);
    case Tool::select:
      return draw_select_icon(icon);
    case Tool::mask:
      return draw_mask_icon(icon);
  }
}

bool draw_tool(Tool tool, const char* name, bool is_selected, float height) {
  const float width = ImGui::GetContentRegionAvail().x;
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const ImVec4 warm = ImGui::GetStyleColorVec4(ImGuiCol_CheckMark);
  if (is_selected) {
    ImGui::PushStyleColor(ImGuiCol_Button, warm);
    ImGui::PushStyleColor(ImGuiCol_ButtonHovered, warm);
  }
  const bool pressed = ImGui::Button((std::string("##") + name).c_str(), {width, height});
  if (is_selected) ImGui::PopStyleColor(2);
  const ImU32 ink = is_selected ? IM_COL32(25, 22, 16, 255) : ImGui::GetColorU32(ImGuiCol_Text);
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float em = ImGui::GetFontSize(), text_height = 0.86f * em;
  // In low buttons the picture stands beside the name.
  if (height < 2.4f * em) {
    draw_icon(tool, {{corner.x + 0.6f * em, corner.y + height / 2}, 0.38f * em, ink, list});
    list->AddText(ImGui::GetFont(), 0.85f * text_height,
                  {corner.x + 1.15f * em, corner.y + (height - 0.9f * text_height) / 2}, ink, name);
    return pressed;
  }
  const float icon = 0.28f * (height - text_height);
  draw_icon(tool,
            {{corner.x + width / 2, corner.y + 0.52f * (height - text_height)}, icon, ink, list});
  const float text_width = 0.86f * ImGui::CalcTextSize(name).x;
  list->AddText(ImGui::GetFont(), text_height,
                {corner.x + std::max(1.0f, (width - text_width) / 2),
                 corner.y + height - 1.25f * text_height},
                ink, name);
  return pressed;
}

// The albedo of the picked profile as a colour.
void draw_picked(Ui& ui) {
  if (!ui.studio.picked) return;
  const std::vector<Profile>& profiles = ui.studio.picked->profiles;
  ImVec4 color{0, 0, 0, 1};
  for (std::size_t c = 0; c < 3; ++c) {
    const double albedo = measure_properties(profiles[std::min(c, profiles.size() - 1)]).albedo;
    (&color.x)[c] = encode_srgb(static_cast<float>(std::clamp(albedo, 0.0, 1.0)));
  }
  ImGui::Spacing();
  ImGui::TextDisabled("picked");
  ImGui::ColorButton("##picked", color, ImGuiColorEditFlags_NoTooltip,
                     {ImGui::GetContentRegionAvail().x, 1.6f * ImGui::GetFontSize()});
  explain(ui.studio.picked->map.empty() ? "the picked profile, of this map: its albedo"
                                        : ui.studio.picked->map.c_str());
}

}  // namespace

void draw_toolbar(Ui& ui) {
  const std::vector<std::string>& names = tool_names();
  const float room = ImGui::GetContentRegionAvail().y - 5 * ImGui::GetFontSize();
  const float spacing = ImGui::GetStyle().ItemSpacing.y;
  const float height = std::clamp(room / static_cast<float>(names.size()) - spacing,
                                  1.6f * ImGui::GetFontSize(), 3.5f * ImGui::GetFontSize());
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_selected = static_cast<std::size_t>(ui.studio.tool) == i;
    if (draw_tool(static_cast<Tool>(i), names[i].c_str(), is_selected, height))
      choose_tool(ui.studio, static_cast<Tool>(i));
    mark(ui.probe, "tool/" + names[i]);
    explain(tool_help[i]);
  }
  draw_picked(ui);
}

}  // namespace parian

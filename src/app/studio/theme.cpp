#include "app/studio/theme.h"

#include <imgui.h>

#include <array>
#include <filesystem>
#include <utility>

namespace parian {
namespace {

constexpr float font_pixels = 14;

ImVec4 grey(float value, float alpha = 1) {
  return {value, value * 1.01f, value * 1.06f, alpha};
}

// Neutral, so that nothing beside a picture tints it; one warm colour for what is chosen.
void set_colors() {
  ImGui::StyleColorsDark();
  const ImVec4 warm{0.84f, 0.67f, 0.38f, 1}, warm_dim{0.50f, 0.41f, 0.26f, 1};
  const std::array<std::pair<ImGuiCol_, ImVec4>, 33> colors{{
      {ImGuiCol_Text, grey(0.86f)},
      {ImGuiCol_TextDisabled, grey(0.52f)},
      {ImGuiCol_WindowBg, grey(0.125f)},
      {ImGuiCol_PopupBg, grey(0.15f, 0.98f)},
      {ImGuiCol_MenuBarBg, grey(0.16f)},
      {ImGuiCol_Border, grey(0.26f)},
      {ImGuiCol_FrameBg, grey(0.20f)},
      {ImGuiCol_FrameBgHovered, grey(0.25f)},
      {ImGuiCol_FrameBgActive, grey(0.28f)},
      {ImGuiCol_TitleBg, grey(0.16f)},
      {ImGuiCol_TitleBgActive, grey(0.20f)},
      {ImGuiCol_Button, grey(0.23f)},
      {ImGuiCol_ButtonHovered, grey(0.30f)},
      {ImGuiCol_ButtonActive, warm_dim},
      {ImGuiCol_Header, grey(0.27f)},
      {ImGuiCol_HeaderHovered, grey(0.30f)},
      {ImGuiCol_HeaderActive, warm_dim},
      {ImGuiCol_Separator, grey(0.24f)},
      {ImGuiCol_SeparatorHovered, warm_dim},
      {ImGuiCol_SeparatorActive, warm},
      {ImGuiCol_CheckMark, warm},
      {ImGuiCol_SliderGrab, warm_dim},
      {ImGuiCol_SliderGrabActive, ImVec4(0.62f, 0.51f, 0.31f, 1)},
      {ImGuiCol_Tab, grey(0.16f)},
      {ImGuiCol_TabHovered, grey(0.32f)},
      {ImGuiCol_TabActive, grey(0.27f)},
      {ImGuiCol_TabUnfocused, grey(0.16f)},
      {ImGuiCol_TabUnfocusedActive, grey(0.27f)},
      {ImGuiCol_PlotHistogram, warm_dim},
      {ImGuiCol_ScrollbarBg, grey(0.125f)},
      {ImGuiCol_ScrollbarGrab, grey(0.30f)},
      {ImGuiCol_NavHighlight, warm},
      {ImGuiCol_ModalWindowDimBg, ImVec4(0, 0, 0, 0.5f)},
  }};
  for (const auto& [place, color] : colors) ImGui::GetStyle().Colors[place] = color;
}

}  // namespace

void set_theme(float scale) {
  set_colors();
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.PopupRounding = 3;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.TabRounding = 3;
  style.ScrollbarSize = 11;
  style.GrabMinSize = 8;
  style.WindowBorderSize = 0;
  style.PopupBorderSize = 1;
  style.WindowMinSize = {1, 1};
  style.WindowPadding = {7, 6};
  style.ItemSpacing = {7, 5};
  style.ItemInnerSpacing = {6, 4};
  style.ScaleAllSizes(scale);
  // Sharp at any size where there is such a font; the built-in one otherwise.
  const char* font = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
  // Latin, Greek, Cyrillic, dashes and arrows: names of files have them.
  static const ImWchar ranges[] = {0x20, 0x17F, 0x370, 0x4FF, 0x2010, 0x2026, 0x2190, 0x2193, 0};
  std::error_code ignored;
  ImGuiIO& io = ImGui::GetIO();
  if (std::filesystem::exists(font, ignored))
    io.Fonts->AddFontFromFileTTF(font, font_pixels * scale, nullptr, ranges);
  else
    io.FontGlobalScale = scale;
}

}  // namespace parian

// The inspected pixel's profile: measured pairs, before and after the edits; and the shape curve,
// whose points are dragged.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "app/studio/tools.h"
#include "app/studio/ui.h"
#include "material/dipole.h"
#include "material/properties.h"

namespace parian {
namespace {

constexpr int curve_steps = 160;
constexpr double decades = 5, ln_10 = 2.302585092994046;
constexpr ImU32 before_color = IM_COL32(150, 150, 155, 255),
                picked_color = IM_COL32(90, 200, 255, 255),
                data_color = IM_COL32(200, 200, 205, 110);
constexpr ImU32 channel_colors[] = {IM_COL32(255, 110, 90, 255), IM_COL32(110, 230, 110, 255),
                                    IM_COL32(120, 150, 255, 255)};

struct Axes {
  ImVec2 low, high;           // corners on the screen
  double max_r = 1, top = 0;  // mm; ln of the largest value
  ImVec2 place(double r, double log_value) const {
    const double x = r / max_r, y = (top - log_value) / (decades * ln_10);
    return {low.x + static_cast<float>(x) * (high.x - low.x),
            low.y + static_cast<float>(y) * (high.y - low.y)};
  }
};

template <typename Function>
void draw_function(const Axes& axes, const Function& log_value, ImU32 color, float width) {
  std::vector<ImVec2> line;
  line.reserve(curve_steps + 1);
  for (int i = 0; i <= curve_steps; ++i) {
    const double r = axes.max_r * i / curve_steps, value = log_value(r);
    if (!std::isfinite(value)) break;
    line.push_back(axes.place(r, value));
  }
  ImGui::GetWindowDrawList()->AddPolyline(line.data(), static_cast<int>(line.size()), color, 0,
                                          width);
}

void draw_curve(const Axes& axes, const Profile& profile, ImU32 color, float width) {
  draw_function(
      axes, [&](double r) { return eval_log_profile(profile, r); }, color, width);
}

void draw_grid(const Axes& axes) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const ImU32 color = IM_COL32(62, 63, 66, 255), ink = IM_COL32(150, 150, 155, 255);
  const float em = ImGui::GetFontSize();
  list->AddRect(axes.low, axes.high, color);
  for (int d = 1; d < static_cast<int>(decades); ++d) {
    const ImVec2 at = axes.place(0, axes.top - d * ln_10);
    list->AddLine(at, {axes.high.x, at.y}, color);
  }
  const bool is_narrow = axes.high.x - axes.low.x < 20 * em;  // room for every other number
  for (int i = is_narrow ? 2 : 1; i <= 4; i += is_narrow ? 2 : 1) {
    const double r = axes.max_r * i / 4;
    const ImVec2 at = axes.place(r, axes.top);
    const std::string label = fmt::format("{:.1f}{}", r, i == 4 ? " mm" : "");
    const float width = ImGui::CalcTextSize(label.c_str()).x;
    if (i < 4) list->AddLine(at, {at.x, axes.high.y}, color);
    list->AddText({std::min(at.x - width / 2, axes.high.x - width - 3), axes.high.y - 1.2f * em},
                  ink, label.c_str());
  }
  list->AddText({axes.low.x + 4, axes.low.y + 2}, ink,
                fmt::format("{:.0e} / mm²", std::exp(axes.top)).c_str());
  list->AddText({axes.low.x + 4, axes.high.y - 1.2f * em}, ink,
                fmt::format("{:.0e}", std::exp(axes.top - decades * ln_10)).c_str());
}

// What the lines are, in the upper right corner.
void draw_legend(const Axes& axes, bool has_before, bool has_data, bool has_picked, ImU32 edited) {
  struct Line {
    const char* text;
    ImU32 color;
    bool is_shown;
  };
  const Line lines[] = {{"edited", edited, true},
                        {"before", before_color, has_before},
                        {"picked", picked_color, has_picked},
                        {"measured", data_color | IM_COL32(0, 0, 0, 255), has_data}};
  const float em = ImGui::GetFontSize();
  float y = axes.low.y + 0.3f * em;
  ImDrawList* list = ImGui::GetWindowDrawList();
  for (const Line& line : lines) {
    if (!line.is_shown) continue;
    const float x = axes.high.x - ImGui::CalcTextSize(line.text).x - 0.5f * em;
    list->AddLine({x - 1.6f * em, y + em / 2}, {x - 0.5f * em, y + em / 2}, line.color, 2);
    list->AddText({x, y}, IM_COL32(185, 185, 190, 255), line.text);
    y += 1.15f * em;
  }
}

// Factors of the selected shape layer at u = 0, 1/4, ..., 1; 1 without one.
double shape_factor(const Studio& studio, std::size_t point) {
  const LayerSnapshot* layer = selected_layer(studio);
  if (layer == nullptr || layer->kind != "shape") return 1;
  const Document* scale = find(layer->source, "scale");
  if (scale == nullptr) return 1;
  for (const Document& pair : as_array(*scale)) {
    const std::vector<double> values = as_numbers(pair);
    if (values.size() == 2 && std::abs(values[0] - 0.25 * static_cast<double>(point)) < 1e-9)
      return values[1];
  }
  return 1;
}

// Points on the edited curve, dragged up and down: a factor 10 for a fifth of the plot.
void draw_handles(Ui& ui, const Axes& axes, const Profile& profile) {
  Studio& studio = ui.studio;
  const double range = profile_range(profile);
  for (std::size_t i = 0; i <= 4; ++i) {
    const double u = 0.25 * static_cast<double>(i), r = u * range;
    const double value = eval_log_profile(profile, std::min(r, 0.999 * profile.support_mm));
    if (!std::isfinite(value) || r > axes.max_r) continue;
    const ImVec2 at = axes.place(r, value);
    const float radius = 0.3f * ImGui::GetFontSize();
    ImGui::SetCursorScreenPos({at.x - 1.5f * radius, at.y - 1.5f * radius});
    ImGui::PushID(static_cast<int>(i));
    ImGui::InvisibleButton("handle", {3 * radius, 3 * radius});
    mark(ui.probe, fmt::format("shape handle {}", i));
    const bool active = ImGui::IsItemActive(), hovered = ImGui::IsItemHovered();
    if (ImGui::IsItemActivated()) ui.shape_drag = std::log(shape_factor(studio, i));
    if (active && ui.shape_drag && ImGui::IsMouseDragging(0, 1)) {
      const double step = static_cast<double>(ImGui::GetMouseDragDelta(0, 1).y) /
                          static_cast<double>(axes.high.y - axes.low.y) * decades * ln_10;
      set_shape_point(studio, u, std::clamp(std::exp(*ui.shape_drag - step), 1e-3, 1e3));
    }
    if (ImGui::IsItemDeactivated()) {
      ui.shape_drag.reset();
      ++studio.drags;
    }
    ImGui::GetWindowDrawList()->AddCircleFilled(at, hovered || active ? 1.4f * radius : radius,
                                                IM_COL32(255, 220, 60, 255));
    ImGui::PopID();
  }
}

// Channels, the inspected pixel, and its figures.
void draw_heading(Ui& ui, const EditState& state) {
  Studio& studio = ui.studio;
  static constexpr const char* channels[] = {"red", "green", "blue"};
  for (int c = 0; c < std::min(3, state.channels); ++c) {
    if (c > 0)
      flow(ImGui::GetFrameHeight() + ImGui::GetStyle().ItemInnerSpacing.x +
           ImGui::CalcTextSize(channels[c]).x);
    ImGui::RadioButton(channels[c], &studio.channel, c);
    mark(ui.probe, std::string("channel/") + channels[c]);
  }
  studio.channel = std::clamp(studio.channel, 0, state.channels - 1);
  const std::string place = fmt::format("({}, {})", studio.inspected.x, studio.inspected.y);
  const float width = ImGui::CalcTextSize(place.c_str()).x;
  const float right = ImGui::GetWindowPos().x + ImGui::GetContentRegionMax().x;
  if (ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x + width <= right) {
    ImGui::SameLine(ImGui::GetContentRegionMax().x - width);
    ImGui::TextDisabled("%s", place.c_str());
    explain("the inspected pixel: click on another one of the map with the tool 'orbit' or 'pick'");
  }
  const ProfileProperties properties = measure_properties(
      get_profile(state, studio.channel, studio.inspected.x, studio.inspected.y));
  ImGui::TextDisabled("albedo %.3f", properties.albedo);
  for (const std::string& text : {fmt::format("range {:.2f}", properties.range_mm),
                                  fmt::format("mean {:.2f} mm", properties.mean_radius_mm)}) {
    flow(ImGui::CalcTextSize(text.c_str()).x);
    ImGui::TextDisabled("%s", text.c_str());
  }
}

void draw_curves(const Studio& studio, const Axes& axes, const Profile& edited) {
  const EditState &before = studio.snapshot->before, &after = studio.snapshot->after;
  const auto channel = static_cast<std::size_t>(studio.channel);
  // Of a new grid the pixel is another one.
  const bool is_same_grid = before.width == after.width && before.height == after.height;
  const bool has_data = is_same_grid && !studio.measured.empty();
  if (is_same_grid)
    draw_curve(axes, get_profile(before, studio.channel, studio.inspected.x, studio.inspected.y),
               before_color, 1.5f);
  const bool has_picked = studio.picked && channel < studio.picked->profiles.size();
  if (has_picked) draw_curve(axes, studio.picked->profiles[channel], picked_color, 1.5f);
  for (const MeasuredPair& pair : studio.measured)
    if (has_data && pair.value > 0)
      ImGui::GetWindowDrawList()->AddCircleFilled(axes.place(pair.r_mm, std::log(pair.value)), 1.5f,
                                                  data_color);
  const ImU32 color = channel_colors[std::min(channel, std::size_t{2})];
  draw_curve(axes, edited, color, 2.5f);
  draw_legend(axes, is_same_grid, has_data, has_picked, color);
}

// R_d of the channels of a homogeneous material.
void draw_homogeneous(const Studio& studio) {
  ImGui::TextDisabled("diffuse reflectance R_d(r) of the three channels");
  const ImVec2 corner = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  if (room.x < 20 || room.y < 20) return;
  const Dipole& material = studio.homogeneous;
  Axes axes{{corner.x, corner.y}, {corner.x + room.x, corner.y + room.y}};
  const auto log_R_d = [&](std::size_t c, double r) {
    const double value = eval_dipole(material.channels[c], material.eta, r);
    return std::log(std::max(value, 1e-300));
  };
  axes.top = -1e9;
  for (std::size_t c = 0; c < 3; ++c) {
    // To where the slowest channel has fallen by the height of the plot.
    axes.top = std::max(axes.top, log_R_d(c, 0) + 0.5);
    const double sigma_a = material.channels[c].sigma_a;
    const double sigma_t_prime = sigma_a + material.channels[c].sigma_s_prime;
    axes.max_r = std::max(axes.max_r, 6 / std::sqrt(3 * sigma_a * sigma_t_prime + 0.05));
  }
  ImGui::PushClipRect(axes.low, axes.high, true);
  draw_grid(axes);
  for (std::size_t c = 0; c < 3; ++c)
    draw_function(
        axes, [&](double r) { return log_R_d(c, r); }, channel_colors[c], 2);
  ImGui::PopClipRect();
}

}  // namespace

void draw_profile(Ui& ui) {
  Studio& studio = ui.studio;
  if (studio.is_homogeneous) return draw_homogeneous(studio);
  if (studio.snapshot == nullptr) return;
  const EditState& after = studio.snapshot->after;
  draw_heading(ui, after);
  const Profile edited = get_profile(after, studio.channel, studio.inspected.x, studio.inspected.y);
  const ImVec2 corner = ImGui::GetCursorScreenPos(), room = ImGui::GetContentRegionAvail();
  if (room.x < 20 || room.y < 20) return;
  Axes axes{{corner.x, corner.y}, {corner.x + room.x, corner.y + room.y}};
  axes.max_r = std::max(1e-6, 1.05 * std::min(edited.support_mm, 1.5 * profile_range(edited)));
  axes.top = eval_log_profile(edited, 0) + 0.5;
  ImGui::PushClipRect(axes.low, axes.high, true);
  draw_grid(axes);
  draw_curves(studio, axes, edited);
  draw_handles(ui, axes, edited);
  ImGui::PopClipRect();
}

}  // namespace parian

// Compression: a plot of bytes against error, from which a blend is chosen.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "app/studio/figures.h"
#include "app/studio/ui.h"

namespace parian {
namespace {

constexpr std::array<ImU32, 5> colors{IM_COL32(150, 150, 155, 255), IM_COL32(225, 180, 95, 255),
                                      IM_COL32(110, 190, 225, 255), IM_COL32(150, 215, 120, 255),
                                      IM_COL32(225, 125, 190, 255)};
constexpr ImU32 grid_color = IM_COL32(66, 67, 70, 255), ink = IM_COL32(160, 160, 165, 255);

ImU32 color_of(int per_pixel) {
  return colors[static_cast<std::size_t>(std::clamp(per_pixel, 1, 5) - 1)];
}

// Bytes by their logarithm to the right, errors upwards from 0.
struct RateAxes {
  ImVec2 low, high;
  double least = 1, most = 10, top = 1;
  ImVec2 place(const CompressedPoint& point) const {
    const double x = std::log(static_cast<double>(point.bytes) / least) / std::log(most / least);
    const double y = 1 - point.relative_error / top;
    return {low.x + static_cast<float>(x) * (high.x - low.x),
            low.y + static_cast<float>(y) * (high.y - low.y)};
  }
};

RateAxes make_axes(const std::vector<CompressedPoint>& points, ImVec2 low, ImVec2 high) {
  RateAxes axes{low, high, 1e12, 1, 1e-6};
  for (const CompressedPoint& point : points) {
    axes.least = std::min(axes.least, static_cast<double>(point.bytes));
    axes.most = std::max(axes.most, static_cast<double>(point.bytes));
    axes.top = std::max(axes.top, point.relative_error);
  }
  axes.least /= 1.15;
  axes.most *= 1.15;
  axes.top *= 1.15;
  return axes;
}

void draw_axes(const RateAxes& axes) {
  ImDrawList* list = ImGui::GetWindowDrawList();
  const float em = ImGui::GetFontSize();
  list->AddRect(axes.low, axes.high, grid_color);
  for (int i = 0; i <= 2; ++i) {
    const float part = 0.5f * static_cast<float>(i);
    const float x = axes.low.x + part * (axes.high.x - axes.low.x);
    const std::string bytes = bytes_text(static_cast<std::size_t>(
        axes.least * std::pow(axes.most / axes.least, static_cast<double>(part))));
    const float width = ImGui::CalcTextSize(bytes.c_str()).x;
    if (i == 1) list->AddLine({x, axes.low.y}, {x, axes.high.y}, grid_color);
    list->AddText({std::clamp(x - width / 2, axes.low.x, axes.high.x - width), axes.high.y + 2},
                  ink, bytes.c_str());
    const float y = axes.high.y - part * (axes.high.y - axes.low.y);
    if (i == 1) list->AddLine({axes.low.x, y}, {axes.high.x, y}, grid_color);
    const std::string error = fmt::format("{:.1f} %", 100 * axes.top * static_cast<double>(part));
    list->AddText({axes.low.x - ImGui::CalcTextSize(error.c_str()).x - 4,
                   std::clamp(y - em / 2, axes.low.y, axes.high.y - em)},
                  ink, error.c_str());
  }
}

std::string describe_point(const CompressedPoint& point) {
  return fmt::format("{} bases, {} per pixel: {}, error {:.2f} %, albedo {:.2f} %", point.bases,
                     point.per_pixel, bytes_text(point.bytes), 100 * point.relative_error,
                     100 * point.albedo_error);
}

// A point is chosen by a click on it.
void draw_points(Ui& ui, const RateAxes& axes) {
  Studio& studio = ui.studio;
  ImDrawList* list = ImGui::GetWindowDrawList();
  const std::vector<CompressedPoint>& points = studio.compressed;
  const float radius = 0.32f * ImGui::GetFontSize();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ImVec2 at = axes.place(points[i]);
    const ImU32 color = color_of(points[i].per_pixel);
    if (i > 0 && points[i - 1].per_pixel == points[i].per_pixel)
      list->AddLine(axes.place(points[i - 1]), at, color, 1.5f);
    list->AddCircleFilled(at, radius, color, 16);
    if (studio.shown_compressed == i)
      list->AddCircle(at, 1.8f * radius, IM_COL32(255, 255, 255, 230), 20, 1.5f);
    ImGui::SetCursorScreenPos({at.x - 2 * radius, at.y - 2 * radius});
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::InvisibleButton("point", {4 * radius, 4 * radius})) show_compressed(studio, i);
    ImGui::PopID();
    mark(ui.probe, fmt::format("rate/{}", i));
    explain(describe_point(points[i]).c_str());
  }
}

void draw_rate_plot(Ui& ui) {
  const float em = ImGui::GetFontSize();
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  if (width < 8 * em) return;
  const RateAxes axes =
      make_axes(ui.studio.compressed, {corner.x + 3.6f * em, corner.y + 0.3f * em},
                {corner.x + width - 0.3f * em, corner.y + 11 * em});
  draw_axes(axes);
  draw_points(ui, axes);
  ImGui::SetCursorScreenPos({corner.x, axes.high.y + 1.5f * em});
  ImGui::TextDisabled("error of the profiles over bytes of the file");
}

void draw_list(Ui& ui) {
  Studio& studio = ui.studio;
  const auto choice = [&](std::optional<std::size_t> index, const std::string& text) {
    if (ImGui::RadioButton(text.c_str(), studio.shown_compressed == index))
      show_compressed(studio, index);
    mark(ui.probe, index ? fmt::format("compressed/{}", *index) : "compressed/none");
  };
  choice(std::nullopt, "the map: " + bytes_text(map_bytes(*studio.snapshot->map)));
  for (std::size_t i = 0; i < studio.compressed.size(); ++i) {
    const CompressedPoint& point = studio.compressed[i];
    choice(i, fmt::format("{} × {}: {}, {:.1f} %", point.bases, point.per_pixel,
                          bytes_text(point.bytes), 100 * point.relative_error));
    explain(describe_point(point).c_str());
  }
}

}  // namespace

void draw_compression(Ui& ui) {
  Studio& studio = ui.studio;
  if (studio.snapshot == nullptr || studio.is_homogeneous)
    return ImGui::TextDisabled("There is no map to compress.");
  ImGui::SliderInt("bases, at most", &studio.compression.bases, 8, 256);
  explain("base materials that all pixels share; an eighth, a quarter and a half are tried too");
  ImGui::SliderInt("per pixel", &studio.compression.per_pixel, 1, 5);
  mark(ui.probe, "per pixel");
  explain("base materials that each pixel mixes; runs with another number are added to the plot");
  const bool runs = studio.jobs.is_running("compress");
  if (ImGui::Button(runs ? "Stop" : "Compress", {ImGui::GetContentRegionAvail().x, 0})) {
    if (runs)
      studio.jobs.cancel("compress");
    else
      compress_map(studio);
  }
  mark(ui.probe, "compress");
  ImGui::Spacing();
  if (studio.compressed.size() > 1) draw_rate_plot(ui);
  draw_list(ui);
  ImGui::Spacing();
  ImGui::BeginDisabled(!studio.shown_compressed);
  if (ImGui::Button("Export blend…", {ImGui::GetContentRegionAvail().x, 0}))
    start_dialog(ui, FileDialog::Action::save_blend, "material.kbm");
  mark(ui.probe, "save blend");
  ImGui::EndDisabled();
}

}  // namespace parian

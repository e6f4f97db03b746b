// Strokes that are spread over like-looking pixels: of scribbles, and of layers `interpolate`,
// where each has parameters of its own.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/studio/tools.h"
#include "app/studio/ui.h"
#include "edit/adjust.h"

namespace parian {
namespace {

struct StrokeNumbers {
  double radius = 0;
  bool positive = true;
};
ParamList describe(StrokeNumbers& numbers) {
  return {{.name = "radius",
           .help = "of the stroke; 0: the pixels that it crosses",
           .target = &numbers.radius,
           .min = 0,
           .max = 1e6,
           .unit = "mm"},
          {.name = "positive",
           .help = "off: what looks like this stays as it is",
           .target = &numbers.positive}};
}

bool is_positive(const Document& stroke) {
  const Document* positive = find(stroke, "positive");
  return positive == nullptr || as_bool(*positive);
}

// The rows; the index of a stroke that was removed.
std::optional<std::size_t> draw_rows(Ui& ui, const Document::Array& strokes) {
  std::optional<std::size_t> removed;
  const float frame = ImGui::GetFrameHeight();
  for (std::size_t i = 0; i < strokes.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    const float room = std::max(1.0f, ImGui::GetContentRegionAvail().x - frame - 8);
    const std::string label =
        fmt::format("stroke {} ({})", i + 1, is_positive(strokes[i]) ? "+" : "−");
    ImGui::AlignTextToFramePadding();
    if (ImGui::Selectable(label.c_str(), ui.studio.selected_stroke == i, 0, {room, 0}))
      ui.studio.selected_stroke = i;
    mark(ui.probe, fmt::format("stroke/{}", i));
    ImGui::SameLine();
    ImGui::BeginDisabled(strokes.size() == 1);
    if (ImGui::Button("×", {frame, 0})) removed = i;
    mark(ui.probe, fmt::format("stroke/{}/remove", i));
    ImGui::EndDisabled();
    ImGui::PopID();
  }
  return removed;
}

}  // namespace

bool draw_stroke_list(Ui& ui, Document& holder, bool with_adjust, bool& ended) {
  Studio& studio = ui.studio;
  Document::Array strokes = as_array(get(holder, "strokes"));
  if (strokes.empty()) return false;
  constexpr std::size_t most_rows = 5;
  studio.selected_stroke = std::min(studio.selected_stroke, strokes.size() - 1);
  ImGui::PushID("strokes");
  if (strokes.size() > most_rows)
    ImGui::BeginChild("rows", {0, most_rows * ImGui::GetFrameHeightWithSpacing()}, true);
  const std::optional<std::size_t> removed = draw_rows(ui, strokes);
  if (strokes.size() > most_rows) ImGui::EndChild();
  bool changed = removed.has_value();
  if (removed) {
    strokes.erase(strokes.begin() + static_cast<std::ptrdiff_t>(*removed));
    ui.edited_key = "removed stroke";
    ended = true;
  } else {
    Document& stroke = strokes[studio.selected_stroke];
    StrokeNumbers numbers;
    changed = draw_params(ui, describe(numbers), stroke, ended);
    Adjust adjust;
    if (with_adjust && is_positive(stroke))
      changed |= draw_params(ui, describe(adjust), stroke, ended);
  }
  ImGui::PopID();
  if (changed) set(holder, "strokes", std::move(strokes));
  return changed;
}

}  // namespace parian

// What can be undone and redone.
#include <fmt/format.h>
#include <imgui.h>

#include "app/studio/ui.h"

namespace parian {

void draw_history(Ui& ui) {
  Studio& studio = ui.studio;
  const HistoryView view = view_history(studio);
  std::optional<std::size_t> target;
  if (ImGui::Selectable("as opened", view.position == 0)) target = 0;
  mark(ui.probe, "history/0");
  for (std::size_t i = 0; i < view.rows.size(); ++i) {
    const bool is_undone = i >= view.position;
    if (is_undone)
      ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
    if (ImGui::Selectable(fmt::format("{}##{}", view.rows[i].label, i).c_str(),
                          i + 1 == view.position))
      target = i + 1;
    if (is_undone) ImGui::PopStyleColor();
    const bool is_present = i + 1 == view.position;
    if (is_present && ui.history_seen != std::pair(view.position, view.rows.size()))
      ImGui::SetScrollHereY();
    mark(ui.probe, fmt::format("history/{}", i + 1));
  }
  ui.history_seen = {view.position, view.rows.size()};
  if (target) jump_to(studio, *target);
}

}  // namespace parian

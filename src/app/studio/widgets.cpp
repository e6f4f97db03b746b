// Small things that several panels use.
#include <imgui.h>

#include "app/studio/ui.h"

namespace parian {

void mark(Probe& probe, const std::string& name) {
  if (probe.path.empty()) return;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  probe.widgets[name] = {low.x, low.y, high.x, high.y};
}

bool draw_names(Ui& ui, const std::string& group, const std::vector<std::string>& names,
                std::size_t& value) {
  const bool open = ImGui::BeginCombo(("##" + group).c_str(), names.at(value).c_str(),
                                      ImGuiComboFlags_HeightLarge);
  mark(ui.probe, group);
  if (!open) return false;
  bool changed = false;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (ImGui::Selectable(names[i].c_str(), i == value)) {
      value = i;
      changed = true;
    }
    mark(ui.probe, group + "/" + names[i]);
  }
  ImGui::EndCombo();
  return changed;
}

void flow(float width) {
  const float spacing = ImGui::GetStyle().ItemSpacing.x;
  const float end = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  if (ImGui::GetItemRectMax().x + spacing + width <= end) ImGui::SameLine();
}

void explain(const char* text) {
  if (!ImGui::IsItemHovered()) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 24);
  ImGui::TextUnformatted(text);
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

}  // namespace parian

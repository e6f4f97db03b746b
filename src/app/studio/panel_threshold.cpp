// A part of a selection by a property of the map: which one, and within which bounds.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <string>

#include "app/studio/tools.h"
#include "app/studio/ui.h"
#include "edit/selection_property.h"

namespace parian {
namespace {

// Least and largest of what a threshold compares.
const std::array<double, 2>& property_bounds(Ui& ui, std::size_t property, int channel) {
  const EditorSnapshot& snapshot = *ui.studio.snapshot;
  const std::array<std::uint64_t, 4> key{snapshot.original, snapshot.version, property,
                                         static_cast<std::uint64_t>(channel + 1)};
  if (ui.bounds_of == key) return ui.bounds;
  const Plane values =
      eval_selection_property(snapshot.after, static_cast<SelectionProperty>(property), channel);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  ui.bounds = {*low, std::max(*high, *low + 1e-6)};
  ui.bounds_of = key;
  return ui.bounds;
}

// One bound, which may be left out as long as the other one stands.
bool draw_bound(Ui& ui, Document& part, const char* key, const char* other,
                const std::array<double, 2>& range, bool& ended) {
  const Document* node = find(part, key);
  bool is_on = node != nullptr;
  double value = is_on ? as_number(*node) : key == std::string("low") ? range[0] : range[1];
  const std::string box = std::string("##with ") + key;
  ImGui::BeginDisabled(find(part, other) == nullptr);
  bool changed = ImGui::Checkbox(box.c_str(), &is_on);
  ImGui::EndDisabled();
  mark(ui.probe, std::string("with ") + key);
  ended |= changed;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(
      std::max(1.0f, ImGui::CalcItemWidth() - ImGui::GetFrameHeightWithSpacing()));
  ImGui::BeginDisabled(!is_on);
  changed |= ImGui::SliderScalar(key, ImGuiDataType_Double, &value, &range[0], &range[1], "%.4g");
  ended |= ImGui::IsItemDeactivatedAfterEdit();
  ImGui::EndDisabled();
  mark(ui.probe, std::string("param/") + key);
  if (!changed) return false;
  ui.edited_key = key;
  if (is_on) {
    set(part, key, value);
    // The other one gives way.
    const Document* rest = find(part, other);
    const bool crosses = rest != nullptr &&
                         (key == std::string("low")) == (as_number(*rest) < value) &&
                         as_number(*rest) != value;
    if (crosses) set(part, other, value);
  } else {
    remove_key(part, key);
  }
  return true;
}

bool draw_bounds(Ui& ui, Document& part, bool& ended) {
  if (part_type(part) != "threshold") return false;
  const std::vector<std::string>& names = selection_property_names();
  const auto property = static_cast<std::size_t>(
      std::find(names.begin(), names.end(), as_string(get(part, "property"))) - names.begin());
  const Document* node = find(part, "channel");
  const int channel = node != nullptr ? static_cast<int>(as_number(*node)) : -1;
  bool changed = false;
  if (property < 3 && ui.studio.snapshot->after.channels == 3) {
    auto index = static_cast<std::size_t>(channel + 1);
    if (draw_names(ui, "channel", {"mean of r, g, b", "r", "g", "b"}, index)) {
      remove_key(part, "channel");
      if (index > 0) set(part, "channel", static_cast<double>(index - 1));
      ui.edited_key = "channel";
      changed = ended = true;
    }
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    ImGui::TextUnformatted("channel");
  }
  const std::array<double, 2>& range = property_bounds(ui, property, channel);
  changed |= draw_bound(ui, part, "low", "high", range, ended);
  changed |= draw_bound(ui, part, "high", "low", range, ended);
  return changed;
}

// A property of another size needs other bounds.
void reset_bounds(Ui& ui, Document& part) {
  const std::vector<std::string>& names = selection_property_names();
  const auto property = static_cast<std::size_t>(
      std::find(names.begin(), names.end(), as_string(get(part, "property"))) - names.begin());
  if (property >= 3) remove_key(part, "channel");
  const std::array<double, 2> range = property_bounds(ui, property, property >= 3 ? -1 : 0);
  set(part, "low", 0.5 * (range[0] + range[1]));
  remove_key(part, "high");
}

}  // namespace

bool draw_threshold(Ui& ui, const ParamList& params, Document& part, bool& ended) {
  const auto pick = [&](const std::vector<std::string>& names) {
    ParamList picked;
    for (const Param& param : params)
      if (std::find(names.begin(), names.end(), param.name) != names.end()) picked.push_back(param);
    return picked;
  };
  bool changed = draw_params(ui, pick({"property"}), part, ended);
  if (changed) reset_bounds(ui, part);
  changed |= draw_bounds(ui, part, ended);
  changed |= draw_params(ui, pick({"softness", "state"}), part, ended);
  return changed;
}

}  // namespace parian

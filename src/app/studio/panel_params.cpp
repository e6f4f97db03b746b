// Sliders from descriptions of parameters, as the command line makes flags of them.
#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>

#include "app/studio/ui.h"

namespace parian {
namespace {

bool draw_number(const char* label, double& value, const Param& param) {
  const bool is_bounded = std::isfinite(param.min) && std::isfinite(param.max);
  if (is_bounded && param.max - param.min <= 1.0001)
    return ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &param.min, &param.max, "%.3f");
  // Wide ranges: relative steps, and Ctrl with a click to type.
  const auto speed = static_cast<float>(0.01 * std::max(std::abs(value), 0.1));
  const double low = param.above_min ? std::nextafter(param.min, param.max) : param.min;
  return ImGui::DragScalar(label, ImGuiDataType_Double, &value, speed, &low, &param.max, "%.4g",
                           ImGuiSliderFlags_AlwaysClamp);
}

bool draw_numbers(Ui& ui, const char* label, std::vector<double>& values, const Param& param) {
  static constexpr const char* channels[] = {"r", "g", "b"};
  bool changed = false;
  bool each = values.size() > 1;
  ImGui::PushID(label);
  if (!each) {
    double one = values.empty() ? 1 : values.front();
    const float spacing = ImGui::GetStyle().ItemInnerSpacing.x;
    const float button = ImGui::CalcTextSize("rgb").x + 2 * ImGui::GetStyle().FramePadding.x;
    ImGui::SetNextItemWidth(std::max(1.0f, ImGui::CalcItemWidth() - button - spacing));
    changed = draw_number("##one", one, param);
    if (changed) values = {one};
    mark(ui.probe, fmt::format("param/{}", label));
    ImGui::SameLine(0, spacing);
    if (ImGui::Button("rgb", {button, 0})) {
      values = {one, one, one};
      changed = true;
    }
    ImGui::SameLine(0, spacing);
    ImGui::TextUnformatted(label);
    ImGui::PopID();
    return changed;
  }
  ImGui::TextUnformatted(label);
  for (std::size_t c = 0; c < values.size(); ++c)
    changed |= draw_number(c < 3 ? channels[c] : "?", values[c], param);
  ImGui::PopID();
  return changed;
}

bool draw_choice_param(Ui& ui, const char* text, const ChoiceTarget& choice) {
  const int index = choice.get();
  bool changed = false;
  if (!ImGui::BeginCombo(text, choice.names[static_cast<std::size_t>(index)].c_str())) return false;
  for (int i = 0; i < static_cast<int>(choice.names.size()); ++i) {
    const std::string& name = choice.names[static_cast<std::size_t>(i)];
    if (ImGui::Selectable(name.c_str(), i == index)) {
      choice.set(i);
      changed = true;
    }
    mark(ui.probe, fmt::format("param/{}/{}", text, name));
  }
  ImGui::EndCombo();
  return changed;
}

bool draw_param(Ui& ui, const std::string& label, const Param& param) {
  const char* text = label.c_str();
  if (auto* const* flag = std::get_if<bool*>(&param.target)) return ImGui::Checkbox(text, *flag);
  if (auto* const* whole = std::get_if<int*>(&param.target))
    return ImGui::DragInt(text, *whole, 0.2f, static_cast<int>(std::max(param.min, -1e9)),
                          static_cast<int>(std::min(param.max, 1e9)), "%d",
                          ImGuiSliderFlags_AlwaysClamp);
  if (auto* const* seed = std::get_if<std::uint64_t*>(&param.target))
    return ImGui::DragScalar(text, ImGuiDataType_U64, *seed, 0.2f);
  if (auto* const* number = std::get_if<double*>(&param.target))
    return draw_number(text, **number, param);
  if (auto* const* words = std::get_if<std::string*>(&param.target))
    return ImGui::InputText(text, *words);
  if (auto* const* numbers = std::get_if<std::vector<double>*>(&param.target))
    return draw_numbers(ui, text, **numbers, param);
  return draw_choice_param(ui, text, std::get<ChoiceTarget>(param.target));
}

// What the document says of one parameter; what cannot be read keeps its default.
void take_over(const Document& document, const Param& param) {
  const Document* node = find(document, json_key(param));
  if (node == nullptr) return;
  if (auto* const* numbers = std::get_if<std::vector<double>*>(&param.target);
      numbers != nullptr && std::holds_alternative<double>(node->value)) {
    **numbers = {std::get<double>(node->value)};
    return;
  }
  Document one{Document::Object{}};
  set(one, json_key(param), *node);
  read_params(one, {param});
}

void take_value(Document& document, const Param& param, const std::string& key) {
  Document value = get(write_params({param}), key);
  // One number for all channels is written as such.
  if (auto* array = std::get_if<Document::Array>(&value.value);
      array != nullptr && array->size() == 1)
    value = Document(array->front());
  set(document, key, std::move(value));
}

}  // namespace

bool draw_params(Ui& ui, const ParamList& params, Document& document, bool& ended) {
  bool changed = false;
  for (const Param& param : params) {
    take_over(document, param);
    const std::string key = json_key(param);
    // As one item, so that it is known when any part of it is let go.
    ImGui::BeginGroup();
    const bool is_changed = draw_param(ui, key, param);
    ImGui::EndGroup();
    if (is_changed) {
      take_value(document, param, key);
      ui.edited_key = key;
    }
    changed |= is_changed;
    ended |= ImGui::IsItemDeactivatedAfterEdit() ||
             (is_changed && std::holds_alternative<ChoiceTarget>(param.target));
    if (!std::holds_alternative<std::vector<double>*>(param.target)) mark(ui.probe, "param/" + key);
    explain((param.help + (param.unit.empty() ? "" : ", " + param.unit)).c_str());
  }
  return changed;
}

bool draw_folded_params(Ui& ui, const ParamList& params, Document& document, bool& ended) {
  constexpr std::size_t most = 4;
  if (params.size() <= 2 * most) return draw_params(ui, params, document, ended);
  const ParamList first(params.begin(), params.begin() + most),
      rest(params.begin() + most, params.end());
  bool changed = draw_params(ui, first, document, ended);
  const bool open = ImGui::TreeNode("how strokes spread");
  mark(ui.probe, "more params");
  if (!open) return changed;
  changed |= draw_params(ui, rest, document, ended);
  ImGui::TreePop();
  return changed;
}

}  // namespace parian

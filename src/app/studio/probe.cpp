#include "app/studio/probe.h"

#include <imgui.h>

#include "base/error.h"
#include "io/json/files.h"
#include "io/json/json.h"

namespace parian {
namespace {

constexpr double interval_s = 0.05;

double mean_of(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value);
  return values.empty() ? 1 : sum / static_cast<double>(values.size());
}

Document describe_layers(const EditorSnapshot& snapshot) {
  Document::Array layers;
  for (const LayerSnapshot& layer : snapshot.layers) {
    Document row{Document::Object{}};
    set(row, "source", layer.source);
    if (layer.mask != nullptr) set(row, "selected", mean_of(layer.mask->weight));
    layers.push_back(std::move(row));
  }
  return layers;
}

// Mean of the picture's codes: enough to see that something changed.
double brightness_of(const Picture& picture) {
  double sum = 0;
  for (std::size_t i = 0; i < picture.rgba.size(); ++i)
    if (i % 4 != 3) sum += static_cast<double>(picture.rgba[i]);
  return picture.rgba.empty() ? 0 : sum / (0.75 * static_cast<double>(picture.rgba.size()));
}

Document describe_state(const Probe& probe, const Studio& studio) {
  Document state{Document::Object{}}, widgets{Document::Object{}};
  for (const auto& [name, box] : probe.widgets)
    set(widgets, name,
        Document::Array{static_cast<double>(box.x0), static_cast<double>(box.y0),
                        static_cast<double>(box.x1), static_cast<double>(box.y1)});
  set(state, "settled", is_settled(studio));
  set(state, "tool", tool_names()[static_cast<std::size_t>(studio.tool)]);
  set(state, "mode", view_mode_names()[static_cast<std::size_t>(studio.mode)]);
  set(state, "flat_mode", flat_mode_names()[static_cast<std::size_t>(studio.flat_mode)]);
  set(state, "material", studio.material_path);
  set(state, "mesh", studio.mesh_path);
  set(state, "homogeneous", studio.is_homogeneous);
  set(state, "yaw_deg", studio.orbit.yaw_deg);
  set(state, "azimuth_deg", studio.lighting.azimuth_deg);
  set(state, "distance_mm", studio.orbit.distance_mm);
  if (studio.snapshot != nullptr) {
    Document::Array history, future;
    for (const std::string& label : studio.snapshot->history) history.emplace_back(label);
    for (const std::string& label : studio.snapshot->future) future.emplace_back(label);
    set(state, "layers", describe_layers(*studio.snapshot));
    set(state, "history", std::move(history));
    set(state, "future", std::move(future));
    set(state, "edit_ms", 1e3 * studio.snapshot->seconds);
  }
  set(state, "edit_shown_ms", studio.edit_shown_ms);
  if (studio.picture != nullptr) {
    set(state, "picture", static_cast<double>(studio.picture->id));
    set(state, "picture_ms", 1e3 * studio.picture->seconds);
    const SplatReport& stages = studio.picture->report;
    set(state, "stages_ms",
        Document::Array{1e3 * stages.sampling_s, 1e3 * stages.irradiance_s, 1e3 * stages.material_s,
                        1e3 * stages.group_s, 1e3 * stages.view_s, 1e3 * stages.splat_s,
                        1e3 * stages.resolve_s, 1e3 * stages.shade_s, 1e3 * stages.read_s});
    set(state, "brightness", brightness_of(*studio.picture));
  }
  if (studio.refined != nullptr) set(state, "refined", static_cast<double>(studio.refined->id));
  set(state, "compressed", studio.compressed.size());
  set(state, "picked", studio.picked.has_value());
  set(state, "recoverable", studio.recoverable.has_value());
  Document::Array messages;
  for (const Message& message : studio.messages) messages.emplace_back(message.text);
  set(state, "messages", std::move(messages));
  set(state, "widgets", std::move(widgets));
  return state;
}

}  // namespace

void mark(Probe& probe, const std::string& name) {
  if (probe.path.empty()) return;
  const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
  probe.widgets[name] = {low.x, low.y, high.x, high.y};
}

void write_probe(Probe& probe, const Studio& studio) {
  if (probe.path.empty() || studio.now_s - probe.last_s < interval_s) return;
  std::string text = format_document(describe_state(probe, studio));
  if (text == probe.last) return;
  probe.last_s = studio.now_s;
  write_text(probe.path, text);
  probe.last = std::move(text);
}

}  // namespace parian

// Homogeneous materials and the light.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "app/studio/ui.h"

namespace parian {
namespace {

// A slider for a channel, tinted by it.
bool draw_channels(Ui& ui, const char* label, std::array<double, 3>& values, double low,
                   double high, const char* format, bool is_logarithmic) {
  static constexpr const char* channels[] = {"r", "g", "b"};
  static constexpr ImU32 colors[] = {IM_COL32(225, 110, 95, 255), IM_COL32(110, 200, 110, 255),
                                     IM_COL32(115, 150, 235, 255)};
  bool changed = false;
  ImGui::TextDisabled("%s", label);
  ImGui::PushID(label);
  for (std::size_t c = 0; c < 3; ++c) {
    ImGui::PushStyleColor(ImGuiCol_SliderGrab, colors[c]);
    ImGui::SetNextItemWidth(
        std::max(40.0f, ImGui::GetContentRegionAvail().x - 1.5f * ImGui::GetFontSize()));
    changed |= ImGui::SliderScalar(channels[c], ImGuiDataType_Double, &values[c], &low, &high,
                                   format, is_logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    ImGui::PopStyleColor();
    mark(ui.probe, fmt::format("{}/{}", label, channels[c]));
  }
  ImGui::PopID();
  return changed;
}

bool draw_named(Ui& ui, HomogeneousControls& controls) {
  bool changed = false;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const bool open = ImGui::BeginCombo("##measured", "take over a measured material");
  mark(ui.probe, "measured");
  if (!open) return false;
  for (const NamedMaterial& named : named_materials()) {
    if (ImGui::Selectable(named.name.c_str())) {
      for (std::size_t c = 0; c < 3; ++c) {
        controls.sigma_a[c] = named.channels[c].sigma_a;
        controls.sigma_s_prime[c] = named.channels[c].sigma_s_prime;
        controls.g[c] = named.channels[c].g;
      }
      controls.eta = named.eta;
      changed = true;
    }
    mark(ui.probe, "measured/" + named.name);
    explain(named.source.c_str());
  }
  ImGui::EndCombo();
  return changed;
}

void draw_map_facts(const Studio& studio) {
  ImGui::TextWrapped("%s", std::filesystem::path(studio.material_path).filename().c_str());
  explain(studio.material_path.c_str());
  if (studio.snapshot == nullptr) return;
  const EditState& state = studio.snapshot->after;
  ImGui::TextWrapped("%d × %d pixels of %.3g mm, %d channels", state.width, state.height,
                     state.pixel_pitch_mm, state.channels);
  ImGui::Text("%zu knots to %.2f mm", state.knots_mm.size(), state.knots_mm.back());
  if (studio.second == nullptr) return;
  ImGui::Spacing();
  ImGui::TextDisabled("second material");
  ImGui::TextWrapped("%s", std::filesystem::path(studio.second->path).filename().c_str());
}

// What the precomputed transport is doing, and whether it may.
void draw_transport(Ui& ui) {
  Studio& studio = ui.studio;
  ImGui::Separator();
  ImGui::Checkbox("precomputed transport", &studio.use_transport);
  mark(ui.probe, "use transport");
  explain(
      "computed once for this mesh and light, in the background; each edit is then one pass over "
      "the vertices, with single scattering");
  if (!studio.use_transport) return ImGui::TextDisabled("edits are splatted");
  if (studio.picture != nullptr && studio.picture->is_live && !studio.is_stale) {
    const LiveReport& live = studio.picture->live;
    ImGui::TextDisabled("%zu vertices, an update takes %.1f ms", live.vertices,
                        1e3 * (live.project_s + live.update_s));
  } else {
    ImGui::TextDisabled(studio.jobs.is_running("transport") ? "is being computed"
                                                            : "waits until nothing moves");
  }
}

}  // namespace

void draw_material(Ui& ui) {
  Studio& studio = ui.studio;
  bool homogeneous = studio.is_homogeneous;
  if (ImGui::Checkbox("homogeneous", &homogeneous)) {
    if (homogeneous)
      set_homogeneous(studio, studio.homogeneous);
    else
      leave_homogeneous(studio);
  }
  mark(ui.probe, "homogeneous");
  explain("one material all over, by its coefficients, in place of the map");
  if (!studio.is_homogeneous) return draw_map_facts(studio);
  HomogeneousControls controls = studio.homogeneous;
  bool changed = draw_named(ui, controls);
  changed |= draw_channels(ui, "absorption, 1/mm", controls.sigma_a, 1e-4, 10, "%.4f", true);
  changed |=
      draw_channels(ui, "reduced scattering, 1/mm", controls.sigma_s_prime, 0.05, 20, "%.3f", true);
  changed |= ImGui::Checkbox("single scattering", &controls.single_scattering);
  mark(ui.probe, "single scattering");
  explain("light that scatters once: sharper and glossier; with precomputed transport and refined");
  if (controls.single_scattering)
    changed |= draw_channels(ui, "mean cosine g", controls.g, -0.9, 0.95, "%.2f", false);
  const double low = 1, high = 2;
  ImGui::TextDisabled("refractive index");
  ImGui::SetNextItemWidth(
      std::max(40.0f, ImGui::GetContentRegionAvail().x - 1.5f * ImGui::GetFontSize()));
  changed |= ImGui::SliderScalar("##eta", ImGuiDataType_Double, &controls.eta, &low, &high, "%.3f");
  if (changed) set_homogeneous(studio, controls);
  draw_transport(ui);
}

void draw_light(Ui& ui) {
  Studio& studio = ui.studio;
  Lighting lighting = studio.lighting;
  const auto slider = [&](const char* label, double& value, double low, double high,
                          const char* format) {
    ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &low, &high, format);
    mark(ui.probe, std::string("light/") + label);
  };
  ImGui::TextDisabled("lamp (right mouse button)");
  slider("strength", lighting.lamp, 0, 10, "%.2f");
  slider("azimuth", lighting.azimuth_deg, -180, 180, "%.0f°");
  slider("elevation", lighting.elevation_deg, -89, 89, "%.0f°");
  ImGui::Spacing();
  ImGui::TextDisabled("environment (Ctrl and right mouse button)");
  slider("factor", lighting.environment, 0, 4, "%.2f");
  slider("rotation", lighting.rotation_deg, -180, 180, "%.0f°");
  ImGui::Spacing();
  ImGui::TextWrapped("Open or drop an EXR or HDR file for another environment.");
  if (lighting == studio.lighting) return;
  studio.lighting = lighting;
  touch_view(studio);
}

}  // namespace parian

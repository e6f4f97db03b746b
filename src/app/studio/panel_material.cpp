// Homogeneous materials.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>

#include "app/studio/ui.h"

namespace parian {
namespace {

// A slider for a channel, tinted by it.
bool draw_channels(Ui& ui, const char* label, Dipole& material, double DipoleCoefficients::*value,
                   double low, double high, const char* format, bool is_logarithmic) {
  static constexpr const char* channels[] = {"r", "g", "b"};
  static constexpr ImU32 colors[] = {IM_COL32(225, 110, 95, 255), IM_COL32(110, 200, 110, 255),
                                     IM_COL32(115, 150, 235, 255)};
  bool changed = false;
  ImGui::TextDisabled("%s", label);
  ImGui::PushID(label);
  for (std::size_t c = 0; c < material.channels.size(); ++c) {
    ImGui::PushStyleColor(ImGuiCol_SliderGrab, colors[c]);
    ImGui::SetNextItemWidth(
        std::max(40.0f, ImGui::GetContentRegionAvail().x - 1.5f * ImGui::GetFontSize()));
    changed |=
        ImGui::SliderScalar(channels[c], ImGuiDataType_Double, &(material.channels[c].*value), &low,
                            &high, format, is_logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    ImGui::PopStyleColor();
    mark(ui.probe, fmt::format("{}/{}", label, channels[c]));
  }
  ImGui::PopID();
  return changed;
}

bool draw_named(Ui& ui, Dipole& material) {
  bool changed = false;
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x);
  const bool open = ImGui::BeginCombo("##measured", "take over a measured material");
  mark(ui.probe, "measured");
  if (!open) return false;
  for (const NamedMaterial& named : named_materials()) {
    if (ImGui::Selectable(named.name.c_str())) {
      material.channels.assign(named.channels.begin(), named.channels.end());
      material.eta = named.eta;
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

// Slabs have none.
bool draw_single_scattering(Ui& ui, Dipole& material) {
  if (material.thickness_mm > 0) return false;
  bool changed = ImGui::Checkbox("single scattering", &material.single_scattering);
  mark(ui.probe, "single scattering");
  explain("light that scatters once: sharper and glossier; with precomputed transport and refined");
  if (material.single_scattering)
    changed |= draw_channels(ui, "mean cosine g", material, &DipoleCoefficients::g, -0.9, 0.95,
                             "%.2f", false);
  return changed;
}

// What a scene has given it and no slider shows.
void draw_kept(const Dipole& material) {
  static constexpr const char* models[] = {"classic", "better", "normalized"};
  if (material.model != DiffusionModel::classic)
    ImGui::TextDisabled("%s diffusion", models[static_cast<std::size_t>(material.model)]);
  if (material.thickness_mm > 0)
    ImGui::TextDisabled("%zu slabs, the first of %.3g mm", material.below.size() + 1,
                        material.thickness_mm);
  if (!material.reflectance_gain.empty() || !material.attenuation_gain.empty())
    ImGui::TextDisabled("with curves edited by hand");
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
  if (!shown_layers(studio).empty())
    return ImGui::TextWrapped("Not under the layers of the surface: edits are splatted.");
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
  Dipole material = studio.homogeneous;
  bool changed = draw_named(ui, material);
  changed |= draw_channels(ui, "absorption, 1/mm", material, &DipoleCoefficients::sigma_a, 1e-4, 10,
                           "%.4f", true);
  changed |= draw_channels(ui, "reduced scattering, 1/mm", material,
                           &DipoleCoefficients::sigma_s_prime, 0.05, 20, "%.3f", true);
  changed |= draw_single_scattering(ui, material);
  const double low = 1, high = 2;
  ImGui::TextDisabled("refractive index");
  ImGui::SetNextItemWidth(
      std::max(40.0f, ImGui::GetContentRegionAvail().x - 1.5f * ImGui::GetFontSize()));
  changed |= ImGui::SliderScalar("##eta", ImGuiDataType_Double, &material.eta, &low, &high, "%.3f");
  draw_kept(material);
  if (changed) set_homogeneous(studio, material);
  draw_transport(ui);
}

}  // namespace parian

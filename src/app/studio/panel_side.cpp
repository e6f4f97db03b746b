// Homogeneous materials, light, compression, statistics.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <filesystem>

#include "app/studio/ui.h"
#include "base/memory.h"

namespace parian {
namespace {

bool draw_coefficients(Ui& ui, const char* label, std::array<double, 3>& values, double low,
                       double high) {
  static constexpr const char* channels[] = {"red", "green", "blue"};
  bool changed = false;
  ImGui::TextUnformatted(label);
  ImGui::PushID(label);
  for (std::size_t c = 0; c < 3; ++c) {
    changed |= ImGui::SliderScalar(channels[c], ImGuiDataType_Double, &values[c], &low, &high,
                                   "%.4f", ImGuiSliderFlags_Logarithmic);
    mark(ui.probe, fmt::format("{}/{}", label, channels[c]));
  }
  ImGui::PopID();
  return changed;
}

std::size_t map_bytes(const ProfileMap& map) {
  return sizeof(float) * (map.log_profile.size() + map.gain.size() + map.dilation.size());
}

void draw_stages(const SplatReport& stages) {
  const auto row = [](const char* name, double seconds) {
    ImGui::Text("%-24s %7.1f ms", name, 1e3 * seconds);
  };
  row("material", stages.material_s);
  row("light", stages.irradiance_s);
  row("groups of samples", stages.group_s);
  row("view", stages.view_s);
  row("splats", stages.splat_s);
  row("resolve", stages.resolve_s);
  row("shade", stages.shade_s);
  row("read back", stages.read_s);
  ImGui::Text("%zu samples, %d levels, %zu emitters", stages.samples, stages.levels, stages.splats);
  ImGui::Text("%.1f MB of textures", static_cast<double>(stages.texture_bytes) / 1e6);
  ImGui::TextWrapped("%s", stages.device.c_str());
  for (const std::string& warning : stages.warnings) ImGui::TextWrapped("%s", warning.c_str());
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
  if (!studio.is_homogeneous) {
    ImGui::TextWrapped("%s", std::filesystem::path(studio.material_path).filename().c_str());
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", studio.material_path.c_str());
    if (studio.snapshot == nullptr) return;
    const EditState& state = studio.snapshot->after;
    ImGui::Text("%d x %d pixels of %.3g mm, %d channels", state.width, state.height,
                state.pixel_pitch_mm, state.channels);
    ImGui::Text("%zu knots to %.2f mm", state.knots_mm.size(), state.knots_mm.back());
    return;
  }
  HomogeneousControls controls = studio.homogeneous;
  bool changed = false;
  const bool open = ImGui::BeginCombo("measured", "choose");
  mark(ui.probe, "measured");
  if (open) {
    for (const NamedMaterial& named : named_materials()) {
      if (ImGui::Selectable(named.name.c_str())) {
        for (std::size_t c = 0; c < 3; ++c) {
          controls.sigma_a[c] = named.channels[c].sigma_a;
          controls.sigma_s_prime[c] = named.channels[c].sigma_s_prime;
        }
        controls.eta = named.eta;
        changed = true;
      }
      mark(ui.probe, "measured/" + named.name);
      if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", named.source.c_str());
    }
    ImGui::EndCombo();
  }
  changed |= draw_coefficients(ui, "absorption, 1/mm", controls.sigma_a, 1e-4, 10);
  changed |= draw_coefficients(ui, "reduced scattering, 1/mm", controls.sigma_s_prime, 0.05, 20);
  const double low = 1, high = 2;
  changed |= ImGui::SliderScalar("refractive index", ImGuiDataType_Double, &controls.eta, &low,
                                 &high, "%.3f");
  if (changed) set_homogeneous(studio, controls);
}

void draw_light(Ui& ui) {
  Studio& studio = ui.studio;
  Lighting lighting = studio.lighting;
  const auto slider = [&](const char* label, double& value, double low, double high) {
    ImGui::SliderScalar(label, ImGuiDataType_Double, &value, &low, &high, "%.2f");
    mark(ui.probe, std::string("light/") + label);
  };
  slider("lamp", lighting.lamp, 0, 10);
  slider("azimuth", lighting.azimuth_deg, -180, 180);
  slider("elevation", lighting.elevation_deg, -89, 89);
  slider("environment", lighting.environment, 0, 4);
  slider("rotation", lighting.rotation_deg, -180, 180);
  ImGui::TextWrapped("Drop an EXR or HDR file on the window for another environment.");
  if (lighting == studio.lighting) return;
  studio.lighting = lighting;
  touch_view(studio);
}

void draw_compression(Ui& ui) {
  Studio& studio = ui.studio;
  if (studio.snapshot == nullptr || studio.is_homogeneous)
    return ImGui::TextUnformatted("no map to compress");
  ImGui::SliderInt("base materials, at most", &studio.compression.bases, 8, 256);
  ImGui::SliderInt("per pixel", &studio.compression.per_pixel, 1, 5);
  if (ImGui::Button("compress")) compress_map(studio);
  mark(ui.probe, "compress");
  if (studio.jobs.is_running("compress")) {
    ImGui::SameLine();
    if (ImGui::Button("stop")) studio.jobs.cancel("compress");
  }
  const std::size_t raw = map_bytes(*studio.snapshot->map);
  const auto choice = [&](std::optional<std::size_t> index, const std::string& text) {
    if (ImGui::RadioButton(text.c_str(), studio.shown_compressed == index))
      show_compressed(studio, index);
    mark(ui.probe, index ? fmt::format("compressed/{}", *index) : "compressed/none");
  };
  choice(std::nullopt, fmt::format("the map: {:.1f} kB", static_cast<double>(raw) / 1e3));
  for (std::size_t i = 0; i < studio.compressed.size(); ++i) {
    const CompressedPoint& point = studio.compressed[i];
    choice(i, fmt::format("{} x {}: {:.1f} kB, error {:.1f} %, albedo {:.1f} %", point.bases,
                          point.per_pixel, static_cast<double>(point.bytes) / 1e3,
                          100 * point.relative_error, 100 * point.albedo_error));
  }
  if (studio.compressed.size() > 1) {
    std::vector<float> errors;
    errors.reserve(studio.compressed.size());
    for (const CompressedPoint& point : studio.compressed)
      errors.push_back(static_cast<float>(100 * point.relative_error));
    ImGui::PlotLines("error, %", errors.data(), static_cast<int>(errors.size()), 0, nullptr, 0,
                     *std::max_element(errors.begin(), errors.end()),
                     {0, ImGui::GetFontSize() * 5});
  }
  if (studio.shown_compressed && ImGui::Button("save blend..."))
    ui.dialog = {FileDialog::Action::save_compressed, true, ui.dialog.folder, "material.kbm"};
  if (studio.shown_compressed) mark(ui.probe, "save blend");
}

void draw_statistics(Ui& ui) {
  const Studio& studio = ui.studio;
  ImGui::Text("%.0f frames/s of the window", static_cast<double>(ImGui::GetIO().Framerate));
  if (studio.picture != nullptr)
    ImGui::Text("picture %d x %d: %.0f ms", studio.picture->width, studio.picture->height,
                1e3 * studio.picture->seconds);
  if (studio.refined != nullptr) ImGui::Text("refined picture: %.1f s", studio.refined->seconds);
  if (studio.snapshot != nullptr) {
    ImGui::Text("last edit: %.1f ms, shown after %.0f ms", 1e3 * studio.snapshot->seconds,
                studio.edit_shown_ms);
    ImGui::Text("map: %.2f MB", static_cast<double>(map_bytes(*studio.snapshot->map)) / 1e6);
  }
  if (studio.stage != nullptr)
    ImGui::Text("%zu vertices, %zu triangles", studio.stage->scene.mesh.positions.size(),
                studio.stage->scene.mesh.triangles.size());
  ImGui::Separator();
  if (studio.picture != nullptr) draw_stages(studio.picture->report);
}

}  // namespace parian

// Frames, milliseconds and bytes.
#include <fmt/format.h>
#include <imgui.h>

#include <string>

#include "app/studio/figures.h"
#include "app/studio/ui.h"

namespace parian {
namespace {

// Name and figure, the figures in a column of their own.
void row(const char* name, const std::string& figure) {
  ImGui::TextUnformatted(name);
  ImGui::SameLine(ImGui::GetContentRegionMax().x - ImGui::CalcTextSize(figure.c_str()).x);
  ImGui::TextUnformatted(figure.c_str());
}
void row_ms(const char* name, double seconds) {
  row(name, fmt::format("{:.1f} ms", 1e3 * seconds));
}
void row_bytes(const char* name, std::size_t bytes) {
  row(name, bytes_text(bytes));
}

void draw_device(const std::string& device, const std::vector<std::string>& warnings) {
  ImGui::TextWrapped("%s", device.c_str());
  for (const std::string& warning : warnings) ImGui::TextWrapped("%s", warning.c_str());
}

void draw_splatting(const SplatReport& stages) {
  ImGui::TextDisabled("splatting");
  row_ms("material", stages.material_s);
  row_ms("light", stages.irradiance_s);
  row_ms("groups of samples", stages.group_s);
  row_ms("view", stages.view_s);
  row_ms("splats", stages.splat_s);
  row_ms("resolve", stages.resolve_s);
  row_ms("shade", stages.shade_s);
  row_ms("read back", stages.read_s);
  row("samples", std::to_string(stages.samples));
  row("levels", std::to_string(stages.levels));
  row("emitters", std::to_string(stages.splats));
  row_bytes("textures", stages.texture_bytes);
  draw_device(stages.device, stages.warnings);
}

void draw_live(const LiveReport& stages) {
  ImGui::TextDisabled("precomputed transport");
  row_ms("loading, once", stages.loading_s);
  row_ms("coefficients", stages.project_s);
  row_ms("update of vertices", stages.update_s);
  row_ms("view", stages.view_s);
  row_ms("shade", stages.shade_s);
  row_ms("read back", stages.read_s);
  row_bytes("textures", stages.texture_bytes);
  draw_device(stages.device, stages.warnings);
}

void draw_material_figures(const Ui& ui) {
  const Studio& studio = ui.studio;
  if (studio.snapshot != nullptr) {
    row_ms("last edit of the map", studio.snapshot->seconds);
    row_ms("last edit on the screen", studio.edit_shown_ms / 1e3);
    row_bytes("map", map_bytes(*studio.snapshot->map));
  }
  if (studio.shown_compressed)
    row_bytes("blend", studio.compressed[*studio.shown_compressed].bytes);
  if (studio.stage == nullptr) return;
  row("vertices", std::to_string(studio.stage->scene.mesh.positions.size()));
  row("triangles", std::to_string(studio.stage->scene.mesh.triangles.size()));
}

}  // namespace

void draw_statistics(Ui& ui) {
  const Studio& studio = ui.studio;
  row("window", fmt::format("{:.0f} frames/s", static_cast<double>(ImGui::GetIO().Framerate)));
  if (ui.probe.first_picture_s >= 0)
    row("first picture", fmt::format("{:.2f} s", ui.probe.first_picture_s));
  if (studio.picture != nullptr) {
    row("picture", fmt::format("{} × {}", studio.picture->width, studio.picture->height));
    row_ms("its time", studio.picture->seconds);
  }
  if (studio.refined != nullptr) {
    row("refined picture", fmt::format("{:.1f} s", studio.refined->seconds));
    if (studio.refined->half_width >= 0)
      row("certified to", fmt::format("± {:.0f} %", 100 * studio.refined->half_width));
  }
  draw_material_figures(ui);
  if (studio.picture == nullptr) return;
  ImGui::Separator();
  if (studio.picture->is_live)
    draw_live(studio.picture->live);
  else
    draw_splatting(studio.picture->report);
}

}  // namespace parian

// Layers of other materials over the one that is edited: what they are, how much of them, and
// where.
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "app/studio/mask_tool.h"
#include "app/studio/stage_layers.h"
#include "app/studio/ui.h"

namespace parian {
namespace {

void draw_move_buttons(Ui& ui, std::size_t i) {
  Studio& studio = ui.studio;
  // The list shows the last layer on top.
  if (ImGui::ArrowButton("up", ImGuiDir_Up)) move_stage_layer(studio, i, i + 1);
  mark(ui.probe, fmt::format("surface/{}/up", i));
  explain("further outside");
  ImGui::SameLine(0, 2);
  if (ImGui::ArrowButton("down", ImGuiDir_Down) && i > 0) move_stage_layer(studio, i, i - 1);
  mark(ui.probe, fmt::format("surface/{}/down", i));
  explain("further inside");
  ImGui::SameLine(0, 2);
  if (ImGui::Button("×", {ImGui::GetFrameHeight(), 0})) remove_stage_layer(studio, i);
  mark(ui.probe, fmt::format("surface/{}/remove", i));
  explain("remove");
}

void draw_row(Ui& ui, std::size_t i) {
  Studio& studio = ui.studio;
  const std::shared_ptr<const SurfaceLayer> layer = studio.layers[i];
  ImGui::PushID(static_cast<int>(i));
  bool enabled = layer->enabled;
  if (ImGui::Checkbox("##on", &enabled)) {
    SurfaceLayer changed = *layer;
    changed.enabled = enabled;
    set_stage_layer(studio, i, std::move(changed));
  }
  mark(ui.probe, fmt::format("surface/{}/on", i));
  explain("on or off");
  ImGui::SameLine();
  const float buttons = 3 * ImGui::GetFrameHeight() + 12;
  const float room = std::max(1.0f, ImGui::GetContentRegionAvail().x - buttons);
  ImGui::AlignTextToFramePadding();
  if (ImGui::Selectable(layer->material_name.c_str(), studio.selected_stage_layer == i, 0,
                        {room, 0}))
    studio.selected_stage_layer = i;
  mark(ui.probe, fmt::format("surface/{}", i));
  explain(layer->material_file.c_str());
  ImGui::SameLine();
  draw_move_buttons(ui, i);
  ImGui::PopID();
}

// Sliders of a described struct; true: it was changed.
template <typename Params>
bool draw_numbers(Ui& ui, Params& params) {
  Document document = write_params(describe(params));
  bool ended = false;
  return draw_params(ui, describe(params), document, ended);
}

bool draw_place(Ui& ui, const char* label, Vec3& place) {
  float values[3] = {place.x, place.y, place.z};
  const bool changed = ImGui::DragFloat3(label, values, 0.2f, 0, 0, "%.1f");
  mark(ui.probe, std::string("mask/") + label);
  explain("x, y and z in mm");
  if (changed) place = {values[0], values[1], values[2]};
  return changed;
}

// Kept as unit vectors.
bool draw_direction(Ui& ui, const char* label, Vec3& direction) {
  Vec3 changed = direction;
  float values[3] = {changed.x, changed.y, changed.z};
  const bool is_changed = ImGui::DragFloat3(label, values, 0.01f, -1, 1, "%.2f");
  mark(ui.probe, std::string("mask/") + label);
  if (!is_changed) return false;
  changed = {values[0], values[1], values[2]};
  if (length(changed) < 1e-3f) return false;
  direction = normalize(changed);
  return true;
}

// What a mask has beside its plain numbers.
struct DrawMask {
  Ui& ui;

  bool operator()(VertexMask& mask) const {
    if (!mask.file.empty()) return draw_file(mask.file);
    const VertexGraph& graph = stage_graph(ui.studio);
    ImGui::TextDisabled("at vertices, %.2g mm apart", graph.edge_mm);
    explain("what is painted cannot be finer than the mesh");
    return false;
  }
  bool operator()(TextureMask& mask) const { return draw_file(mask.file); }
  bool operator()(ProjectedMask& mask) const {
    const bool moved = draw_place(ui, "center", mask.center);
    return draw_direction(ui, "direction", mask.direction) || moved;
  }
  bool operator()(GradientMask& mask) const {
    GradientMask changed = mask;
    const bool moved = draw_place(ui, "from", changed.from);
    if (!draw_place(ui, "to", changed.to) && !moved) return false;
    if (changed.from == changed.to) return false;
    mask = changed;
    return true;
  }
  bool operator()(SphereMask& mask) const { return draw_place(ui, "center", mask.center); }
  bool operator()(SlabMask& mask) const {
    const bool moved = draw_place(ui, "point", mask.point);
    return draw_direction(ui, "direction", mask.direction) || moved;
  }
  bool operator()(NoiseMask&) const { return false; }
  bool operator()(StripesMask& mask) const {
    return draw_direction(ui, "direction", mask.direction);
  }

  static bool draw_file(const std::string& file) {
    ImGui::TextWrapped("%s", file.c_str());
    return false;
  }
};

bool draw_mask(Ui& ui, SurfaceMask& mask) {
  bool changed = false;
  if (mask.size() <= 1) {
    const std::size_t before = mask_kind_of(mask);
    std::size_t kind = before;
    if (draw_names(ui, "mask", mask_kind_names(), kind) && kind != before &&
        kind + 1 < mask_kind_names().size()) {
      mask = make_mask(kind, *ui.studio.stage);
      if (mask_kind_names()[kind] == "painted") choose_tool(ui.studio, Tool::mask);
      changed = true;
    }
    ImGui::SameLine();
    ImGui::TextUnformatted("where");
  } else {
    ImGui::TextDisabled("where %zu masks are, multiplied", mask.size());
  }
  for (std::size_t i = 0; i < mask.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    changed |= std::visit(DrawMask{ui}, mask[i].shape);
    changed |= std::visit([&](auto& shape) { return draw_numbers(ui, shape); }, mask[i].shape);
    changed |= ImGui::Checkbox("invert", &mask[i].invert);
    mark(ui.probe, "mask/invert");
    ImGui::PopID();
  }
  return changed;
}

// The brush, where the tool is in hand.
void draw_painting(Ui& ui) {
  Studio& studio = ui.studio;
  const bool paints = studio.tool == Tool::mask;
  const float width = ImGui::GetContentRegionAvail().x;
  if (!paints) {
    if (ImGui::Button("Paint the mask", {width, 0})) choose_tool(studio, Tool::mask);
    mark(ui.probe, "paint mask");
    explain("on the mesh, with the tool 'mask' (0)");
    return;
  }
  ImGui::TextDisabled("brush of the tool 'mask'");
  draw_numbers(ui, studio.mask.brush);
  const float spacing = ImGui::GetStyle().ItemSpacing.x;
  const float half = std::max(1.0f, (width - spacing) / 2);
  if (ImGui::Button("all", {half, 0})) fill_mask(studio, 1);
  mark(ui.probe, "mask all");
  explain("the layer lies everywhere; then erase");
  ImGui::SameLine(0, spacing);
  if (ImGui::Button("nothing", {half, 0})) fill_mask(studio, 0);
  mark(ui.probe, "mask nothing");
  explain("the layer lies nowhere; then paint");
}

void draw_layer(Ui& ui, std::size_t index) {
  Studio& studio = ui.studio;
  const SurfaceLayer& layer = *studio.layers[index];
  if (const std::string reason = why_not(layer, *studio.stage, *studio.material); !reason.empty())
    ImGui::TextWrapped("Not shown: %s", reason.c_str());
  SurfaceLayer changed = layer;
  bool edits = draw_numbers(ui, changed);
  ImGui::Separator();
  edits |= draw_mask(ui, changed.mask);
  if (ImGui::CollapsingHeader("mapping")) edits |= draw_numbers(ui, changed.mapping);
  if (edits) set_stage_layer(studio, index, std::move(changed));
  ImGui::Separator();
  draw_painting(ui);
}

}  // namespace

void draw_surface(Ui& ui) {
  Studio& studio = ui.studio;
  if (studio.stage == nullptr || studio.material == nullptr) return;
  ImGui::BeginDisabled(studio.layers.size() >= max_layers);
  if (ImGui::Button("Add a material…", {ImGui::GetContentRegionAvail().x, 0}))
    start_dialog(ui, FileDialog::Action::open_layer, "");
  ImGui::EndDisabled();
  mark(ui.probe, "add surface");
  explain("a map or blend over the material that is edited, all over or where a mask says");
  for (std::size_t i = studio.layers.size(); i-- > 0;)
    if (i < studio.layers.size()) draw_row(ui, i);
  ImGui::TextDisabled("%s", studio.is_homogeneous ? "homogeneous material" : "the edited map");
  if (studio.is_homogeneous && !shown_layers(studio).empty())
    ImGui::TextWrapped("Under layers there is no precomputed transport: edits are splatted.");
  if (studio.selected_stage_layer && *studio.selected_stage_layer < studio.layers.size()) {
    ImGui::Separator();
    draw_layer(ui, *studio.selected_stage_layer);
  }
}

}  // namespace parian

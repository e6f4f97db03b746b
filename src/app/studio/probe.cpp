#include "app/studio/probe.h"

#include "app/studio/stage_layers.h"
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

Document describe_input(const ProbeInput& input) {
  return Document::Object{{"mouse", Document::Array{static_cast<double>(input.mouse_x),
                                                    static_cast<double>(input.mouse_y)}},
                          {"down", input.is_down},
                          {"keys", static_cast<double>(input.keys)},
                          {"presses", static_cast<double>(input.presses)},
                          {"width", input.width},
                          {"height", input.height},
                          {"popup", input.has_popup}};
}

Document describe_widgets(const Probe& probe) {
  Document widgets{Document::Object{}};
  for (const auto& [name, box] : probe.widgets) {
    const auto before = probe.previous.find(name);
    if (before == probe.previous.end() || !(before->second == box)) continue;
    set(widgets, name,
        Document::Array{static_cast<double>(box.x0), static_cast<double>(box.y0),
                        static_cast<double>(box.x1), static_cast<double>(box.y1)});
  }
  return widgets;
}

Document to_array(const std::vector<std::string>& texts) {
  return Document::Array(texts.begin(), texts.end());
}

void describe_map(Document& state, const Studio& studio) {
  set(state, "layers", describe_layers(*studio.snapshot));
  set(state, "selected_layer",
      studio.selected_layer ? static_cast<double>(*studio.selected_layer) : -1.0);
  set(state, "history", to_array(studio.snapshot->history));
  set(state, "future", to_array(studio.snapshot->future));
  set(state, "edit_ms", 1e3 * studio.snapshot->seconds);
  set(state, "map_size",
      Document::Array{studio.snapshot->after.width, studio.snapshot->after.height});
}

void describe_picture(Document& state, Probe& probe, const Studio& studio) {
  const Picture& picture = *studio.picture;
  set(state, "picture", static_cast<double>(picture.id));
  set(state, "picture_ms", 1e3 * picture.seconds);
  set(state, "picture_size", Document::Array{picture.width, picture.height});
  const SplatReport& stages = picture.report;
  set(state, "stages_ms",
      Document::Object{{"sampling", 1e3 * stages.sampling_s},
                       {"irradiance", 1e3 * stages.irradiance_s},
                       {"material", 1e3 * stages.material_s},
                       {"group", 1e3 * stages.group_s},
                       {"view", 1e3 * stages.view_s},
                       {"splat", 1e3 * stages.splat_s},
                       {"resolve", 1e3 * stages.resolve_s},
                       {"shade", 1e3 * stages.shade_s},
                       {"read", 1e3 * stages.read_s}});
  set(state, "device", picture.is_live ? picture.live.device : stages.device);
  set(state, "live", picture.is_live);
  if (picture.is_live)
    set(state, "live_ms",
        Document::Object{{"project", 1e3 * picture.live.project_s},
                         {"update", 1e3 * picture.live.update_s},
                         {"view", 1e3 * picture.live.view_s},
                         {"shade", 1e3 * picture.live.shade_s},
                         {"read", 1e3 * picture.live.read_s}});
  set(state, "fine", picture.is_fine);
  if (probe.seen != studio.picture) {
    probe.seen = studio.picture;
    probe.brightness = brightness_of(picture);
  }
  set(state, "brightness", probe.brightness);
}

// Mean of a painted mask.
double painted_part(const SurfaceLayer& layer) {
  const auto* painted =
      layer.mask.empty() ? nullptr : std::get_if<VertexMask>(&layer.mask.front().shape);
  return painted != nullptr ? mean_of(painted->weights) : 0;
}

// All lights and layers of the surface, and where those are that dragging turns.
void describe_lights(Document& state, const Studio& studio) {
  const Vec3 middle = studio.stage != nullptr ? center(studio.stage->box) : Vec3{};
  const std::size_t lamp = find_light(studio.lighting, studio.selected_light, false),
                    sky = find_light(studio.lighting, studio.selected_light, true);
  if (lamp < studio.lighting.size())
    set(state, "azimuth_deg", angles_of(studio.lighting[lamp], middle).azimuth_deg);
  if (sky < studio.lighting.size()) set(state, "rotation_deg", studio.lighting[sky].rotation_deg);
  Document::Array lights, layers;
  for (const StageLight& light : studio.lighting)
    lights.emplace_back(
        Document::Object{{"kind", light_kind_names()[static_cast<std::size_t>(light.kind)]},
                         {"enabled", light.enabled}});
  for (const auto& layer : studio.layers)
    layers.emplace_back(Document::Object{{"name", layer->material_name},
                                         {"enabled", layer->enabled},
                                         {"opacity", layer->opacity},
                                         {"mask", mask_kind_names()[mask_kind_of(layer->mask)]},
                                         {"painted", painted_part(*layer)}});
  set(state, "lights", std::move(lights));
  set(state, "surface", std::move(layers));
}

void describe_scene(Document& state, const Studio& studio) {
  set(state, "material", studio.material_path);
  set(state, "mesh", studio.mesh_path);
  set(state, "second", studio.second != nullptr ? studio.second->path : "");
  set(state, "homogeneous", studio.is_homogeneous);
  Document::Array absorption;
  for (const DipoleCoefficients& channel : studio.homogeneous.channels)
    absorption.emplace_back(channel.sigma_a);
  set(state, "sigma_a", std::move(absorption));
  set(state, "yaw_deg", studio.orbit.yaw_deg);
  set(state, "distance_mm", studio.orbit.distance_mm);
  describe_lights(state, studio);
  set(state, "brush_mm", studio.brush_radius_mm);
  set(state, "show_selection", studio.show_selection);
  Document::Array rows;
  for (const HistoryRow& row : view_history(studio).rows) rows.emplace_back(row.label);
  set(state, "rows", std::move(rows));
}

Document describe_state(Probe& probe, const Studio& studio) {
  Document state{Document::Object{}};
  set(state, "input", describe_input(probe.input));
  set(state, "settled", is_settled(studio));
  set(state, "still", still_names()[static_cast<std::size_t>(studio.still)]);
  set(state, "tool", tool_names()[static_cast<std::size_t>(studio.tool)]);
  set(state, "mode", view_mode_names()[static_cast<std::size_t>(studio.mode)]);
  set(state, "flat_mode", flat_mode_names()[static_cast<std::size_t>(studio.flat_mode)]);
  describe_scene(state, studio);
  if (studio.snapshot != nullptr) describe_map(state, studio);
  set(state, "edit_shown_ms", studio.edit_shown_ms);
  set(state, "first_picture_s", probe.first_picture_s);
  set(state, "flat_zoom", probe.flat_zoom);
  if (studio.picture != nullptr) describe_picture(state, probe, studio);
  if (studio.refined != nullptr) set(state, "refined", static_cast<double>(studio.refined->id));
  set(state, "compressed", studio.compressed.size());
  set(state, "shown_compressed",
      studio.shown_compressed ? static_cast<double>(*studio.shown_compressed) : -1.0);
  set(state, "transport", studio.transport != nullptr);
  set(state, "picked", studio.picked.has_value());
  set(state, "recoverable", studio.recoverable.has_value());
  Document::Array messages, jobs;
  for (const Message& message : studio.messages) messages.emplace_back(message.text);
  for (const JobView& job : studio.jobs.views()) jobs.emplace_back(job.name);
  set(state, "messages", std::move(messages));
  set(state, "jobs", std::move(jobs));
  set(state, "widgets", describe_widgets(probe));
  return state;
}

}  // namespace

void write_probe(Probe& probe, const Studio& studio) {
  if (probe.path.empty() || studio.now_s - probe.last_s < interval_s) return;
  std::string text = format_document(describe_state(probe, studio));
  if (text == probe.last) return;
  probe.last_s = studio.now_s;
  write_text(probe.path, text);
  probe.last = std::move(text);
}

}  // namespace parian

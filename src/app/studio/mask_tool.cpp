#include "app/studio/mask_tool.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/studio/stage_layers.h"
#include "base/error.h"

namespace parian {
namespace {

constexpr double step_px = 2;       // between rays along a stroke
constexpr double step_part = 0.15;  // of the radius, between touches

// Why the chosen layer cannot be painted; empty: it can.
std::string find_obstacle(const Studio& studio) {
  if (studio.stage == nullptr || studio.material == nullptr) return "there is no mesh to paint on";
  if (studio.layers.empty())
    return "add a material under Surface first: the tool 'mask' paints where it lies";
  const SurfaceLayer* layer = painted_layer(studio);
  if (layer == nullptr) return "choose a layer under Surface first: its mask is painted";
  if (!layer->enabled) return layer->material_name + " is switched off under Surface";
  SurfaceLayer unmasked = *layer;
  unmasked.mask.clear();
  return why_not(unmasked, *studio.stage, *studio.material);
}

// That can be painted as it is; null: the mask has to become one.
const VertexMask* painted_mask(const SurfaceLayer& layer) {
  if (layer.mask.size() != 1 || layer.mask.front().invert) return nullptr;
  return std::get_if<VertexMask>(&layer.mask.front().shape);
}

// What the stroke starts from.
VertexMask take_mask(const SurfaceLayer& layer, const TriangleMesh& mesh, bool erases) {
  if (const VertexMask* painted = painted_mask(layer)) return *painted;
  VertexMask mask = sample_at_vertices(layer.mask, mesh);
  if (layer.mask.empty() && !erases) std::fill(mask.weights.begin(), mask.weights.end(), 0.0f);
  return mask;
}

bool fits(const SurfaceLayer& layer, const TriangleMesh& mesh) {
  try {
    check(layer.mask, mesh, {}, {});
    return true;
  } catch (const Error&) {
    return false;
  }
}

void show_mask(Studio& studio, std::size_t index, VertexMask mask) {
  SurfaceLayer layer = *studio.layers[index];
  layer.mask = {{std::move(mask)}};
  set_stage_layer(studio, index, std::move(layer));
}

void say_what_becomes_of(Studio& studio, const SurfaceLayer& layer, bool erases) {
  const std::string& name = layer.material_name;
  if (layer.mask.empty() && !erases) return report(studio, name + " lies where it is painted now");
  const bool was_painted =
      layer.mask.size() == 1 && std::holds_alternative<VertexMask>(layer.mask.front().shape);
  if (!layer.mask.empty() && !was_painted)
    report(studio, fmt::format("the mask of {} is painted at the mesh's vertices now", name));
}

}  // namespace

const SurfaceLayer* painted_layer(const Studio& studio) {
  if (!studio.selected_stage_layer || *studio.selected_stage_layer >= studio.layers.size())
    return nullptr;
  return studio.layers[*studio.selected_stage_layer].get();
}

const VertexGraph& stage_graph(Studio& studio) {
  MaskTool& tool = studio.mask;
  if (tool.graph == nullptr || tool.stage != studio.stage) {
    tool.graph = std::make_shared<const VertexGraph>(make_vertex_graph(studio.stage->scene.mesh));
    tool.stage = studio.stage;
  }
  return *tool.graph;
}

void begin_mask_stroke(Studio& studio, bool erases) {
  MaskTool& tool = studio.mask;
  note_scene_now(studio);  // what came just before is an entry of its own
  tool.stroke.reset();
  if (!studio.selected_stage_layer && studio.layers.size() == 1) studio.selected_stage_layer = 0;
  if (std::string obstacle = find_obstacle(studio); !obstacle.empty())
    return report(studio, std::move(obstacle), true);
  const TriangleMesh& mesh = studio.stage->scene.mesh;
  const SurfaceLayer& layer = *painted_layer(studio);
  MaskBrush brush = tool.brush;
  brush.erases = brush.erases != erases;
  SurfaceLayer start = layer;
  if (!fits(layer, mesh)) {
    start.mask.clear();
    report(studio,
           fmt::format("the mask of {} was of another mesh: it begins anew", layer.material_name));
  }
  stage_graph(studio);
  tool.stroke = start_stroke(brush, take_mask(start, mesh, brush.erases), mesh);
  tool.index = *studio.selected_stage_layer;
  tool.layer = studio.layers[tool.index];
  tool.last.reset();
}

void extend_mask_stroke(Studio& studio, const std::array<double, 2>& from,
                        const std::array<double, 2>& to) {
  MaskTool& tool = studio.mask;
  if (!tool.stroke) return;
  // What is painted went away meanwhile.
  if (tool.stage != studio.stage || tool.index >= studio.layers.size() ||
      studio.layers[tool.index] != tool.layer)
    return tool.stroke.reset();
  const Stage& stage = *studio.stage;
  const Camera camera = make_view_camera(studio, 1);
  const double apart = std::hypot(to[0] - from[0], to[1] - from[1]);
  const int steps = std::max(1, static_cast<int>(std::ceil(apart / step_px)));
  bool touched = false;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    const std::optional<SurfacePoint> point =
        find_point(stage, camera, from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]));
    if (!point) continue;
    if (tool.last && static_cast<double>(distance(*tool.last, point->position)) <
                         step_part * tool.stroke->brush.radius_mm)
      continue;
    touch(*tool.stroke, stage.scene.mesh, *tool.graph, *point);
    tool.last = point->position;
    touched = true;
  }
  if (!touched) return;
  VertexMask mask = paint(*tool.stroke, stage.scene.mesh, *tool.graph);
  if (const VertexMask* shown = painted_mask(*tool.layer);
      shown != nullptr && shown->weights == mask.weights)
    return;
  say_what_becomes_of(studio, *tool.layer, tool.stroke->brush.erases);
  show_mask(studio, tool.index, std::move(mask));
  tool.layer = studio.layers[tool.index];
}

void finish_mask_stroke(Studio& studio) {
  studio.mask.stroke.reset();
  studio.mask.layer.reset();
}

void fill_mask(Studio& studio, float weight) {
  if (std::string obstacle = find_obstacle(studio); !obstacle.empty())
    return report(studio, std::move(obstacle), true);
  const std::size_t vertices = count_source_vertices(studio.stage->scene.mesh);
  show_mask(studio, *studio.selected_stage_layer, {std::vector<float>(vertices, weight)});
}

}  // namespace parian

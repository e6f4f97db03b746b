#include "app/studio/tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "app/studio/strokes.h"
#include "base/error.h"
#include "edit/adjust.h"

namespace parian {
namespace {

PickedProfile pick_from(const EditState& state, const std::string& map, MapPixel pixel) {
  PickedProfile picked{
      .map = map,
      .at_mm = {(pixel.x + 0.5) * state.pixel_pitch_mm, (pixel.y + 0.5) * state.pixel_pitch_mm}};
  for (int c = 0; c < state.channels; ++c)
    picked.profiles.push_back(get_profile(state, c, pixel.x, pixel.y));
  return picked;
}

Document describe_inspected(const Studio& studio) {
  const double pitch = studio.snapshot->after.pixel_pitch_mm;
  Document from{Document::Object{}};
  set(from, "at",
      Document::Array{(studio.inspected.x + 0.5) * pitch, (studio.inspected.y + 0.5) * pitch});
  return from;
}

// The strokes of a selected scribble, each with the parameters of its layer; else a dab on the
// inspected pixel.
Document make_interpolation(const Studio& studio) {
  Document layer = make_default_layer("interpolate", "interpolate");
  const LayerSnapshot* scribble = selected_layer(studio);
  const Document* selection = scribble != nullptr && scribble->kind == "adjust"
                                  ? find(scribble->source, "selection")
                                  : nullptr;
  if (selection == nullptr || part_type(*selection) != "propagate") {
    const Document from = describe_inspected(studio);
    const std::vector<double> at = as_numbers(get(from, "at"));
    set(layer, "strokes", make_scribbles({{{at[0], at[1]}}}, studio.brush_radius_mm, true));
    return layer;
  }
  Document::Array strokes = as_array(get(*selection, "strokes"));
  Adjust defaults;
  for (Document& stroke : strokes)
    for (const Param& param : describe(defaults)) {
      const Document* positive = find(stroke, "positive");
      const Document* value = find(scribble->source, json_key(param));
      if (value != nullptr && (positive == nullptr || as_bool(*positive)))
        set(stroke, json_key(param), *value);
    }
  set(layer, "strokes", std::move(strokes));
  return layer;
}

[[noreturn]] void throw_needs(const std::string& operation, std::string what) {
  throw Error({{}, "layer '" + operation + "'", std::move(what), "none"});
}

}  // namespace

Document make_default_layer(const std::string& operation, const std::string& name) {
  Document layer{Document::Object{}};
  set(layer, "name", name);
  set(layer, "operation", operation);
  return layer;
}

void add_layer(Studio& studio, const Document& layer) {
  if (studio.snapshot == nullptr) return;
  const std::size_t count = studio.snapshot->layers.size();
  const std::size_t index =
      studio.selected_layer ? std::min(*studio.selected_layer + 1, count) : count;
  const std::string name = as_string(get(layer, "name"));
  studio.editor->post("add " + name, insert_layer(index, layer));
  studio.selected_layer = index;
  studio.part.clear();
  studio.selected_stroke = 0;
  touch_map(studio);
}

void change_layer(Studio& studio, Document layer, std::string label, std::string merge_key) {
  if (selected_layer(studio) == nullptr) return;
  studio.editor->post(std::move(label), set_layer(*studio.selected_layer, layer),
                      std::move(merge_key));
  touch_map(studio);
  studio.pending_layer = std::pair(*studio.selected_layer, std::move(layer));
  show_pending(studio);
}

void show_pending(Studio& studio) {
  if (!studio.pending_layer) return;
  const auto& [index, source] = *studio.pending_layer;
  if (index >= studio.snapshot->layers.size()) return;
  auto shown = std::make_shared<EditorSnapshot>(*studio.snapshot);
  shown->layers[index].source = source;
  studio.snapshot = std::move(shown);
}

// Operations that change the grid take the whole map.
bool takes_selection(const std::string& operation) {
  static const std::vector<std::string> whole{"hallucinate", "crop",     "tile",      "flip",
                                              "rotate",      "resample", "synthesize"};
  return std::find(whole.begin(), whole.end(), operation) == whole.end();
}

const LayerSnapshot* selected_layer(const Studio& studio) {
  if (studio.snapshot == nullptr || !studio.selected_layer) return nullptr;
  if (*studio.selected_layer >= studio.snapshot->layers.size()) return nullptr;
  return &studio.snapshot->layers[*studio.selected_layer];
}

Document make_starting_layer(const Studio& studio, const std::string& operation) {
  Document layer = make_default_layer(operation, operation);
  if (studio.snapshot == nullptr) throw_needs(operation, "a map to be open");
  if (operation == "blend") {
    if (!studio.picked) throw_needs(operation, "a profile from the tool 'pick'");
    set(layer, "from", describe_picked(*studio.picked));
    set(layer, "opacity", 0.5);
  } else if (operation == "paste") {
    if (!studio.stamp_source) throw_needs(operation, "a rectangle dragged with the tool 'stamp'");
    const EditState& state = studio.snapshot->after;
    return make_stamp_layer(*studio.stamp_source, {0.5 * state.width * state.pixel_pitch_mm,
                                                   0.5 * state.height * state.pixel_pitch_mm});
  } else if (operation == "interpolate") {
    return make_interpolation(studio);
  } else if (operation == "hallucinate") {
    throw_needs(operation, "a photograph: choose File, Material from photograph");
  } else if (operation == "resample") {
    set(layer, "pixel_pitch_mm", 2 * studio.snapshot->after.pixel_pitch_mm);
  } else if (operation == "crop") {
    set(layer, "unit", "relative");
    set(layer, "min", Document::Array{0.25, 0.25});
    set(layer, "max", Document::Array{0.75, 0.75});
  }
  return layer;
}

void hallucinate(Studio& studio, const std::string& photograph) {
  if (studio.snapshot == nullptr)
    return report(studio, photograph + ": open a map first, which gives range and shape", true);
  Document pin{Document::Object{}}, layer = make_default_layer("hallucinate", "hallucinate");
  set(pin, "at", Document::Array{0.5, 0.5});
  set(pin, "from", describe_inspected(studio));
  set(layer, "photograph", std::filesystem::absolute(photograph).string());
  set(layer, "pins", Document::Array{std::move(pin)});
  // At the end: it makes a map of its own from all that is below.
  studio.selected_layer.reset();
  add_layer(studio, layer);
  report(studio, "a material from " + std::filesystem::path(photograph).filename().string() +
                     " with the range of the inspected pixel");
}

void extend_stroke(Studio& studio, double x_mm, double y_mm, bool on_second) {
  if (studio.snapshot == nullptr || (on_second && studio.second == nullptr)) return;
  const EditState& state = on_second ? studio.second->state : studio.snapshot->after;
  Stroke& stroke = studio.stroke;
  stroke.tool = studio.tool;
  stroke.on_second = on_second;
  if (stroke.lines.empty() || stroke.ended) stroke.lines.emplace_back();
  stroke.ended = false;
  stroke.lines.back().push_back({std::clamp(x_mm, 0.0, state.width * state.pixel_pitch_mm),
                                 std::clamp(y_mm, 0.0, state.height * state.pixel_pitch_mm)});
}

void break_stroke(Studio& studio) {
  studio.stroke.ended = true;
}

void finish_stroke(Studio& studio) {
  Stroke drawn = std::exchange(studio.stroke, {});
  if (drawn.lines.empty() || studio.snapshot == nullptr) return;
  studio.waiting_strokes.push_back(std::move(drawn));
  apply_strokes(studio);
}

void apply_strokes(Studio& studio) {
  if (studio.waiting_strokes.empty() || studio.editor == nullptr) return;
  if (studio.editor->activity().busy) return;
  studio.snapshot = studio.editor->snapshot();
  const Stroke next = std::move(studio.waiting_strokes.front());
  studio.waiting_strokes.pop_front();
  if (!next.on_second || studio.second != nullptr) apply_stroke(studio, next);
}

bool draws_on_map(Tool tool) {
  return tool != Tool::orbit && tool != Tool::light && tool != Tool::eyedropper &&
         tool != Tool::mask;
}

BrushBounds brush_bounds(const Studio& studio) {
  const EditState& state = studio.snapshot->after;
  const double pitch = state.pixel_pitch_mm;
  return {0.25 * pitch, std::max(pitch, 0.25 * pitch * std::max(state.width, state.height))};
}

std::optional<MapPixel> pixel_at(const EditState& state, double x_mm, double y_mm) {
  const double x = std::floor(x_mm / state.pixel_pitch_mm),
               y = std::floor(y_mm / state.pixel_pitch_mm);
  if (!(x >= 0 && y >= 0 && x < state.width && y < state.height)) return std::nullopt;
  return MapPixel{static_cast<int>(x), static_cast<int>(y)};
}

void pick_pixel(Studio& studio, MapPixel pixel) {
  if (studio.snapshot == nullptr) return;
  studio.inspected = pixel;
  studio.beam = pixel;
  if (studio.flat_mode == FlatMode::beam) studio.flat_is_stale = true;
  if (studio.tool != Tool::eyedropper) return;
  studio.picked = pick_from(studio.snapshot->after, "", pixel);
}

void pick_second(Studio& studio, double x_mm, double y_mm) {
  if (studio.second == nullptr || studio.tool != Tool::eyedropper) return;
  if (const auto pixel = pixel_at(studio.second->state, x_mm, y_mm))
    studio.picked = pick_from(studio.second->state, studio.second->path, *pixel);
}

std::optional<std::array<double, 2>> mesh_to_map(const Studio& studio, double px, double py) {
  if (studio.stage == nullptr || studio.snapshot == nullptr) return std::nullopt;
  const EditState& state = studio.snapshot->after;
  const SampleGrid grid{state.width, state.height, state.pixel_pitch_mm};
  const Camera camera = make_camera(studio.orbit, studio.view_width, studio.view_height);
  const std::optional<MapPlace> place = pick(*studio.stage, grid, camera, px, py);
  if (!place) return std::nullopt;
  return std::array{(place->x + 0.5) * grid.pixel_pitch_mm, (place->y + 0.5) * grid.pixel_pitch_mm};
}

void set_shape_point(Studio& studio, double u, double factor) {
  const LayerSnapshot* layer = selected_layer(studio);
  const bool changes = layer != nullptr && layer->kind == "shape";
  Document changed = changes ? layer->source : make_default_layer("shape", "shape curve");
  Document::Array points;
  if (const Document* scale = find(changed, "scale"); scale != nullptr)
    if (const auto* old = std::get_if<Document::Array>(&scale->value)) points = *old;
  if (points.empty())
    for (const double at : {0.0, 0.25, 0.5, 0.75, 1.0})
      points.emplace_back(Document::Array{at, 1.0});
  for (Document& point : points) {
    const double at = as_numbers(point).at(0);
    if (std::abs(at - u) < 1e-9) point = Document(Document::Array{u, factor});
  }
  set(changed, "scale", std::move(points));
  if (!changes) return add_layer(studio, changed);
  change_layer(studio, std::move(changed), "shape curve",
               fmt::format("shape {} {}", *studio.selected_layer, studio.drags));
}

}  // namespace parian

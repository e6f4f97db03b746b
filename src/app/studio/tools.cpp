#include "app/studio/tools.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace parian {
namespace {

Document::Array to_points(const std::vector<std::array<double, 2>>& points) {
  Document::Array array;
  array.reserve(points.size());
  for (const auto& point : points) array.emplace_back(Document::Array{point[0], point[1]});
  return array;
}

// Points closer than a quarter of a pixel add nothing.
std::vector<std::array<double, 2>> thin_out(const std::vector<std::array<double, 2>>& points,
                                            double least) {
  std::vector<std::array<double, 2>> kept;
  kept.reserve(points.size());
  for (const auto& point : points)
    if (kept.empty() || std::hypot(point[0] - kept.back()[0], point[1] - kept.back()[1]) >= least)
      kept.push_back(point);
  return kept;
}

const std::string* selection_type(const Document& layer) {
  const Document* selection = find(layer, "selection");
  const Document* type = selection != nullptr ? find(*selection, "type") : nullptr;
  return type != nullptr ? std::get_if<std::string>(&type->value) : nullptr;
}

Document& member(Document& object, const std::string& key) {
  auto& members = std::get<Document::Object>(object.value);
  const auto found = std::find_if(members.begin(), members.end(),
                                  [&](const auto& pair) { return pair.first == key; });
  if (found != members.end()) return found->second;
  return members.emplace_back(key, Document{Document::Array{}}).second;
}

Document make_scribble(const std::vector<std::array<double, 2>>& points, double radius,
                       bool positive) {
  Document stroke{Document::Object{}};
  set(stroke, "points", to_points(points));
  set(stroke, "radius", radius);
  if (!positive) set(stroke, "positive", false);
  return stroke;
}

Document make_brush(const std::vector<std::array<double, 2>>& points, double radius) {
  Document stroke{Document::Object{}};
  set(stroke, "type", "stroke");
  set(stroke, "points", to_points(points));
  set(stroke, "radius", radius);
  return stroke;
}

// Adds a stroke to the selected layer when its selection has `type` and holds strokes under `key`.
bool append_to_selected(Studio& studio, const std::string& type, const std::string& key,
                        const Document& stroke, const std::string& operation = {}) {
  const LayerSnapshot* layer = selected_layer(studio);
  if (layer == nullptr || (!operation.empty() && layer->kind != operation)) return false;
  const std::string* present = selection_type(layer->source);
  if (present == nullptr || *present != type) return false;
  Document changed = layer->source;
  auto& strokes = std::get<Document::Array>(member(member(changed, "selection"), key).value);
  strokes.push_back(stroke);
  studio.editor->post("stroke on " + layer->name,
                      set_layer(*studio.selected_layer, std::move(changed)));
  touch_map(studio);
  return true;
}

void add_with_selection(Studio& studio, Document layer, const std::string& type,
                        const std::string& key, Document stroke) {
  Document selection{Document::Object{}};
  set(selection, "type", type);
  set(selection, key, Document::Array{std::move(stroke)});
  set(layer, "selection", std::move(selection));
  add_layer(studio, std::move(layer));
}

void scribble(Studio& studio, const std::vector<std::array<double, 2>>& points, bool positive) {
  Document stroke = make_scribble(points, studio.brush_radius_mm, positive);
  if (append_to_selected(studio, "propagate", "strokes", stroke)) return;
  if (!positive)
    return report(studio, "draw a stroke with 'scribble +' first: this one says what stays", true);
  add_with_selection(studio, make_default_layer("adjust", "scribble"), "propagate", "strokes",
                     std::move(stroke));
}

void paint(Studio& studio, const std::vector<std::array<double, 2>>& points) {
  if (!studio.picked)
    return report(studio, "pick a profile with the eyedropper first: it is what paint is made of",
                  true);
  Document stroke = make_brush(points, studio.brush_radius_mm);
  Document from{Document::Object{}};
  if (!studio.picked->map.empty()) set(from, "map", studio.picked->map);
  const double pitch = studio.snapshot->before.pixel_pitch_mm;
  set(from, "at",
      Document::Array{(studio.picked->pixel.x + 0.5) * pitch,
                      (studio.picked->pixel.y + 0.5) * pitch});
  const LayerSnapshot* layer = selected_layer(studio);
  const Document* present = layer != nullptr ? find(layer->source, "from") : nullptr;
  if (present != nullptr && is_same_value(*present, from) &&
      append_to_selected(studio, "union", "of", stroke, "blend"))
    return;
  Document painted = make_default_layer("blend", "paint");
  set(painted, "from", std::move(from));
  add_with_selection(studio, std::move(painted), "union", "of", std::move(stroke));
}

void stamp(Studio& studio, const std::vector<std::array<double, 2>>& points) {
  const auto& first = points.front();
  const auto& last = points.back();
  const double least = 2 * studio.snapshot->after.pixel_pitch_mm;
  const std::array<double, 4> box{std::min(first[0], last[0]), std::min(first[1], last[1]),
                                  std::max(first[0], last[0]), std::max(first[1], last[1])};
  const bool is_box = box[2] - box[0] >= least && box[3] - box[1] >= least;
  if (is_box) {
    studio.stamp_source = box;
    return report(studio, "pattern taken; click where it goes");
  }
  if (!studio.stamp_source)
    return report(studio, "drag a rectangle around a pattern first, then click where it goes",
                  true);
  const std::array<double, 4> source = *studio.stamp_source;
  const double half_width = (source[2] - source[0]) / 2, half_height = (source[3] - source[1]) / 2;
  Document from{Document::Object{}}, selection{Document::Object{}};
  set(from, "min", Document::Array{source[0], source[1]});
  set(from, "max", Document::Array{source[2], source[3]});
  set(selection, "type", "ellipse");
  set(selection, "center", Document::Array{last[0], last[1]});
  set(selection, "radii", Document::Array{0.95 * half_width, 0.95 * half_height});
  Document layer = make_default_layer("paste", "stamp");
  set(layer, "from", std::move(from));
  set(layer, "to", Document::Array{last[0], last[1]});
  set(layer, "selection", std::move(selection));
  add_layer(studio, std::move(layer));
}

}  // namespace

Document make_default_layer(const std::string& operation, const std::string& name) {
  Document layer{Document::Object{}};
  set(layer, "name", name);
  set(layer, "operation", operation);
  return layer;
}

void add_layer(Studio& studio, Document layer) {
  if (studio.snapshot == nullptr) return;
  const std::size_t count = studio.snapshot->layers.size();
  const std::size_t index =
      studio.selected_layer ? std::min(*studio.selected_layer + 1, count) : count;
  const std::string name = as_string(get(layer, "name"));
  studio.editor->post("add " + name, insert_layer(index, std::move(layer)));
  studio.selected_layer = index;
  touch_map(studio);
}

const LayerSnapshot* selected_layer(const Studio& studio) {
  if (studio.snapshot == nullptr || !studio.selected_layer) return nullptr;
  if (*studio.selected_layer >= studio.snapshot->layers.size()) return nullptr;
  return &studio.snapshot->layers[*studio.selected_layer];
}

void extend_stroke(Studio& studio, double x_mm, double y_mm) {
  if (studio.snapshot == nullptr) return;
  const EditState& state = studio.snapshot->after;
  studio.stroke.push_back({std::clamp(x_mm, 0.0, state.width * state.pixel_pitch_mm),
                           std::clamp(y_mm, 0.0, state.height * state.pixel_pitch_mm)});
}

void finish_stroke(Studio& studio) {
  const auto drawn = std::exchange(studio.stroke, {});
  if (drawn.empty() || studio.snapshot == nullptr) return;
  if (studio.editor->activity().busy) studio.editor->wait();
  studio.snapshot = studio.editor->snapshot();
  if (studio.tool == Tool::stamp) return stamp(studio, drawn);
  const auto points = thin_out(drawn, 0.25 * studio.snapshot->after.pixel_pitch_mm);
  switch (studio.tool) {
    case Tool::scribble_plus:
      return scribble(studio, points, true);
    case Tool::scribble_minus:
      return scribble(studio, points, false);
    case Tool::paint:
      return paint(studio, points);
    case Tool::brush: {
      Document stroke = make_brush(points, studio.brush_radius_mm);
      if (!append_to_selected(studio, "union", "of", stroke))
        add_with_selection(studio, make_default_layer("adjust", "brush"), "union", "of",
                           std::move(stroke));
      return;
    }
    default:
      return;
  }
}

std::optional<MapPixel> pixel_at(const Studio& studio, double x_mm, double y_mm) {
  if (studio.snapshot == nullptr) return std::nullopt;
  const EditState& state = studio.snapshot->after;
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
  const EditState& state = studio.snapshot->after;
  PickedProfile picked{.pixel = pixel};
  for (int c = 0; c < state.channels; ++c)
    picked.profiles.push_back(get_profile(state, c, pixel.x, pixel.y));
  studio.picked = std::move(picked);
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
  if (!changes) return add_layer(studio, std::move(changed));
  studio.editor->post("shape curve", set_layer(*studio.selected_layer, std::move(changed)),
                      fmt::format("shape {} {}", *studio.selected_layer, studio.drags));
  touch_map(studio);
}

}  // namespace parian

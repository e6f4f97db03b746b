#include "app/studio/tools.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "base/error.h"

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

Document describe_picked(const PickedProfile& picked) {
  Document from{Document::Object{}};
  if (!picked.map.empty()) set(from, "map", picked.map);
  set(from, "at", Document::Array{picked.at_mm[0], picked.at_mm[1]});
  return from;
}

PickedProfile pick_from(const EditState& state, const std::string& map, MapPixel pixel) {
  PickedProfile picked{
      .map = map,
      .at_mm = {(pixel.x + 0.5) * state.pixel_pitch_mm, (pixel.y + 0.5) * state.pixel_pitch_mm}};
  for (int c = 0; c < state.channels; ++c)
    picked.profiles.push_back(get_profile(state, c, pixel.x, pixel.y));
  return picked;
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
  Document from = describe_picked(*studio.picked);
  const LayerSnapshot* layer = selected_layer(studio);
  const Document* present = layer != nullptr ? find(layer->source, "from") : nullptr;
  if (present != nullptr && is_same_value(*present, from) &&
      append_to_selected(studio, "union", "of", stroke, "blend"))
    return;
  Document painted = make_default_layer("blend", "paint");
  set(painted, "from", std::move(from));
  add_with_selection(studio, std::move(painted), "union", "of", std::move(stroke));
}

Document describe_stamp(const StampSource& source) {
  Document from{Document::Object{}};
  if (!source.map.empty()) set(from, "map", source.map);
  set(from, "min", Document::Array{source.box_mm[0], source.box_mm[1]});
  set(from, "max", Document::Array{source.box_mm[2], source.box_mm[3]});
  return from;
}

// The source's ellipse around a point; its border gives the values between which it is fitted.
Document make_stamp_layer(const StampSource& source, const std::array<double, 2>& to) {
  const auto& box = source.box_mm;
  Document selection{Document::Object{}};
  set(selection, "type", "ellipse");
  set(selection, "center", Document::Array{to[0], to[1]});
  set(selection, "radii", Document::Array{0.475 * (box[2] - box[0]), 0.475 * (box[3] - box[1])});
  Document layer = make_default_layer("paste", "stamp");
  set(layer, "from", describe_stamp(source));
  set(layer, "to", Document::Array{to[0], to[1]});
  set(layer, "selection", std::move(selection));
  return layer;
}

void stamp(Studio& studio, const Stroke& stroke) {
  const auto& first = stroke.lines.front().front();
  const auto& last = stroke.lines.back().back();
  const EditState& state = stroke.on_second ? studio.second->state : studio.snapshot->after;
  const double least = 2 * state.pixel_pitch_mm;
  const std::array<double, 4> box{std::min(first[0], last[0]), std::min(first[1], last[1]),
                                  std::max(first[0], last[0]), std::max(first[1], last[1])};
  if (box[2] - box[0] >= least && box[3] - box[1] >= least) {
    studio.stamp_source = {stroke.on_second ? studio.second->path : "", box};
    return report(studio, "pattern taken; click where it goes");
  }
  if (!studio.stamp_source)
    return report(studio, "drag a rectangle around a pattern first, then click where it goes",
                  true);
  if (stroke.on_second)
    return report(studio, "click on the map that is edited, not on the second material", true);
  add_layer(studio, make_stamp_layer(*studio.stamp_source, last));
}

void apply_stroke(Studio& studio, const Stroke& stroke) {
  if (stroke.tool == Tool::stamp) return stamp(studio, stroke);
  if (stroke.on_second)
    return report(studio, "the second material only gives: pick from it, or stamp", true);
  const auto points = thin_out(stroke.points, 0.25 * studio.snapshot->after.pixel_pitch_mm);
  switch (stroke.tool) {
    case Tool::scribble_plus:
      return scribble(studio, points, true);
    case Tool::scribble_minus:
      return scribble(studio, points, false);
    case Tool::paint:
      return paint(studio, points);
    case Tool::brush: {
      Document drawn = make_brush(points, studio.brush_radius_mm);
      if (!append_to_selected(studio, "union", "of", drawn))
        add_with_selection(studio, make_default_layer("adjust", "brush"), "union", "of",
                           std::move(drawn));
      return;
    }
    default:
      return;
  }
}

Document describe_inspected(const Studio& studio) {
  const double pitch = studio.snapshot->after.pixel_pitch_mm;
  Document from{Document::Object{}};
  set(from, "at",
      Document::Array{(studio.inspected.x + 0.5) * pitch, (studio.inspected.y + 0.5) * pitch});
  return from;
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

Document make_starting_layer(const Studio& studio, const std::string& operation) {
  Document layer = make_default_layer(operation, operation);
  if (studio.snapshot == nullptr) throw_needs(operation, "a map to be open");
  if (operation == "blend") {
    if (!studio.picked) throw_needs(operation, "a profile, picked with the eyedropper first,");
    set(layer, "from", describe_picked(*studio.picked));
    set(layer, "opacity", 0.5);
  } else if (operation == "paste") {
    if (!studio.stamp_source) throw_needs(operation, "a rectangle, dragged with the stamp first,");
    const EditState& state = studio.snapshot->after;
    return make_stamp_layer(*studio.stamp_source, {0.5 * state.width * state.pixel_pitch_mm,
                                                   0.5 * state.height * state.pixel_pitch_mm});
  } else if (operation == "interpolate") {
    throw_needs(operation, "a scribble first, which it then spreads (write its strokes as text)");
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
  add_layer(studio, std::move(layer));
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
  if (!changes) return add_layer(studio, std::move(changed));
  studio.editor->post("shape curve", set_layer(*studio.selected_layer, std::move(changed)),
                      fmt::format("shape {} {}", *studio.selected_layer, studio.drags));
  touch_map(studio);
}

}  // namespace parian

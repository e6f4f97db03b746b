#include "app/studio/strokes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "app/studio/tools.h"

namespace parian {
namespace {

Document::Array to_points(const StrokeLine& line) {
  Document::Array array;
  array.reserve(line.size());
  for (const auto& point : line) array.emplace_back(Document::Array{point[0], point[1]});
  return array;
}

// Points closer than a quarter of a pixel add nothing.
std::vector<StrokeLine> thin_out(const std::vector<StrokeLine>& lines, double least) {
  std::vector<StrokeLine> kept;
  kept.reserve(lines.size());
  for (const StrokeLine& line : lines) {
    StrokeLine points;
    points.reserve(line.size());
    for (const auto& point : line)
      if (points.empty() ||
          std::hypot(point[0] - points.back()[0], point[1] - points.back()[1]) >= least)
        points.push_back(point);
    kept.push_back(std::move(points));
  }
  return kept;
}

Document::Array make_brushes(const std::vector<StrokeLine>& lines, double radius) {
  Document::Array strokes;
  for (const StrokeLine& line : lines) {
    Document stroke{Document::Object{}};
    set(stroke, "type", "stroke");
    set(stroke, "points", to_points(line));
    set(stroke, "radius", radius);
    strokes.push_back(std::move(stroke));
  }
  return strokes;
}

void append(Document& holder, const std::string& key, const Document::Array& strokes) {
  const Document* present = find(holder, key);
  Document::Array all = present != nullptr ? as_array(*present) : Document::Array{};
  all.insert(all.end(), strokes.begin(), strokes.end());
  set(holder, key, std::move(all));
}

Document make_selection(const std::string& type, const std::string& key, Document::Array strokes) {
  Document selection{Document::Object{}};
  set(selection, "type", type);
  set(selection, key, std::move(strokes));
  return selection;
}

// Adds strokes to the selected layer: to the selected part of its selection, or what holds that,
// when it has `type` and holds strokes under `key`.
bool append_to_selected(Studio& studio, const std::string& type, const std::string& key,
                        const Document::Array& strokes) {
  const LayerSnapshot* layer = selected_layer(studio);
  const Document* selection = layer != nullptr ? find(layer->source, "selection") : nullptr;
  if (selection == nullptr) return false;
  PartPath path = selected_part(studio);
  while (part_type(*find_part(*selection, path)) != type) {
    if (path.empty()) return false;
    path.pop_back();
  }
  Document changed = layer->source, whole = *selection, part = *find_part(*selection, path);
  append(part, key, strokes);
  set_part(whole, path, std::move(part));
  set(changed, "selection", std::move(whole));
  change_layer(studio, std::move(changed), "stroke on " + layer->name);
  return true;
}

// A layer on all of the map gets them as its selection.
bool select_by(Studio& studio, const std::string& type, const std::string& key,
               const Document::Array& strokes) {
  const LayerSnapshot* layer = selected_layer(studio);
  if (layer == nullptr || !takes_selection(layer->kind) || layer->kind == "interpolate" ||
      find(layer->source, "selection") != nullptr)
    return false;
  Document changed = layer->source;
  set(changed, "selection", make_selection(type, key, strokes));
  change_layer(studio, std::move(changed), "stroke on " + layer->name);
  return true;
}

void add_with_selection(Studio& studio, Document layer, const std::string& type,
                        const std::string& key, const Document::Array& strokes) {
  set(layer, "selection", make_selection(type, key, strokes));
  add_layer(studio, layer);
}

// A layer `interpolate` has strokes of its own.
bool scribble_into_layer(Studio& studio, const Document::Array& strokes) {
  const LayerSnapshot* layer = selected_layer(studio);
  if (layer == nullptr || layer->kind != "interpolate") return false;
  Document changed = layer->source;
  append(changed, "strokes", strokes);
  studio.selected_stroke = as_array(get(changed, "strokes")).size() - 1;
  change_layer(studio, std::move(changed), "stroke on " + layer->name);
  return true;
}

void scribble(Studio& studio, const std::vector<StrokeLine>& lines, bool positive) {
  const Document::Array strokes = make_scribbles(lines, studio.brush_radius_mm, positive);
  if (scribble_into_layer(studio, strokes)) return;
  if (append_to_selected(studio, "propagate", "strokes", strokes)) return;
  if (!positive)
    return report(studio, "draw a stroke with 'scribble +' first: this one says what stays", true);
  if (select_by(studio, "propagate", "strokes", strokes)) return;
  add_with_selection(studio, make_default_layer("adjust", "scribble"), "propagate", "strokes",
                     strokes);
}

void brush(Studio& studio, const std::vector<StrokeLine>& lines) {
  const Document::Array strokes = make_brushes(lines, studio.brush_radius_mm);
  if (append_to_selected(studio, "union", "of", strokes)) return;
  if (select_by(studio, "union", "of", strokes)) return;
  add_with_selection(studio, make_default_layer("adjust", "brush"), "union", "of", strokes);
}

void paint(Studio& studio, const std::vector<StrokeLine>& lines) {
  if (!studio.picked)
    return report(studio, "pick a profile with the tool 'pick' first: it is what paint is made of",
                  true);
  const Document::Array strokes = make_brushes(lines, studio.brush_radius_mm);
  Document from = describe_picked(*studio.picked);
  const LayerSnapshot* layer = selected_layer(studio);
  const Document* present =
      layer != nullptr && layer->kind == "blend" ? find(layer->source, "from") : nullptr;
  if (present != nullptr && is_same_value(*present, from) &&
      append_to_selected(studio, "union", "of", strokes))
    return;
  Document painted = make_default_layer("blend", "paint");
  set(painted, "from", std::move(from));
  add_with_selection(studio, std::move(painted), "union", "of", strokes);
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

}  // namespace

Document describe_picked(const PickedProfile& picked) {
  Document from{Document::Object{}};
  if (!picked.map.empty()) set(from, "map", picked.map);
  set(from, "at", Document::Array{picked.at_mm[0], picked.at_mm[1]});
  return from;
}

Document describe_stamp(const StampSource& source) {
  Document from{Document::Object{}};
  if (!source.map.empty()) set(from, "map", source.map);
  set(from, "min", Document::Array{source.box_mm[0], source.box_mm[1]});
  set(from, "max", Document::Array{source.box_mm[2], source.box_mm[3]});
  return from;
}

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

Document::Array make_scribbles(const std::vector<StrokeLine>& lines, double radius, bool positive) {
  Document::Array strokes;
  for (const StrokeLine& line : lines) {
    Document stroke{Document::Object{}};
    set(stroke, "points", to_points(line));
    set(stroke, "radius", radius);
    if (!positive) set(stroke, "positive", false);
    strokes.push_back(std::move(stroke));
  }
  return strokes;
}

void apply_stroke(Studio& studio, const Stroke& stroke) {
  if (stroke.tool == Tool::stamp) return stamp(studio, stroke);
  if (stroke.on_second)
    return report(studio, "the second material only gives: pick from it, or stamp", true);
  const auto lines = thin_out(stroke.lines, 0.25 * studio.snapshot->after.pixel_pitch_mm);
  switch (stroke.tool) {
    case Tool::scribble_plus:
      return scribble(studio, lines, true);
    case Tool::scribble_minus:
      return scribble(studio, lines, false);
    case Tool::paint:
      return paint(studio, lines);
    case Tool::brush:
      return brush(studio, lines);
    case Tool::select:
      return select_places(studio, stroke);
    default:
      return;
  }
}

}  // namespace parian

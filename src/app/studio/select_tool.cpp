// The tool `select`: a drag on the map gives the selected part of the selection its places.
#include <cmath>
#include <utility>

#include "app/studio/strokes.h"
#include "app/studio/tools.h"

namespace parian {
namespace {

void post_selection(Studio& studio, const LayerSnapshot& layer, Document selection) {
  Document changed = layer.source;
  set(changed, "selection", std::move(selection));
  change_layer(studio, std::move(changed), "selection of " + layer.name);
}

// A rectangle where the line was dragged; none where that has no area.
std::optional<Document> make_rectangle(const StrokeLine& line, const MapSize& size) {
  Document part{Document::Object{}};
  set(part, "type", "rectangle");
  const auto& [low, high] = std::pair(line.front(), line.back());
  if (low[0] == high[0] || low[1] == high[1]) return std::nullopt;
  place_part(part, {{{0, 0}, {1, 1}}});
  return draw_part(part, {low, high}, size) ? std::optional(part) : std::nullopt;
}

constexpr const char* needs_a_drag = "drag the tool 'select' across what shall be selected";

// Strokes spread over pixels: one more.
void add_scribble(Studio& studio, const LayerSnapshot& layer, Document selection,
                  const PartPath& path, const StrokeLine& line) {
  Document part = *find_part(selection, path);
  Document::Array strokes = as_array(get(part, "strokes"));
  for (Document& stroke : make_scribbles({line}, studio.brush_radius_mm, true))
    strokes.push_back(std::move(stroke));
  set(part, "strokes", std::move(strokes));
  set_part(selection, path, std::move(part));
  post_selection(studio, layer, std::move(selection));
}

void select_in(Studio& studio, const LayerSnapshot& layer, const StrokeLine& line) {
  const MapSize size = size_of(studio.snapshot->after);
  const Document* present = find(layer.source, "selection");
  if (present == nullptr) {
    if (auto part = make_rectangle(line, size))
      return post_selection(studio, layer, *std::move(part));
    return report(studio, needs_a_drag, true);
  }
  Document selection = *present;
  const PartPath path = selected_part(studio);
  Document part = *find_part(selection, path);
  const std::string type = part_type(part);
  if (type == "propagate") return add_scribble(studio, layer, selection, path, line);
  if (is_set(type)) {
    auto added = make_rectangle(line, size);
    if (!added) return report(studio, needs_a_drag, true);
    studio.part = add_part(selection, path, *std::move(added));
    return post_selection(studio, layer, std::move(selection));
  }
  if (!draw_part(part, line, size))
    return report(studio,
                  type == "all" || type == "image" || type == "threshold"
                      ? "a selection '" + type + "' has no place: choose another kind first"
                      : needs_a_drag,
                  true);
  set_part(selection, path, std::move(part));
  post_selection(studio, layer, std::move(selection));
}

}  // namespace

void select_places(Studio& studio, const Stroke& stroke) {
  const StrokeLine& line = stroke.lines.front();
  const LayerSnapshot* layer = selected_layer(studio);
  if (layer != nullptr && takes_selection(layer->kind)) return select_in(studio, *layer, line);
  auto part = make_rectangle(line, size_of(studio.snapshot->after));
  if (!part) return report(studio, needs_a_drag, true);
  Document added = make_default_layer("adjust", "region");
  set(added, "selection", *std::move(part));
  add_layer(studio, added);
}

PartPath selected_part(const Studio& studio) {
  const LayerSnapshot* layer = selected_layer(studio);
  const Document* selection = layer != nullptr ? find(layer->source, "selection") : nullptr;
  if (selection == nullptr || find_part(*selection, studio.part) == nullptr) return {};
  return studio.part;
}

void grab_handle(Studio& studio, double x_mm, double y_mm, double reach_mm) {
  studio.grabbed.reset();
  const LayerSnapshot* layer = selected_layer(studio);
  const Document* selection = layer != nullptr ? find(layer->source, "selection") : nullptr;
  if (studio.tool != Tool::select || selection == nullptr) return;
  const std::vector<Place> handles =
      find_handles(*find_part(*selection, selected_part(studio)), size_of(studio.snapshot->after));
  double nearest = reach_mm;
  for (std::size_t i = 0; i < handles.size(); ++i)
    if (const double d = std::hypot(handles[i][0] - x_mm, handles[i][1] - y_mm); d <= nearest) {
      nearest = d;
      studio.grabbed = i;
    }
}

void drag_handle(Studio& studio, double x_mm, double y_mm) {
  const LayerSnapshot* layer = selected_layer(studio);
  const Document* present = layer != nullptr ? find(layer->source, "selection") : nullptr;
  if (!studio.grabbed || present == nullptr) return;
  Document selection = *present;
  const PartPath path = selected_part(studio);
  Document part = *find_part(selection, path);
  move_handle(part, *studio.grabbed, {x_mm, y_mm}, size_of(studio.snapshot->after));
  if (is_same_value(part, *find_part(selection, path))) return;
  set_part(selection, path, std::move(part));
  Document changed = layer->source;
  set(changed, "selection", std::move(selection));
  change_layer(studio, std::move(changed), "selection of " + layer->name,
               "handle " + std::to_string(*studio.grabbed) + " " + std::to_string(studio.drags));
}

}  // namespace parian

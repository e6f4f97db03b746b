#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "edit/propagation_source_internal.h"
#include "edit/session.h"
#include "image/color_spaces.h"
#include "material/material.h"

namespace parian {
namespace {

constexpr std::size_t max_appearances = 8;

const std::vector<std::string> distance_names{"profile", "log_profile", "properties", "perceptual",
                                              "bssrdf"};

std::vector<float> log_planes(const EditState& state) {
  const Plane albedo = albedo_plane(state), range = range_plane(state);
  std::vector<float> values;
  values.reserve(2 * albedo.size());
  for (const Plane* plane : {&albedo, &range})
    for (double value : *plane) values.push_back(static_cast<float>(std::log(value)));
  return values;
}

std::vector<float> lab_pixels(const EditState& state) {
  const Plane albedo = albedo_plane(state);
  std::vector<float> values;
  values.reserve(3 * state.pixels());
  for (std::size_t i = 0; i < state.pixels(); ++i) {
    Color rgb;
    for (std::size_t c = 0; c < 3; ++c)
      rgb[c] = albedo[(state.channels == 3 ? c * state.pixels() : 0) + i];
    for (double value : linear_to_lab(rgb)) values.push_back(static_cast<float>(value));
  }
  return values;
}

Features make_raw_features(const PropagationSource& source, const EditState& state) {
  if (!source.open_table) {
    const Material material = make_profile_map(state);
    return make_bssrdf_features(*make_slices(material, natural_header(material)));
  }
  const std::unique_ptr<SliceSource> table = source.open_table();
  if (table->header().width != state.width || table->header().height != state.height)
    throw_at(get(source.settings, "table"),
             fmt::format("a table of {} x {} pixels, as the map", state.width, state.height),
             fmt::format("{} x {}", table->header().width, table->header().height));
  return make_bssrdf_features(*table);
}

Features make_source_features(const PropagationSource& source, const EditState& state) {
  switch (source.distance) {
    case Distance::profile:
      return make_profile_features(make_profile_map(state));
    case Distance::log_profile:
      return make_log_profile_features(make_profile_map(state));
    case Distance::properties:
      return make_property_features(state.width, state.height, 2 * state.channels,
                                    log_planes(state));
    case Distance::perceptual:
      return make_features(state.width, state.height, 3, lab_pixels(state));
    case Distance::bssrdf:
      break;
  }
  return make_raw_features(source, state);
}

// Which pixels each stroke covers; an Error for one that covers none.
std::vector<StrokePixel> find_stroke_pixels(const PropagationSource& source, const Grid& grid) {
  std::vector<StrokePixel> pixels;
  for (std::size_t s = 0; s < source.strokes.size(); ++s) {
    const Stroke& stroke = source.strokes[s];
    Mask mask = make_mask(grid.width, grid.height, 0);
    std::vector<Point2> points;
    points.reserve(stroke.points.size());
    for (const Point2& point : stroke.points) points.push_back(to_pixels(point, stroke.unit, grid));
    // At least wide enough to cover the centres of the pixels that it crosses.
    draw_stroke(mask, points, std::max(0.75, length_to_pixels(stroke.radius, stroke.unit, grid)),
                1);
    if (is_empty(mask))
      throw_at(stroke.node,
               fmt::format("a stroke that meets the map of {:.6g} x {:.6g} mm",
                           grid.width * grid.pixel_pitch_mm, grid.height * grid.pixel_pitch_mm),
               "one outside");
    for (std::size_t i = 0; i < mask.weight.size(); ++i)
      if (mask.weight[i] > 0)
        pixels.push_back({static_cast<std::uint32_t>(i), mask.weight[i], static_cast<int>(s)});
  }
  return pixels;
}

Propagation run(const PropagationSource& source, const SelectionContext& context, bool rest) {
  const Grid grid = grid_of(context.frame);
  const std::vector<StrokePixel> pixels = find_stroke_pixels(source, grid);
  const Appearance appearance = get_appearance(source, context, !source.all_pairs);
  const int strokes = static_cast<int>(source.strokes.size());
  if (source.all_pairs)
    return propagate_all_pairs(*appearance.features, pixels, strokes, source.dense);
  PropagateParams params = source.sparse;
  params.rest = rest;
  return propagate(*appearance.graph, *appearance.features, pixels, strokes, params);
}

ParamList describe_appearance(PropagationSource& source) {
  return {{.name = "distance",
           .help = "what makes pixels alike",
           .target = make_choice(source.distance, distance_names)},
          describe_state(source.uses_input)};
}

Param describe_method(PropagationSource& source) {
  return {.name = "method",
          .help = "sparse: a graph of the nearest in appearance; all_pairs: all pixels with some",
          .target = make_choice_of_two(source.all_pairs, {"sparse", "all_pairs"})};
}

bool all_positive(const PropagationSource& source) {
  return std::all_of(source.strokes.begin(), source.strokes.end(),
                     [](const Stroke& stroke) { return stroke.positive; });
}

}  // namespace

std::vector<std::string> appearance_keys(std::vector<std::string> own) {
  for (const char* key : {"distance", "table", "state"}) own.emplace_back(key);
  return own;
}

const std::vector<std::string>& stroke_keys() {
  static const std::vector<std::string> keys{"points", "radius", "unit", "positive"};
  return keys;
}

std::vector<std::string> propagation_keys(std::vector<std::string> own) {
  PropagationSource defaults;
  own = appearance_keys(std::move(own));
  own.emplace_back("method");
  own = keys_of(describe(defaults.graph), std::move(own));
  own = keys_of(describe(defaults.sparse), std::move(own));
  for (const std::string& key : keys_of(describe(defaults.dense)))
    if (std::find(own.begin(), own.end(), key) == own.end()) own.push_back(key);
  return own;
}

OperationKind::Params make_propagation_params() {
  const auto source = std::make_shared<PropagationSource>();
  ParamList list = describe_appearance(*source);
  list.push_back(describe_method(*source));
  for (const ParamList& more :
       {describe(source->sparse), describe(source->graph), describe(source->dense)})
    for (const Param& param : more)
      if (std::none_of(list.begin(), list.end(),
                       [&](const Param& known) { return known.name == param.name; }))
        list.push_back(param);
  return {source, std::move(list)};
}

OperationKind::Params make_similar_params() {
  const auto source = std::make_shared<PropagationSource>();
  ParamList list = describe_appearance(*source);
  list.push_back(describe(source->sparse).front());  // sigma
  return {source, std::move(list)};
}

PropagationSource read_appearance(const Document& object, RecipeResources& resources) {
  PropagationSource source;
  source.settings = Document(Document::Object{});
  read_numbers(object, describe_appearance(source));
  if (const Document* node = find(object, "distance")) set(source.settings, "distance", *node);
  if (const Document* node = find(object, "table")) {
    if (source.distance != Distance::bssrdf)
      throw_at(*node, "the key 'table' only beside the distance 'bssrdf'", "it here");
    open_table(resources.loaders, *node);  // so that a missing file is told now
    set(source.settings, "table", *node);
    source.open_table = [loaders = resources.loaders, node = *node] {
      return open_table(loaders, node);
    };
  }
  return source;
}

PropagationSource read_propagation(const Document& object, const Document& strokes,
                                   RecipeResources& resources,
                                   const std::function<void(const Document& stroke)>& read_more) {
  PropagationSource source = read_appearance(object, resources);
  // Keys of the other method are ignored, so that a layer can change its method.
  for (const ParamList& params : {ParamList{describe_method(source)}, describe(source.graph),
                                  describe(source.sparse), describe(source.dense)})
    read_numbers(object, params);
  set(source.settings, "neighbours", source.graph.neighbours);
  if (as_array(strokes).empty()) throw_at(strokes, "at least one stroke", "none");
  for (const Document& node : as_array(strokes)) {
    Stroke stroke;
    stroke.node = node;
    stroke.unit = read_unit(node);
    stroke.points = read_points(get(node, "points"), 1);
    if (const Document* radius = find(node, "radius")) stroke.radius = read_length(*radius, 0);
    if (const Document* positive = find(node, "positive")) stroke.positive = as_bool(*positive);
    read_more(node);
    source.strokes.push_back(std::move(stroke));
  }
  return source;
}

Appearance get_appearance(const PropagationSource& source, const SelectionContext& context,
                          bool needs_graph) {
  const EditState& state = source.uses_input ? context.input : context.frame;
  auto& known = context.cache.appearances;
  auto entry = std::find_if(known.begin(), known.end(), [&](const auto& item) {
    return is_same_state(item.state, state) && is_same_value(item.settings, source.settings);
  });
  if (entry == known.end()) {
    advance_progress(context.progress, "appearance", 0);
    auto features = std::make_shared<const Features>(make_source_features(source, state));
    if (known.size() >= max_appearances) known.erase(known.begin());
    known.push_back({state, source.settings, {std::move(features), nullptr}});
    entry = known.end() - 1;
  }
  if (needs_graph && !entry->appearance.graph) {
    advance_progress(context.progress, "neighbours", 0);
    entry->appearance.graph = std::make_shared<const NeighbourGraph>(
        make_neighbour_graph(*entry->appearance.features, source.graph));
  }
  return entry->appearance;
}

Mask propagate_strokes(const PropagationSource& source, const SelectionContext& context) {
  std::vector<bool> positive;
  positive.reserve(source.strokes.size());
  for (const Stroke& stroke : source.strokes) positive.push_back(stroke.positive);
  const Propagation found = run(source, context, all_positive(source));
  return {context.frame.width, context.frame.height, normalise_indicators(found, positive)};
}

std::vector<Mask> propagate_each(const PropagationSource& source, const SelectionContext& context) {
  // A stroke that is not positive keeps what is there; without one, the rest of the map does.
  const bool rest = all_positive(source);
  const Propagation found = run(source, context, rest);
  std::vector<Mask> masks;
  masks.reserve(source.strokes.size());
  const std::size_t pixels = context.frame.pixels();
  for (std::size_t s = 0; s < source.strokes.size(); ++s) {
    Mask mask = make_mask(context.frame.width, context.frame.height, 0);
    for (std::size_t i = 0; i < pixels; ++i) {
      float sum = 0;
      for (std::size_t t = 0; t < source.strokes.size(); ++t)
        sum += found.indicators[t * pixels + i];
      if (source.strokes[s].positive && sum > 0)
        mask.weight[i] = found.indicators[s * pixels + i] / (rest ? std::max(1.0f, sum) : sum);
    }
    masks.push_back(std::move(mask));
  }
  return masks;
}

}  // namespace parian

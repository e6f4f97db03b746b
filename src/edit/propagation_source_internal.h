// Strokes in recipes: what is common to the selection "propagate" and the operation "interpolate".
#pragma once

#include <functional>

#include "edit/propagate.h"
#include "edit/propagate_all_pairs.h"
#include "edit/read_parts_internal.h"
#include "edit/selection_cache.h"

namespace parian {

// What makes pixels alike.
enum class Distance { profile, log_profile, properties, perceptual, bssrdf };

struct Stroke {
  Document node;
  std::vector<Point2> points;
  double radius = 0;
  Unit unit = Unit::mm;
  bool positive = true;
};

struct PropagationSource {
  Document settings;  // what the appearance depends on
  Distance distance = Distance::profile;
  std::function<std::unique_ptr<SliceSource>()> open_table;  // for bssrdf; empty: the map itself
  bool uses_input = false;                                   // of "current", else of the frame
  bool all_pairs = false;
  GraphParams graph;
  PropagateParams sparse;
  AllPairsParams dense;
  std::vector<Stroke> strokes;
};

// "distance", "table", "state", "method" and the plain numbers of the solvers.
PropagationSource read_appearance(const Document& object, RecipeResources& resources);
std::vector<std::string> appearance_keys(std::vector<std::string> own = {});
// The same with an array of strokes, each {"points": ..., "radius": ..., "unit": ...} and what
// `read_more` reads of it.
PropagationSource read_propagation(const Document& object, const Document& strokes,
                                   RecipeResources& resources,
                                   const std::function<void(const Document& stroke)>& read_more);
const std::vector<std::string>& stroke_keys();
std::vector<std::string> propagation_keys(std::vector<std::string> own = {});
OperationKind::Params make_propagation_params();
OperationKind::Params make_similar_params();

// The features that the distance asks for, from the cache or new; with the graph where asked.
Appearance get_appearance(const PropagationSource& source, const SelectionContext& context,
                          bool needs_graph);

// Positive against negative strokes.
Mask propagate_strokes(const PropagationSource& source, const SelectionContext& context);
// One mask for each stroke, at most 1 together.
std::vector<Mask> propagate_each(const PropagationSource& source, const SelectionContext& context);

}  // namespace parian

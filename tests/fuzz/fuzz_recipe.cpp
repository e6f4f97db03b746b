// Mutated recipes, read and, where they keep the grid, applied to a small map.
#include <cmath>
#include <stdexcept>

#include "edit/session.h"
#include "fuzz_case.h"
#include "io/json/json.h"

namespace parian::fuzz {
namespace {

const char* const text = R"({"format": "parian-recipe", "version": 1, "layers": [
{"operation": "adjust", "name": "a", "opacity": 0.5, "albedo_scale": [1, 2, 0.5], "hue_deg": 20,
 "range_offset_mm": 0.5, "selection": {"type": "union", "feather": 0.3, "grow": -0.5, "of": [
   {"type": "rectangle", "min": [0, 0], "max": [2, 1]},
   {"type": "ellipse", "center": [0.5, 0.5], "radii": [0.2, 0.3], "unit": "relative"},
   {"type": "stroke", "points": [[1, 1], [2, 2]], "radius": 0.5, "hardness": 0.2}]}},
{"operation": "interpolate", "distance": "properties", "strokes": [
   {"points": [[0, 0]], "range_scale": 0.5}, {"points": [[2, 2]], "positive": false}]},
{"operation": "shape", "falloff": 1.5, "scale": [[0, 1], [0.5, 2]], "offset": [[0, 0.1], [1, 0]]},
{"operation": "blend", "from": {"map": "other.h5", "at": [1, 1]}, "shape": 0.5,
 "selection": {"type": "similar", "at": [1, 1], "distance": "perceptual", "sigma": 0.3}},
{"operation": "paste", "from": {"image": "x.png", "pixel_pitch_mm": 0.7}, "to": [1, 1],
 "rotation_deg": 30, "mixed": true, "selection": {"type": "gradient", "from": [0, 0], "to": [2, 2]}},
{"operation": "filter", "kind": "bilateral", "sigma_mm": 0.6, "shape": true,
 "selection": {"type": "threshold", "property": "range", "low": 0.1, "softness": 1}},
{"operation": "monotone"}, {"operation": "bound_energy", "iterations": 1},
{"operation": "crop", "min": [0, 0], "max": [2, 2]}, {"operation": "tile", "nx": 2},
{"operation": "rotate", "degrees": 30}, {"operation": "resample", "pixel_pitch_mm": 0.4},
{"operation": "synthesize", "width_px": 20, "height_px": 10},
{"operation": "hallucinate", "photograph": "x.png", "deblur": 1, "pins": [
   {"at": [0.5, 0.5], "from": {"at": [1, 1]}}]}]})";

ProfileMap make_small_map() {
  ProfileMap map = make_profile_map(6, 5, 3, 0.5, {0, 0.5, 1.5});
  for (std::size_t i = 0; i < map.log_profile.size(); ++i)
    map.log_profile[i] = -static_cast<float>(i / 30 % 3) - 0.01f * static_cast<float>(i % 30);
  return map;
}

}  // namespace

void fuzz_recipe(Case& c) {
  static const Document recipe = parse_document(text, "fuzz.json");
  // One layer at a time, so that each is reached.
  Document document = recipe;
  auto& layers =
      std::get<Document::Array>(std::get<Document::Object>(document.value).back().second.value);
  layers = {c.pick(layers)};
  c.note(as_string(get(layers[0], "operation")));
  for (std::size_t edits = 1 + c.below(3); edits > 0; --edits) mutate_document(c, document);
  RecipeLoaders loaders;
  loaders.load_map = [](const std::string&) { return make_small_map(); };
  loaders.load_image = [](const std::string&) { return make_image(5, 4, 3, 0.5f); };
  EditSession session = make_edit_session(make_small_map(), loaders);
  set_recipe(session, document);
  // Large grids are a matter of limits, not of reading: they would only take long here.
  for (const auto& layer : session.recipe.layers)
    if (layer->operation.changes_grid) return;
  const EditState state = evaluate(session);
  check(make_profile_map(state), "edited");
}

}  // namespace parian::fuzz

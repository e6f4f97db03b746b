// An editing session: a map, its recipe, what the layers made of it, undo and redo. The desktop
// editor and `parian edit` sit on it.
#pragma once

#include <optional>

#include "edit/recipe.h"

namespace parian {

// What a layer did, kept for as long as there is room: a change in one layer computes only what
// comes after it, and undo finds what was there before.
struct LayerResult {
  std::shared_ptr<const Layer> layer;
  EditState input, frame;  // as it was computed from
  EditState output;
  std::shared_ptr<const Mask> mask;  // selection times opacity
  EditReport report;
  std::uint64_t last_use = 0;
};

struct EditSession {
  EditState original;
  Recipe recipe;
  std::vector<Recipe> undone, done;  // what redo and undo go back to
  RecipeResources resources;
  std::shared_ptr<SelectionCache> selections;
  std::vector<LayerResult> results;
  std::size_t max_bytes = std::size_t{1} << 30u;  // of results; those of the recipe stay anyway
  std::uint64_t uses = 0;
};

EditSession make_edit_session(const ProfileMap& map, RecipeLoaders loaders);

// The next recipe; the present one can be undone to, and what was undone is forgotten. With
// `merge` the present one is replaced without an entry of its own, as while a slider is dragged.
void set_recipe(EditSession& session, Recipe recipe, bool merge = false);
// The same from a document; throws Error and changes nothing when it is wrong.
void set_recipe(EditSession& session, const Document& document, bool merge = false);

// False: nothing to undo, or redo.
bool undo(EditSession& session);
bool redo(EditSession& session);

// The map with all layers that are on, up to layer `count` where given. Errors name the recipe's
// file and the layer. The same bits whatever was computed before. A layer that fails or is
// cancelled leaves the session as it was.
EditState evaluate(EditSession& session, const Progress& progress = {},
                   std::optional<std::size_t> count = std::nullopt);

// What layer `index` selects (times opacity) and gave up, from the last evaluation that reached
// it; null when none did.
const LayerResult* find_result(const EditSession& session, std::size_t index);

// The layers with one of them replaced, inserted, removed or moved.
Recipe with_layer(EditSession& session, std::size_t index, const Document& layer);
Recipe with_new_layer(EditSession& session, std::size_t index, const Document& layer);
Recipe without_layer(const EditSession& session, std::size_t index);
Recipe with_moved_layer(const EditSession& session, std::size_t from, std::size_t to);

// Planes of one state that another does not share, in bytes.
std::size_t own_bytes(const EditState& state, const EditState& other);
// The same planes: not a comparison of values.
bool is_same_state(const EditState& a, const EditState& b);

}  // namespace parian

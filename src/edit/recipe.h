// Edit recipes: ordered, named layers of operation, selection, opacity and on/off, read from
// documents (docs/editing.md, data/schema/recipe.schema.json). A recipe holds no pixels of the map
// that it is applied to, so it serves other materials too.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/document.h"
#include "base/progress.h"
#include "edit/edit_state.h"
#include "image/image.h"
#include "material/slices.h"

namespace parian {

// What a recipe refers to by path, as written in it; io and app supply them. Each throws Error
// naming the file.
struct RecipeLoaders {
  std::function<ProfileMap(const std::string& path)> load_map;
  std::function<Image(const std::string& path)> load_image;
  std::function<std::unique_ptr<SliceSource>(const std::string& path)> load_table;
};

// Loads each file once.
struct RecipeResources {
  RecipeLoaders loaders;
  std::map<std::string, std::shared_ptr<const EditState>> maps;
  std::map<std::string, std::shared_ptr<const Image>> images;
};
// The file that a string node names; errors carry the node's place.
std::shared_ptr<const EditState> get_map(RecipeResources& resources, const Document& node);
std::shared_ptr<const Image> get_image(RecipeResources& resources, const Document& node);
std::unique_ptr<SliceSource> open_table(const RecipeLoaders& loaders, const Document& node);

// What expensive parts of selections share between layers and runs; see selection.cpp.
struct SelectionCache;

struct SelectionContext {
  const EditState& frame;  // the map as it was when it got its present grid
  const EditState& input;  // as it is before the layer
  SelectionCache& cache;
  const Progress& progress;
};

// A mask as a function of the map.
struct Selection {
  Document source;
  bool uses_input = false;  // else only the frame
  std::function<Mask(const SelectionContext&)> make;
};

struct LayerContext {
  const EditState& frame;
  const EditState& input;
  const Mask& mask;  // selection times opacity
  SelectionCache& cache;
  EditReport& report;
  const Progress& progress;
};

struct Operation {
  bool changes_grid = false;  // then it takes the whole map: no selection, no opacity
  std::function<EditState(const LayerContext&)> apply;
};

struct Layer {
  Document source;  // the whole layer
  std::string name;
  std::string kind;  // the operation's name
  bool enabled = true;
  double opacity = 1;
  Selection selection;
  Operation operation;
};

struct Recipe {
  Document source;  // without the layers
  std::vector<std::shared_ptr<const Layer>> layers;
};
inline constexpr std::size_t max_recipe_layers = 1000;

// Throws Error at the node that is wrong, with the layer's index in its JSON pointer. Layers that
// are the same as in `previous` are taken from there, which lets sessions recognise them.
Recipe read_recipe(const Document& document, RecipeResources& resources,
                   const Recipe* previous = nullptr);
// The document that read_recipe reads back to the same recipe.
Document write_recipe(const Recipe& recipe);

// One operation that layers may name. To add one: an op_....cpp with its make_..._operation, and a
// line in operations.cpp.
struct OperationKind {
  std::string name;
  std::string summary;
  std::vector<std::string> keys;  // of the layer, beyond those that all layers have
  std::function<Operation(const Document& layer, RecipeResources& resources)> read;
  // Its plain numbers with their defaults and ranges, for sliders: keeps `owner` alive.
  struct Params {
    std::shared_ptr<void> owner;
    ParamList list;
  };
  std::function<Params()> params;
};
const std::vector<OperationKind>& operation_kinds();

// The keys that every layer may have.
const std::vector<std::string>& layer_keys();

Selection read_selection(const Document& node, RecipeResources& resources);
// Selects all.
Selection make_whole_selection();

// One type of selection: its own keys, and its plain numbers for sliders.
struct SelectionKind {
  std::string name, summary;
  std::vector<std::string> keys;
  std::function<OperationKind::Params()> params;
};
const std::vector<SelectionKind>& selection_kinds();
// What every selection has beside "unit": "grow", "feather", "invert".
OperationKind::Params make_modifier_params();

// Same type and value all the way down; files and places do not matter.
bool is_same_value(const Document& a, const Document& b);

}  // namespace parian

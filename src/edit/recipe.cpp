#include "edit/recipe.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/check.h"
#include "base/error.h"
#include "edit/read_parts_internal.h"

namespace parian {
namespace {

// Loads by the node's string; what goes wrong is told at the node.
template <typename Load>
auto load_at(const Document& node, const Load& load) {
  const std::string& path = as_string(node);
  if (path.empty()) throw_at(node, "the name of a file", "an empty string");
  try {
    return load(path);
  } catch (const Error& error) {
    if (error.kind == ErrorKind::cancelled) throw;
    throw_at(node, "a file that can be read", error.what());
  }
}

template <typename T, typename Load>
std::shared_ptr<const T> get_once(std::map<std::string, std::shared_ptr<const T>>& known,
                                  const Document& node, const Load& load) {
  std::shared_ptr<const T>& entry = known[as_string(node)];
  if (!entry) entry = load_at(node, load);
  return entry;
}

std::shared_ptr<const Layer> read_layer(const Document& node, RecipeResources& resources) {
  auto layer = std::make_shared<Layer>();
  layer->source = node;
  as_object(node);
  std::vector<std::string> names;
  names.reserve(operation_kinds().size());
  for (const OperationKind& kind : operation_kinds()) names.push_back(kind.name);
  const OperationKind& kind = operation_kinds()[read_choice(get(node, "operation"), names)];
  check_layer_keys(node, kind.keys);
  layer->kind = kind.name;
  layer->name = kind.name;
  if (const Document* name = find(node, "name")) layer->name = as_string(*name);
  if (const Document* enabled = find(node, "enabled")) layer->enabled = as_bool(*enabled);
  if (const Document* opacity = find(node, "opacity")) layer->opacity = as_number(*opacity, 0, 1);
  if (const Document* text = find(node, "description")) as_string(*text);
  layer->operation = kind.read(node, resources);
  for (const char* key : {"selection", "opacity"})
    if (const Document* member = find(node, key); member && layer->operation.changes_grid)
      throw_at(*member, fmt::format("no '{}' beside the operation '{}'", key, kind.name), "one");
  const Document* selection = find(node, "selection");
  layer->selection =
      selection == nullptr ? make_whole_selection() : read_selection(*selection, resources);
  return layer;
}

std::shared_ptr<const Layer> find_same(const Recipe* recipe, const Document& node) {
  if (recipe == nullptr) return nullptr;
  for (const auto& layer : recipe->layers)
    if (is_same_value(layer->source, node)) return layer;
  return nullptr;
}

}  // namespace

std::shared_ptr<const EditState> get_map(RecipeResources& resources, const Document& node) {
  return get_once(resources.maps, node, [&](const std::string& path) {
    PARIAN_CHECK(resources.loaders.load_map != nullptr);
    return std::make_shared<const EditState>(make_edit_state(resources.loaders.load_map(path)));
  });
}

std::shared_ptr<const Image> get_image(RecipeResources& resources, const Document& node) {
  return get_once(resources.images, node, [&](const std::string& path) {
    PARIAN_CHECK(resources.loaders.load_image != nullptr);
    return std::make_shared<const Image>(resources.loaders.load_image(path));
  });
}

std::unique_ptr<SliceSource> open_table(const RecipeLoaders& loaders, const Document& node) {
  return load_at(node, [&](const std::string& path) {
    PARIAN_CHECK(loaders.load_table != nullptr);
    return loaders.load_table(path);
  });
}

const std::vector<std::string>& layer_keys() {
  static const std::vector<std::string> keys{"operation", "name",      "enabled",
                                             "opacity",   "selection", "description"};
  return keys;
}

Recipe read_recipe(const Document& document, RecipeResources& resources, const Recipe* previous) {
  check_keys(document, {"$schema", "format", "version", "description", "layers"});
  if (const Document* format = find(document, "format"))
    if (as_string(*format) != "parian-recipe") throw_at(*format, "'parian-recipe'");
  if (const Document* version = find(document, "version"); version && as_number(*version) != 1)
    throw_at(*version, "version 1");
  if (const Document* text = find(document, "description")) as_string(*text);
  Recipe recipe;
  recipe.source = document;
  std::erase_if(std::get<Document::Object>(recipe.source.value),
                [](const auto& member) { return member.first == "layers"; });
  const Document& layers = get(document, "layers");
  if (as_array(layers).size() > max_recipe_layers)
    throw_at(layers, fmt::format("at most {} layers", max_recipe_layers));
  recipe.layers.reserve(as_array(layers).size());
  for (const Document& node : as_array(layers)) {
    std::shared_ptr<const Layer> layer = find_same(previous, node);
    recipe.layers.push_back(layer ? std::move(layer) : read_layer(node, resources));
  }
  return recipe;
}

Document write_recipe(const Recipe& recipe) {
  Document document = recipe.source;
  Document::Array layers;
  layers.reserve(recipe.layers.size());
  for (const auto& layer : recipe.layers) layers.push_back(layer->source);
  set(document, "layers", std::move(layers));
  return document;
}

bool is_same_value(const Document& a, const Document& b) {
  if (a.value.index() != b.value.index()) return false;
  if (const auto* array = std::get_if<Document::Array>(&a.value)) {
    const auto& other = std::get<Document::Array>(b.value);
    return std::equal(array->begin(), array->end(), other.begin(), other.end(), is_same_value);
  }
  if (const auto* object = std::get_if<Document::Object>(&a.value)) {
    const auto& other = std::get<Document::Object>(b.value);
    return std::equal(object->begin(), object->end(), other.begin(), other.end(),
                      [](const auto& x, const auto& y) {
                        return x.first == y.first && is_same_value(x.second, y.second);
                      });
  }
  if (const auto* number = std::get_if<double>(&a.value))
    return *number == std::get<double>(b.value);
  if (const auto* text = std::get_if<std::string>(&a.value))
    return *text == std::get<std::string>(b.value);
  if (const auto* flag = std::get_if<bool>(&a.value)) return *flag == std::get<bool>(b.value);
  return true;
}

}  // namespace parian

#include "edit/session.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/check.h"
#include "base/error.h"
#include "edit/selection_cache.h"

namespace parian {
namespace {

// Layers that the evaluation has reached share what comes out of them.
struct Step {
  EditState frame, input;
};

LayerResult* find_result(EditSession& session, const Layer* layer, const Step& step) {
  for (LayerResult& result : session.results)
    if (result.layer.get() == layer && is_same_state(result.input, step.input) &&
        is_same_state(result.frame, step.frame))
      return &result;
  return nullptr;
}

// Says which layer of which recipe an error belongs to, unless it does so itself.
[[noreturn]] void throw_in_layer(const Error& error, const Layer& layer, std::size_t index) {
  const std::string file = layer.source.file ? *layer.source.file : std::string();
  if (error.kind == ErrorKind::cancelled || error.kind == ErrorKind::contract) throw error;
  ErrorParts parts = error.parts;
  const std::string place = fmt::format("layer {} ('{}')", index + 1, layer.name);
  if (!parts.file.empty() && parts.file != file) parts.found = parts.file + ": " + parts.found;
  parts.file = file;
  parts.place = parts.place.empty() || parts.place == "/" ? place : place + ", " + parts.place;
  throw Error(parts, error.kind);
}

LayerResult run_layer(EditSession& session, const std::shared_ptr<const Layer>& layer,
                      const Step& step, const Progress& progress) {
  LayerResult result{.layer = layer, .input = step.input, .frame = step.frame};
  Mask mask;
  if (!layer->operation.changes_grid) {
    mask = scale(layer->selection.make({step.frame, step.input, *session.selections, progress}),
                 layer->opacity);
    if (is_empty(mask) && layer->opacity > 0)
      throw Error({.place = "selection",
                   .expected = "a selection of at least one pixel",
                   .found = "an empty one"});
  }
  result.output = layer->operation.apply(
      {step.frame, step.input, mask, *session.selections, result.report, progress});
  result.mask = std::make_shared<const Mask>(std::move(mask));
  return result;
}

// Forgets what was used longest ago, but for results of the present recipe.
void trim(EditSession& session, std::uint64_t keep_since) {
  const auto bytes_of = [](const LayerResult& result) {
    return own_bytes(result.output, result.input) + result.mask->weight.size() * sizeof(float);
  };
  std::size_t bytes = 0;
  for (const LayerResult& result : session.results) bytes += bytes_of(result);
  while (bytes > session.max_bytes) {
    const auto oldest = std::min_element(
        session.results.begin(), session.results.end(),
        [](const LayerResult& a, const LayerResult& b) { return a.last_use < b.last_use; });
    if (oldest == session.results.end() || oldest->last_use >= keep_since) return;
    bytes -= bytes_of(*oldest);
    session.results.erase(oldest);
  }
}

Recipe take(std::vector<Recipe>& stack) {
  Recipe recipe = std::move(stack.back());
  stack.pop_back();
  return recipe;
}

}  // namespace

EditSession make_edit_session(const ProfileMap& map, RecipeLoaders loaders) {
  EditSession session;
  session.original = make_edit_state(map);
  session.resources.loaders = std::move(loaders);
  session.selections = std::make_shared<SelectionCache>();
  return session;
}

void set_recipe(EditSession& session, Recipe recipe, bool merge) {
  if (!merge) session.done.push_back(std::move(session.recipe));
  session.recipe = std::move(recipe);
  session.undone.clear();
}

void set_recipe(EditSession& session, const Document& document, bool merge) {
  set_recipe(session, read_recipe(document, session.resources, &session.recipe), merge);
}

bool undo(EditSession& session) {
  if (session.done.empty()) return false;
  session.undone.push_back(std::move(session.recipe));
  session.recipe = take(session.done);
  return true;
}

bool redo(EditSession& session) {
  if (session.undone.empty()) return false;
  session.done.push_back(std::move(session.recipe));
  session.recipe = take(session.undone);
  return true;
}

EditState evaluate(EditSession& session, const Progress& progress,
                   std::optional<std::size_t> count) {
  const std::size_t end = std::min(count.value_or(max_recipe_layers), session.recipe.layers.size());
  const std::uint64_t start = ++session.uses;
  Step step{session.original, session.original};
  for (std::size_t i = 0; i < end; ++i) {
    const std::shared_ptr<const Layer>& layer = session.recipe.layers[i];
    if (!layer->enabled) continue;
    LayerResult* result = find_result(session, layer.get(), step);
    if (result == nullptr) {
      try {
        advance_progress(progress, layer->name, static_cast<double>(i) / static_cast<double>(end));
        session.results.push_back(run_layer(session, layer, step, progress));
      } catch (const Error& error) {
        throw_in_layer(error, *layer, i);
      }
      result = &session.results.back();
    }
    result->last_use = ++session.uses;
    step.input = result->output;
    if (layer->operation.changes_grid) step.frame = result->output;
  }
  trim(session, start);
  return step.input;
}

const LayerResult* find_result(const EditSession& session, std::size_t index) {
  PARIAN_CHECK_LT(index, session.recipe.layers.size());
  const LayerResult* latest = nullptr;
  for (const LayerResult& result : session.results)
    if (result.layer == session.recipe.layers[index] &&
        (latest == nullptr || result.last_use > latest->last_use))
      latest = &result;
  return latest;
}

Recipe with_new_layer(EditSession& session, std::size_t index, const Document& layer) {
  PARIAN_CHECK_LE(index, session.recipe.layers.size());
  Document document = write_recipe(session.recipe);
  auto& layers = std::get<Document::Array>(const_cast<Document&>(get(document, "layers")).value);
  layers.insert(layers.begin() + static_cast<std::ptrdiff_t>(index), layer);
  return read_recipe(document, session.resources, &session.recipe);
}

Recipe with_layer(EditSession& session, std::size_t index, const Document& layer) {
  PARIAN_CHECK_LT(index, session.recipe.layers.size());
  Document document = write_recipe(session.recipe);
  auto& layers = std::get<Document::Array>(const_cast<Document&>(get(document, "layers")).value);
  layers[index] = layer;
  return read_recipe(document, session.resources, &session.recipe);
}

Recipe without_layer(const EditSession& session, std::size_t index) {
  PARIAN_CHECK_LT(index, session.recipe.layers.size());
  Recipe recipe = session.recipe;
  recipe.layers.erase(recipe.layers.begin() + static_cast<std::ptrdiff_t>(index));
  return recipe;
}

Recipe with_moved_layer(const EditSession& session, std::size_t from, std::size_t to) {
  PARIAN_CHECK_LT(to, session.recipe.layers.size());
  Recipe recipe = without_layer(session, from);
  recipe.layers.insert(recipe.layers.begin() + static_cast<std::ptrdiff_t>(to),
                       session.recipe.layers[from]);
  return recipe;
}

std::size_t own_bytes(const EditState& state, const EditState& other) {
  std::size_t bytes = 0;
  if (state.shapes != other.shapes)
    bytes += state.shapes->log_profile.size() * sizeof(float) + 2 * state.values() * sizeof(double);
  if (state.gain != other.gain) bytes += state.values() * sizeof(double);
  if (state.dilation != other.dilation) bytes += state.values() * sizeof(double);
  return bytes;
}

bool is_same_state(const EditState& a, const EditState& b) {
  return a.shapes == b.shapes && a.gain == b.gain && a.dilation == b.dilation &&
         a.width == b.width && a.height == b.height && a.pixel_pitch_mm == b.pixel_pitch_mm;
}

}  // namespace parian

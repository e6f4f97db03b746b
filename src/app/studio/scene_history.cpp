#include "app/studio/scene_history.h"

#include <algorithm>
#include <utility>

namespace parian {
namespace {

bool has_weights_of(const SurfaceMask& mask, const SurfaceMask& other) {
  const auto weights = [](const SurfaceMask& of) {
    return of.size() == 1 ? std::get_if<VertexMask>(&of.front().shape) : nullptr;
  };
  const VertexMask *one = weights(mask), *two = weights(other);
  return one == nullptr || (two != nullptr && one->weights == two->weights);
}

// As many before as after.
std::string label_of(const StageLayers& before, const StageLayers& after) {
  for (std::size_t i = 0; i < after.size(); ++i)
    if (before[i] != after[i] && before[i]->material == after[i]->material &&
        !has_weights_of(after[i]->mask, before[i]->mask))
      return "mask of " + after[i]->material_name;
  return "layer of the scene";
}

std::string label_of(const SceneState& before, const SceneState& after) {
  if (before.is_homogeneous != after.is_homogeneous)
    return after.is_homogeneous ? "homogeneous material" : "back to the map";
  if (!(before.homogeneous == after.homogeneous)) return "coefficients";
  if (before.exposure != after.exposure) return "exposure";
  if (before.layers.size() != after.layers.size())
    return before.layers.size() < after.layers.size() ? "add layer" : "remove layer";
  if (before.layers != after.layers) return label_of(before.layers, after.layers);
  if (before.lighting.size() != after.lighting.size())
    return before.lighting.size() < after.lighting.size() ? "add light" : "remove light";
  for (std::size_t i = 0; i < after.lighting.size(); ++i)
    if (before.lighting[i].sky != after.lighting[i].sky) return "environment";
  return before.lighting != after.lighting ? "light" : "camera";
}

// Of masks that it has made.
std::size_t bytes_of(const SceneEntry& entry) {
  const StageLayers& before = entry.before.layers;
  std::size_t bytes = 0;
  for (const auto& layer : entry.after.layers) {
    if (std::find(before.begin(), before.end(), layer) != before.end()) continue;
    for (const MaskTerm& term : layer->mask)
      if (const auto* painted = std::get_if<VertexMask>(&term.shape))
        bytes += painted->weights.size() * sizeof(float);
  }
  return bytes;
}

bool moves_only_camera(const SceneState& before, const SceneState& after) {
  SceneState moved = before;
  moved.orbit = after.orbit;
  return moved == after;
}

bool is_camera_move(const SceneEntry& entry) {
  return moves_only_camera(entry.before, entry.after);
}

void note_camera(SceneHistory& history, const SceneState& before, const SceneState& after,
                 std::size_t recipe_entries) {
  std::erase_if(history.undone, is_camera_move);
  const bool goes_on = !history.done.empty() && is_camera_move(history.done.back()) &&
                       history.done.back().recipe_entries == recipe_entries;
  if (!goes_on)
    return history.done.push_back({before, after, label_of(before, after), recipe_entries});
  history.done.back().after = after;
  if (history.done.back().before == after) history.done.pop_back();
}

// The step of an entry between its two states. The camera may have moved since the entry was made:
// other entries leave it, and its own leave all else.
SceneState step(SceneState present, const SceneState& from, SceneState to) {
  if (moves_only_camera(from, to)) {
    present.orbit = to.orbit;
    return present;
  }
  if (from.orbit == to.orbit) to.orbit = present.orbit;
  return to;
}

}  // namespace

void note_scene(SceneHistory& history, const SceneState& state, std::size_t recipe_entries) {
  if (!history.present) history.present = state;
  if (*history.present == state) return;
  const SceneState before = *std::exchange(history.present, state);
  if (moves_only_camera(before, state)) {
    note_camera(history, before, state, recipe_entries);
  } else {
    history.done.push_back({before, state, label_of(before, state), recipe_entries});
    history.undone.clear();
  }
  std::size_t bytes = 0, kept = 0;
  while (kept < std::min(history.done.size(), max_scene_entries)) {
    bytes += bytes_of(history.done[history.done.size() - 1 - kept]);
    if (kept > 0 && bytes > history.max_mask_bytes) break;
    ++kept;
  }
  history.done.erase(history.done.begin(), history.done.end() - static_cast<std::ptrdiff_t>(kept));
}

void forget_camera(SceneHistory& history, const Orbit& orbit) {
  if (history.present) history.present->orbit = orbit;
  for (auto* entries : {&history.done, &history.undone}) {
    for (SceneEntry& entry : *entries) entry.before.orbit = entry.after.orbit = orbit;
    std::erase_if(*entries, [](const SceneEntry& entry) { return entry.before == entry.after; });
  }
}

HistoryView view_history(const SceneHistory& history, const std::vector<std::string>& recipe_done,
                         const std::vector<std::string>& recipe_undone) {
  HistoryView view;
  std::size_t scene = 0;
  const auto add_scene_up_to = [&](std::size_t recipe_entries) {
    while (scene < history.done.size() && history.done[scene].recipe_entries <= recipe_entries)
      view.rows.push_back({history.done[scene++].label, true});
  };
  add_scene_up_to(0);
  for (std::size_t i = 0; i < recipe_done.size(); ++i) {
    view.rows.push_back({recipe_done[i], false});
    add_scene_up_to(i + 1);
  }
  // What was made after entries that are undone by now.
  add_scene_up_to(static_cast<std::size_t>(-1));
  view.position = view.rows.size();
  // `undone` holds the next one last.
  auto next = history.undone.rbegin();
  const auto add_undone = [&](std::size_t recipe_entries) {
    for (; next != history.undone.rend() && next->recipe_entries <= recipe_entries; ++next)
      view.rows.push_back({next->label, true});
  };
  add_undone(recipe_done.size());
  for (std::size_t i = 0; i < recipe_undone.size(); ++i) {
    view.rows.push_back({recipe_undone[i], false});
    add_undone(recipe_done.size() + i + 1);
  }
  return view;
}

std::optional<SceneState> undo_scene(SceneHistory& history) {
  if (history.done.empty()) return std::nullopt;
  const SceneEntry& entry = history.done.back();
  history.present = step(history.present.value_or(entry.after), entry.after, entry.before);
  history.undone.push_back(std::move(history.done.back()));
  history.done.pop_back();
  return history.present;
}

std::optional<SceneState> redo_scene(SceneHistory& history) {
  if (history.undone.empty()) return std::nullopt;
  const SceneEntry& entry = history.undone.back();
  history.present = step(history.present.value_or(entry.before), entry.before, entry.after);
  history.done.push_back(std::move(history.undone.back()));
  history.undone.pop_back();
  return history.present;
}

}  // namespace parian

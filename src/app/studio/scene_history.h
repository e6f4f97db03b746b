// Undo for what is no part of the recipe: lights, layers over the material, the exposure, the
// camera, and the coefficients of a homogeneous material. Entries remember how long the recipe's
// own history was, so that both are undone in the order in which they were made.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/studio/stage.h"

namespace parian {

struct SceneState {
  bool is_homogeneous = false;
  Dipole homogeneous;  // three channels
  Lighting lighting;
  StageLayers layers;
  double exposure = 0;
  Orbit orbit;
  friend bool operator==(const SceneState&, const SceneState&) = default;
};

struct SceneEntry {
  SceneState before, after;
  std::string label;
  std::size_t recipe_entries = 0;  // of the recipe's history when it was made
};

struct SceneHistory {
  std::optional<SceneState> present;  // as last noted
  std::vector<SceneEntry> done, undone;
  // Painted masks of large meshes: beyond it the oldest entries are given up.
  std::size_t max_mask_bytes = std::size_t{256} << 20;
};
inline constexpr std::size_t max_scene_entries = 1000;

// Makes an entry of what is different from the last time; the first time none. Moves of the camera
// are one entry until something else is done, and leave what can be redone.
void note_scene(SceneHistory& history, const SceneState& state, std::size_t recipe_entries);

// Another mesh: earlier views are none of it, and `orbit` is the present one.
void forget_camera(SceneHistory& history, const Orbit& orbit);

// All that can be undone and redone, oldest first.
struct HistoryRow {
  std::string label;
  bool is_scene = false;
};
struct HistoryView {
  std::vector<HistoryRow> rows;
  std::size_t position = 0;  // rows before it are done
};
HistoryView view_history(const SceneHistory& history, const std::vector<std::string>& recipe_done,
                         const std::vector<std::string>& recipe_undone);

// Steps back or forth by one entry of the scene; returns the state that shall be.
std::optional<SceneState> undo_scene(SceneHistory& history);
std::optional<SceneState> redo_scene(SceneHistory& history);

}  // namespace parian

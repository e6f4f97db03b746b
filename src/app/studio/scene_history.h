// Undo for what is no part of the recipe: the light, the exposure, the camera, and the coefficients
// of a homogeneous material. Entries remember how long the recipe's own history was, so that both
// are undone in the order in which they were made.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "app/studio/stage.h"

namespace parian {

// What the sliders of a homogeneous material show: per channel, in 1/mm.
struct HomogeneousControls {
  std::array<double, 3> sigma_a{0.004, 0.008, 0.03};
  std::array<double, 3> sigma_s_prime{1.2, 1.3, 1.5};
  std::array<double, 3> g{};
  double eta = 1.3;
  bool single_scattering = true;
  friend bool operator==(const HomogeneousControls&, const HomogeneousControls&) = default;
};

struct SceneState {
  bool is_homogeneous = false;
  HomogeneousControls homogeneous;
  Lighting lighting;
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

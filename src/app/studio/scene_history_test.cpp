#include "app/studio/scene_history.h"

#include <gtest/gtest.h>

namespace parian {
namespace {

SceneState lit(double lamp) {
  SceneState state;
  const auto power = static_cast<float>(lamp);
  state.lighting = {{.power = {power, power, power}}};
  return state;
}

std::vector<std::string> labels(const HistoryView& view) {
  std::vector<std::string> names;
  names.reserve(view.rows.size());
  for (const HistoryRow& row : view.rows) names.push_back(row.label);
  return names;
}

TEST(SceneHistory, NotesWhatChanged) {
  SceneHistory history;
  note_scene(history, lit(1), 0);
  note_scene(history, lit(1), 0);
  EXPECT_TRUE(history.done.empty());
  note_scene(history, lit(2), 0);
  SceneState other = lit(2);
  other.exposure = 1;
  note_scene(history, other, 0);
  other.homogeneous.eta = 1.5;
  note_scene(history, other, 0);
  other.is_homogeneous = true;
  note_scene(history, other, 0);
  other.lighting.push_back({.kind = LightKind::point});
  note_scene(history, other, 0);
  other.lighting.erase(other.lighting.begin());
  note_scene(history, other, 0);
  other.layers.push_back(std::make_shared<const SurfaceLayer>());
  note_scene(history, other, 0);
  other.layers[0] = std::make_shared<const SurfaceLayer>();
  note_scene(history, other, 0);
  other.layers.clear();
  note_scene(history, other, 0);
  EXPECT_EQ(labels(view_history(history, {}, {})),
            (std::vector<std::string>{"light", "exposure", "coefficients", "homogeneous material",
                                      "add light", "remove light", "add layer",
                                      "layer of the scene", "remove layer"}));
}

TEST(SceneHistory, PaintedMasksTakeSoMuchMemory) {
  SceneHistory history;
  history.max_mask_bytes = std::size_t{3} * 100 * sizeof(float);
  SceneState state = lit(1);
  state.layers.resize(1);
  for (int i = 0; i < 10; ++i) {
    SurfaceLayer layer{.material_name = "wax"};
    layer.mask = {{VertexMask{std::vector<float>(100, 0.1f * static_cast<float>(i))}}};
    state.layers[0] = std::make_shared<const SurfaceLayer>(std::move(layer));
    note_scene(history, state, 0);
  }
  ASSERT_EQ(history.done.size(), 3u);
  EXPECT_EQ(history.done.back().after, state);
  EXPECT_EQ(history.done.back().label, "mask of wax");
  // Other entries take none, and the last one is there however large it is.
  for (int i = 0; i < 5; ++i) {
    state.exposure = i + 1;
    note_scene(history, state, 0);
  }
  EXPECT_EQ(history.done.size(), 8u);
  history.max_mask_bytes = 1;
  SurfaceLayer layer;
  layer.mask = {{VertexMask{std::vector<float>(100, 0.5f)}}};
  state.layers[0] = std::make_shared<const SurfaceLayer>(std::move(layer));
  note_scene(history, state, 0);
  EXPECT_EQ(history.done.size(), 1u);
}

TEST(SceneHistory, UndoGivesBackEachState) {
  SceneHistory history;
  for (const double lamp : {1.0, 2.0, 3.0}) note_scene(history, lit(lamp), 0);
  EXPECT_EQ(undo_scene(history), lit(2));
  EXPECT_EQ(undo_scene(history), lit(1));
  EXPECT_FALSE(undo_scene(history));
  EXPECT_EQ(redo_scene(history), lit(2));
  note_scene(history, lit(2), 0);  // as it is: nothing is forgotten
  EXPECT_EQ(redo_scene(history), lit(3));
  EXPECT_FALSE(redo_scene(history));
  undo_scene(history);
  note_scene(history, lit(7), 0);
  EXPECT_FALSE(redo_scene(history));  // another way was taken
}

TEST(SceneHistory, RunsBesideTheRecipe) {
  SceneHistory history;
  note_scene(history, lit(0), 0);
  note_scene(history, lit(1), 0);  // before any edit
  note_scene(history, lit(2), 1);  // after "a"
  note_scene(history, lit(3), 1);
  HistoryView view = view_history(history, {"a", "b"}, {});
  EXPECT_EQ(labels(view), (std::vector<std::string>{"light", "a", "light", "light", "b"}));
  EXPECT_EQ(view.position, 5u);
  // "b" is undone, then two of the light's, then "a".
  undo_scene(history);
  undo_scene(history);
  view = view_history(history, {}, {"a", "b"});
  EXPECT_EQ(labels(view), (std::vector<std::string>{"light", "a", "light", "light", "b"}));
  EXPECT_EQ(view.position, 1u);
  EXPECT_FALSE(view.rows[1].is_scene);
  EXPECT_TRUE(view.rows[2].is_scene);
}

SceneState seen_from(double yaw_deg, double lamp = 0) {
  SceneState state = lit(lamp);
  state.orbit.yaw_deg = yaw_deg;
  return state;
}

TEST(SceneHistory, MovesOfTheCameraAreOneEntryUntilAnEdit) {
  SceneHistory history;
  for (const double yaw : {0.0, 10.0, 20.0, 30.0}) note_scene(history, seen_from(yaw), 0);
  note_scene(history, seen_from(40), 1);  // after an edit
  note_scene(history, seen_from(50), 1);
  note_scene(history, seen_from(50, 3), 1);
  note_scene(history, seen_from(60, 3), 1);
  EXPECT_EQ(labels(view_history(history, {"edit"}, {})),
            (std::vector<std::string>{"camera", "edit", "camera", "light", "camera"}));
  EXPECT_EQ(undo_scene(history), seen_from(50, 3));
  EXPECT_EQ(undo_scene(history), seen_from(50));
  EXPECT_EQ(undo_scene(history), seen_from(30));
  EXPECT_EQ(undo_scene(history), seen_from(0));
  EXPECT_FALSE(undo_scene(history));
}

TEST(SceneHistory, AViewThatComesBackIsNoEntry) {
  SceneHistory history;
  for (const double yaw : {0.0, 10.0, 0.0}) note_scene(history, seen_from(yaw), 0);
  EXPECT_TRUE(history.done.empty());
}

TEST(SceneHistory, LookingAroundKeepsWhatCanBeRedone) {
  SceneHistory history;
  note_scene(history, seen_from(0, 1), 0);
  note_scene(history, seen_from(0, 2), 0);
  undo_scene(history);
  note_scene(history, seen_from(70, 1), 0);
  EXPECT_EQ(redo_scene(history), seen_from(70, 2));  // the lamp's step, seen from where we are
  EXPECT_EQ(undo_scene(history), seen_from(70, 1));
  EXPECT_EQ(undo_scene(history), seen_from(0, 1));
  EXPECT_FALSE(undo_scene(history));
}

TEST(SceneHistory, AnotherMeshHasNoneOfTheEarlierViews) {
  SceneHistory history;
  note_scene(history, seen_from(0, 1), 0);
  note_scene(history, seen_from(10, 1), 0);
  note_scene(history, seen_from(10, 2), 0);
  Orbit orbit;
  orbit.yaw_deg = -5;
  forget_camera(history, orbit);
  EXPECT_EQ(labels(view_history(history, {}, {})), std::vector<std::string>{"light"});
  EXPECT_EQ(undo_scene(history), seen_from(-5, 1));
  note_scene(history, seen_from(-5, 1), 0);
  EXPECT_EQ(redo_scene(history), seen_from(-5, 2));
}

}  // namespace
}  // namespace parian

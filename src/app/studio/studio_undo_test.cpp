// Light and camera are undone beside the recipe.
#include "app/studio/studio.h"
#include "app/studio/test_studio_internal.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

TEST(Studio, UndoesTheLightBesideTheRecipe) {
  const StateFolder folder;
  Studio studio;
  start_small(studio, folder);
  run(studio);
  const Lighting first = studio.lighting;
  Lighting turned = first;
  turn_light(turned[0], 10, 0, {});
  studio.lighting = turned;
  touch_view(studio);
  run(studio);
  add_layer(studio, make_adjust(2));
  run(studio);
  studio.use_transport = false;
  set_homogeneous(studio, first_homogeneous());
  note_scene_now(studio);
  EXPECT_EQ(view_history(studio).position, 3u);
  undo(studio);
  EXPECT_FALSE(studio.is_homogeneous);
  EXPECT_EQ(studio.snapshot->layers.size(), 1u);
  undo(studio);
  studio.editor->wait();
  run(studio);
  EXPECT_TRUE(studio.snapshot->layers.empty());
  EXPECT_EQ(studio.lighting, turned);
  undo(studio);
  EXPECT_EQ(studio.lighting, first);
  jump_to(studio, 3);
  studio.editor->wait();
  run(studio);
  EXPECT_EQ(studio.lighting, turned);
  EXPECT_EQ(studio.snapshot->layers.size(), 1u);
  EXPECT_TRUE(studio.is_homogeneous);
}

// Until it is at rest, and what was done is an entry of the history.
void rest(Studio& studio) {
  run(studio);
  update(studio, studio.last_change_s + 1);
}

TEST(Studio, UndoesTheCameraBesideTheRecipe) {
  const StateFolder folder;
  Studio studio;
  start_draft(studio, folder);
  rest(studio);
  const Orbit first = studio.orbit;
  // A burst of the wheel, then another move: one entry.
  for (int i = 0; i < 5; ++i) {
    zoom(studio.orbit, 1);
    touch_view(studio);
    update(studio, studio.now_s + 0.05);
  }
  EXPECT_EQ(view_history(studio).position, 0u);  // it goes on
  rest(studio);
  turn(studio.orbit, 10, 5, 100);
  touch_view(studio);
  rest(studio);
  const Orbit second = studio.orbit;
  ASSERT_EQ(view_history(studio).rows.size(), 1u);
  EXPECT_EQ(view_history(studio).rows[0].label, "camera");
  // A move right before an edit is undone after it.
  pan(studio.orbit, 5, 5, 100);
  touch_view(studio);
  add_layer(studio, make_adjust(2));
  rest(studio);
  const Orbit third = studio.orbit;
  ASSERT_EQ(view_history(studio).rows.size(), 2u);
  EXPECT_TRUE(view_history(studio).rows[0].is_scene);
  turn(studio.orbit, 10, 5, 100);
  touch_view(studio);
  rest(studio);
  undo(studio);
  EXPECT_EQ(studio.orbit, third);
  EXPECT_EQ(studio.snapshot->layers.size(), 1u);
  undo(studio);
  rest(studio);
  EXPECT_TRUE(studio.snapshot->layers.empty());
  EXPECT_EQ(studio.orbit, third);
  // To look around takes nothing away from what can be redone.
  turn(studio.orbit, -40, 5, 100);
  touch_view(studio);
  rest(studio);
  redo(studio);
  rest(studio);
  EXPECT_EQ(studio.snapshot->layers.size(), 1u);
  jump_to(studio, 0);
  rest(studio);
  EXPECT_EQ(studio.orbit, first);
  EXPECT_FALSE(first == second);
}

TEST(Studio, ViewsOfAnotherMeshAreForgotten) {
  const StateFolder folder;
  Studio studio;
  start_draft(studio, folder);
  rest(studio);
  turn(studio.orbit, 10, 5, 100);
  touch_view(studio);
  rest(studio);
  EXPECT_EQ(view_history(studio).rows.size(), 1u);
  show_stage(studio, make_plain_stage(make_plane(10), {.shape = "plane"}), "plane");
  rest(studio);
  EXPECT_TRUE(view_history(studio).rows.empty());
}

}  // namespace
}  // namespace parian

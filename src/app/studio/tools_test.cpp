#include "app/studio/tools.h"

#include <gtest/gtest.h>

#include "app/studio/test_studio_internal.h"
#include "base/error.h"
#include "io/hdf5/map_file.h"

namespace parian {
namespace {

// A studio with the small map on the knot.
struct ToolsTest : testing::Test {
  StateFolder folder;
  Studio studio;

  void SetUp() override {
    std::filesystem::create_directories(folder.path);
    start_studio(studio, {folder.path, "/no/such/folder"});
    make_small(studio);
    show_map(studio, make_map(), folder.path + "/map.h5");
    studio.messages.clear();
  }
  void draw(Tool tool, const std::vector<std::array<double, 2>>& points, bool on_second = false) {
    studio.tool = tool;
    for (const auto& [x, y] : points) extend_stroke(studio, x, y, on_second);
    finish_stroke(studio);
    wait();
  }
  void wait() {
    do {
      studio.editor->wait();
      apply_strokes(studio);
    } while (studio.editor->activity().busy || !studio.waiting_strokes.empty());
    update(studio, studio.now_s + 0.01);
  }
  const Document& layer(std::size_t i) { return studio.snapshot->layers.at(i).source; }
};

TEST_F(ToolsTest, StrokesWaitForTheEditor) {
  studio.tool = Tool::brush;
  for (int i = 0; i < 3; ++i) {
    extend_stroke(studio, 1 + i, 1);
    finish_stroke(studio);  // while the one before is worked on
  }
  wait();
  // One layer with three strokes, in the order in which they were drawn.
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  const auto& strokes = as_array(get(get(layer(0), "selection"), "of"));
  ASSERT_EQ(strokes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(as_numbers(as_array(get(strokes[i], "points"))[0])[0], 1 + static_cast<double>(i));
}

TEST_F(ToolsTest, PaintsWithASecondMaterial) {
  ProfileMap other = make_map();
  other.pixel_pitch_mm = 0.25;
  for (float& value : other.log_profile) value -= 2;
  save_profile_map(folder.path + "/other.h5", other);
  open_second(studio, folder.path + "/other.h5");
  for (int i = 0; i < 2000 && studio.second == nullptr; ++i) {
    update(studio, 0);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  ASSERT_NE(studio.second, nullptr);
  studio.tool = Tool::eyedropper;
  pick_second(studio, 2.6, 1.1);  // pixel (10, 4)
  ASSERT_TRUE(studio.picked);
  EXPECT_EQ(studio.picked->at_mm, (std::array{2.625, 1.125}));
  studio.brush_radius_mm = 2;
  draw(Tool::paint, {{3.25, 2.75}});
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  EXPECT_EQ(as_string(get(get(layer(0), "from"), "map")), studio.second->path);
  const Profile painted = get_profile(studio.snapshot->after, 1, 6, 5);
  EXPECT_NEAR(eval_log_profile(painted, 1), eval_log_profile(studio.picked->profiles[1], 1), 1e-6);
  // It gives, and takes nothing.
  draw(Tool::brush, {{1, 1}}, true);
  EXPECT_EQ(studio.snapshot->layers.size(), 1u);
  EXPECT_EQ(studio.messages.back().text, "the second material only gives: pick from it, or stamp");
}

TEST_F(ToolsTest, TheStampTakesThenPuts) {
  draw(Tool::stamp, {{1, 1}});
  EXPECT_TRUE(studio.messages.back().is_error);
  draw(Tool::stamp, {{4, 3}, {1, 1}});
  ASSERT_TRUE(studio.stamp_source);
  EXPECT_EQ(studio.stamp_source->box_mm, (std::array{1.0, 1.0, 4.0, 3.0}));
  EXPECT_TRUE(studio.snapshot->layers.empty());
  draw(Tool::stamp, {{3, 3}});
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  EXPECT_EQ(studio.snapshot->layers[0].kind, "paste");
  EXPECT_FALSE(studio.editor->take_error());
}

TEST_F(ToolsTest, EveryOperationStartsOrSaysWhatItNeeds) {
  for (const OperationKind& kind : operation_kinds()) {
    try {
      add_layer(studio, make_starting_layer(studio, kind.name));
      studio.editor->wait();
      EXPECT_EQ(studio.editor->take_error(), std::nullopt) << kind.name;
      EXPECT_EQ(studio.editor->snapshot()->layers.size(), 1u) << kind.name;
      studio.editor->undo();
      wait();
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("layer '" + kind.name + "'"), std::string::npos)
          << error.what();
    }
  }
  EXPECT_THROW(make_starting_layer(studio, "blend"), Error);
  studio.tool = Tool::eyedropper;
  pick_pixel(studio, {3, 3});
  EXPECT_NO_THROW(make_starting_layer(studio, "blend"));
}

TEST_F(ToolsTest, TheMeshIsMappedAsItIsRendered) {
  // In the middle of the view is the knot's hole or surface: some pixel of it is hit.
  studio.orbit = frame_stage(*studio.stage, studio.view_width, studio.view_height);
  int hits = 0;
  for (int x = 0; x < studio.view_width; ++x)
    if (const auto place = mesh_to_map(studio, x + 0.5, 0.5 * studio.view_height)) {
      ++hits;
      EXPECT_TRUE(pixel_at(studio.snapshot->after, (*place)[0], (*place)[1]));
    }
  EXPECT_GT(hits, 5);
  EXPECT_FALSE(mesh_to_map(studio, 0, 0));
}

}  // namespace
}  // namespace parian

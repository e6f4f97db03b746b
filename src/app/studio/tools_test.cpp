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

TEST_F(ToolsTest, TheSelectToolDrawsTheSelectedPart) {
  draw(Tool::select, {{1, 1}});
  EXPECT_TRUE(studio.messages.back().is_error);
  EXPECT_TRUE(studio.snapshot->layers.empty());
  draw(Tool::select, {{4, 3}, {1, 1}});
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  const auto selection = [&]() -> const Document& { return get(layer(0), "selection"); };
  EXPECT_EQ(part_type(selection()), "rectangle");
  EXPECT_EQ(as_numbers(get(selection(), "max")), (std::vector<double>{4, 3}));
  draw(Tool::select, {{2, 2}, {5, 4}});  // anew
  EXPECT_EQ(as_numbers(get(selection(), "min")), (std::vector<double>{2, 2}));
  // A handle is dragged: one entry.
  const std::size_t entries = studio.snapshot->history.size();
  grab_handle(studio, 5.05, 4, 0.2);
  ASSERT_TRUE(studio.grabbed);
  for (const double x : {4.5, 4.0, 3.5}) drag_handle(studio, x, 3);
  studio.grabbed.reset();
  wait();
  EXPECT_EQ(as_numbers(get(selection(), "max")), (std::vector<double>{3.5, 3}));
  EXPECT_EQ(studio.snapshot->history.size(), entries + 1);
  grab_handle(studio, 1, 4, 0.2);
  EXPECT_FALSE(studio.grabbed);
  // In a set: a rectangle more, which is selected.
  Document changed = layer(0);
  set(changed, "selection",
      change_part(selection(), "difference", {.state = studio.snapshot->after}));
  change_layer(studio, changed, "set");
  wait();
  draw(Tool::select, {{2.5, 2.5}, {3, 3}});
  EXPECT_EQ(as_array(get(selection(), "of")).size(), 2u);
  EXPECT_EQ(selected_part(studio), PartPath{1});
  // Its pixels are taken out: (2.5, 2.5) mm is pixel (5, 5).
  EXPECT_EQ(studio.snapshot->layers[0].mask->weight[5 * 12 + 5], 0);
  EXPECT_EQ(studio.snapshot->layers[0].mask->weight[4 * 12 + 4], 1);
}

TEST_F(ToolsTest, ChangesOfALayerAddUpWhileTheEditorWorks) {
  add_layer(studio, make_adjust(2));
  wait();
  for (const char* key : {"hue_deg", "saturation", "lightness"}) {
    Document changed = layer(0);  // as panels see it now
    set(changed, key, 0.5);
    change_layer(studio, std::move(changed), key);
  }
  wait();
  for (const char* key : {"hue_deg", "saturation", "lightness"})
    EXPECT_NE(find(layer(0), key), nullptr) << key;
  EXPECT_FALSE(studio.pending_layer);
}

TEST_F(ToolsTest, InterpolationTakesOverAScribble) {
  studio.brush_radius_mm = 0.5;
  draw(Tool::scribble_plus, {{1, 1}, {2, 2}});
  draw(Tool::scribble_minus, {{5, 4}});
  Document scribble = layer(0);
  set(scribble, "range_scale", 2);
  change_layer(studio, scribble, "range");
  wait();
  const Plane by_scribble = range_plane(studio.snapshot->after);
  add_layer(studio, make_starting_layer(studio, "interpolate"));
  wait();
  EXPECT_EQ(studio.editor->take_error(), std::nullopt);
  const auto& strokes = as_array(get(layer(1), "strokes"));
  ASSERT_EQ(strokes.size(), 2u);
  EXPECT_EQ(as_number(get(strokes[0], "range_scale")), 2);
  EXPECT_EQ(find(strokes[1], "range_scale"), nullptr);
  // In its place it does the same: the profiles are of two kinds only.
  studio.editor->post("remove", remove_layer(0));
  wait();
  const Plane interpolated = range_plane(studio.snapshot->after);
  for (std::size_t i = 0; i < interpolated.size(); ++i)
    EXPECT_NEAR(interpolated[i], by_scribble[i], 0.02 * by_scribble[i]);
  // Scribbles on it are strokes of its own.
  studio.selected_layer = 0;
  draw(Tool::scribble_plus, {{4, 4}});
  EXPECT_EQ(as_array(get(layer(0), "strokes")).size(), 3u);
  EXPECT_EQ(studio.selected_stroke, 2u);
}

TEST_F(ToolsTest, ABrushSelectsForALayerOnAllOfTheMap) {
  add_layer(studio, make_starting_layer(studio, "filter"));
  wait();
  studio.brush_radius_mm = 1;
  draw(Tool::brush, {{1, 1}, {2, 1}});
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  EXPECT_EQ(part_type(get(layer(0), "selection")), "union");
  // Into a union beside other parts, also when one of those is selected.
  studio.part = {0};
  draw(Tool::brush, {{4, 4}});
  EXPECT_EQ(as_array(get(get(layer(0), "selection"), "of")).size(), 2u);
}

double distance_to(const std::vector<StrokeLine>& lines, const Place& at) {
  double nearest = 1e300;
  for (const StrokeLine& line : lines)
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Place a = line[i], b = line[std::min(i + 1, line.size() - 1)];
      const double dx = b[0] - a[0], dy = b[1] - a[1], square = dx * dx + dy * dy;
      const double t =
          square > 0 ? std::clamp(((at[0] - a[0]) * dx + (at[1] - a[1]) * dy) / square, 0.0, 1.0)
                     : 0;
      nearest = std::min(nearest, std::hypot(at[0] - a[0] - t * dx, at[1] - a[1] - t * dy));
    }
  return nearest;
}

TEST_F(ToolsTest, AStrokeOnTheMeshIsWholeAcrossSeams) {
  // The knot is mapped from all sides: the line crosses seams, folds of the map and gaps.
  studio.view_width = 400;
  studio.view_height = 300;
  studio.brush_radius_mm = 0.5;
  studio.tool = Tool::brush;
  studio.orbit = frame_stage(*studio.stage, studio.view_width, studio.view_height);
  const Place from{90, 60}, to{330, 220};
  constexpr int moves = 12;
  const auto on_way = [&](double t) {
    return Place{from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])};
  };
  for (int i = 1; i <= moves; ++i)
    extend_mesh_stroke(studio, on_way((i - 1.0) / moves), on_way(static_cast<double>(i) / moves));
  const std::vector<StrokeLine> lines = studio.stroke.lines;
  EXPECT_GE(lines.size(), 3u);
  // What lies under the pointer's way is painted, and no line runs across the map beside it.
  // Slivers of the mesh thinner than a pixel may fall between the steps.
  constexpr int per_pixel = 14, steps = 288 * per_pixel;
  int seen = 0, gap = 0, longest_gap = 0;
  for (int i = 0; i <= steps; ++i) {
    const Place at = on_way(static_cast<double>(i) / steps);
    const auto place = mesh_to_map(studio, at[0], at[1]);
    if (place) ++seen;
    gap = place && distance_to(lines, *place) > studio.brush_radius_mm ? gap + 1 : 0;
    longest_gap = std::max(longest_gap, gap);
  }
  EXPECT_GT(seen, steps / 4);
  EXPECT_LT(longest_gap, per_pixel);
  for (const StrokeLine& line : lines)
    for (std::size_t i = 1; i < line.size(); ++i)
      EXPECT_LE(std::hypot(line[i][0] - line[i - 1][0], line[i][1] - line[i - 1][1]),
                studio.brush_radius_mm + 1e-9);
  // One stroke, one entry.
  finish_stroke(studio);
  wait();
  EXPECT_EQ(studio.snapshot->history.size(), 1u);
  EXPECT_EQ(as_array(get(get(layer(0), "selection"), "of")).size(), lines.size());
}

}  // namespace
}  // namespace parian

#include "app/studio/studio.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

#include "app/studio/flat_picture.h"
#include "app/studio/test_studio_internal.h"
#include "app/studio/tools.h"
#include "io/hdf5/map_file.h"
#include "io/json/json.h"
#include "judge/relight.h"
#include "material/bssrdf_table.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

TEST(Editor, EditsUndoesAndRedoes) {
  Editor editor(make_map(), {});
  EXPECT_TRUE(editor.snapshot()->layers.empty());
  editor.post("first", insert_layer(0, make_adjust(2)));
  editor.wait();
  const auto one = editor.snapshot();
  ASSERT_EQ(one->layers.size(), 1u);
  EXPECT_EQ(one->history, std::vector<std::string>{"first"});
  const double before = range_plane(one->before).at(0);
  EXPECT_NEAR(range_plane(one->after).at(0), 2 * before, 1e-9 * before);
  editor.undo();
  editor.wait();
  EXPECT_TRUE(editor.snapshot()->layers.empty());
  EXPECT_EQ(editor.snapshot()->future, std::vector<std::string>{"first"});
  EXPECT_EQ(range_plane(editor.snapshot()->after).at(0), before);
  editor.undo();  // nothing left
  editor.redo();
  editor.wait();
  EXPECT_EQ(range_plane(editor.snapshot()->after), range_plane(one->after));
  EXPECT_FALSE(editor.take_error());
}

TEST(Editor, ADragIsOneEntry) {
  Editor editor(make_map(), {});
  editor.post("add", insert_layer(0, make_adjust(1)));
  for (int i = 1; i <= 50; ++i) editor.post("drag", set_layer(0, make_adjust(1 + 0.02 * i)), "key");
  editor.wait();
  EXPECT_EQ(editor.snapshot()->history, (std::vector<std::string>{"add", "drag"}));
  EXPECT_EQ(as_number(get(editor.snapshot()->layers[0].source, "range_scale")), 2);
  editor.post("drag", set_layer(0, make_adjust(3)), "another key");
  editor.wait();
  EXPECT_EQ(editor.snapshot()->history.size(), 3u);
  editor.undo();
  editor.undo();
  editor.wait();
  EXPECT_EQ(as_number(get(editor.snapshot()->layers[0].source, "range_scale")), 1);
}

TEST(Editor, WhatFailsIsTakenBack) {
  Editor editor(make_map(), {});
  editor.post("good", insert_layer(0, make_adjust(2)));
  editor.post("bad", insert_layer(1, make_adjust(-1)));
  editor.wait();
  const auto error = editor.take_error();
  ASSERT_TRUE(error);
  EXPECT_NE(error->find("range_scale"), std::string::npos) << *error;
  EXPECT_FALSE(editor.take_error());
  EXPECT_EQ(editor.snapshot()->layers.size(), 1u);
  EXPECT_EQ(editor.snapshot()->history, std::vector<std::string>{"good"});
}

// Keys may come faster than results.
TEST(Editor, ChangesOfALayerThatIsGoneChangeNothing) {
  Editor editor(make_map(), {});
  editor.post("add", insert_layer(0, make_adjust(2)));
  editor.post("remove", remove_layer(0));
  editor.post("remove", remove_layer(0));
  editor.post("drag", set_layer(0, make_adjust(3)));
  editor.post("move", move_layer(0, 0));
  editor.post("late", insert_layer(1, make_adjust(4)));
  editor.wait();
  EXPECT_FALSE(editor.take_error());
  EXPECT_EQ(editor.snapshot()->layers.size(), 1u);
  EXPECT_EQ(editor.snapshot()->history, (std::vector<std::string>{"add", "remove", "late"}));
}

TEST(Jobs, FinishOnTheWindowsThread) {
  Jobs jobs;
  const auto here = std::this_thread::get_id();
  bool finished = false;
  jobs.start("work", [&](const Progress& progress) -> Jobs::Finish {
    EXPECT_NE(std::this_thread::get_id(), here);
    advance_progress(progress, "half", 0.5);
    return [&] {
      EXPECT_EQ(std::this_thread::get_id(), here);
      finished = true;
    };
  });
  EXPECT_TRUE(jobs.is_running("work"));
  while (!finished) EXPECT_TRUE(jobs.poll().empty());
  EXPECT_FALSE(jobs.is_running("work"));
}

TEST(Jobs, CancelledAndFailedOnesChangeNothing) {
  Jobs jobs;
  bool finished = false;
  jobs.start("endless", [&](const Progress& progress) -> Jobs::Finish {
    while (true) advance_progress(progress, "on and on", 0);
    return [&] { finished = true; };
  });
  jobs.start("failing",
             [](const Progress&) -> Jobs::Finish { throw std::runtime_error("no luck"); });
  jobs.cancel("endless");
  std::vector<std::string> errors;
  while (errors.empty()) errors = jobs.poll();
  EXPECT_EQ(errors, std::vector<std::string>{"no luck"});
  EXPECT_FALSE(finished);
}

TEST(Stage, DraggingTurnsByHalfATurnPerHeight) {
  Orbit orbit{.yaw_deg = 0, .pitch_deg = 0, .distance_mm = 10};
  turn(orbit, 50, 25, 100);
  EXPECT_NEAR(orbit.yaw_deg, -90, 1e-9);
  EXPECT_NEAR(orbit.pitch_deg, 45, 1e-9);
  const Orbit again = make_orbit(make_camera(orbit, 100, 100));
  EXPECT_NEAR(again.yaw_deg, orbit.yaw_deg, 1e-4);
  EXPECT_NEAR(again.pitch_deg, orbit.pitch_deg, 1e-4);
  EXPECT_NEAR(again.distance_mm, 10, 1e-4);
}

TEST(Stage, PanningMovesWhatIsUnderThePointer) {
  Scene scene;
  scene.mesh = make_plane(10);
  const auto stage = make_stage(std::move(scene));
  const SampleGrid grid{.width = 400, .height = 400, .pixel_pitch_mm = 0.1};
  Orbit orbit{.target = {0, 0, 0}, .yaw_deg = 0, .pitch_deg = 89, .distance_mm = 20};
  const auto before = pick(*stage, grid, make_camera(orbit, 100, 100), 50, 50);
  pan(orbit, 20, 10, 100);
  const auto after = pick(*stage, grid, make_camera(orbit, 100, 100), 70, 60);
  ASSERT_TRUE(before && after);
  EXPECT_NEAR(after->x, before->x, 0.05 / grid.pixel_pitch_mm);
  EXPECT_NEAR(after->y, before->y, 0.05 / grid.pixel_pitch_mm);
  EXPECT_FALSE(pick(*stage, grid, make_camera(orbit, 100, 100), 1, 1));
}

TEST(FlatPicture, LitIsWhatRelightingGives) {
  const ProfileMap map = make_map();
  const EditState state = make_edit_state(map);
  const Image shown = draw_flat(
      {.state = state, .map = std::make_shared<const ProfileMap>(map), .mode = FlatMode::uniform},
      {});
  const Material material(map);
  const auto slices = make_slices(material, natural_header(material));
  const Image wanted =
      relight(*slices, {make_flat_light(FlatLight::uniform, map.width, map.height, 1)}).front();
  EXPECT_EQ(shown.values, wanted.values);
  const Image albedo = draw_flat({.state = state, .mode = FlatMode::albedo}, {});
  const Plane plane = albedo_plane(state);
  EXPECT_EQ(at(albedo, 3, 2, 1),
            static_cast<float>(plane[state.pixels() + 2 * static_cast<std::size_t>(12) + 3]));
}

TEST(FlatPicture, PairsAreAllOfAPixel) {
  TableHeader header{.width = 3, .height = 1, .channels = 1, .pixel_pitch_mm = 2};
  header.offsets = {{0, 0}, {1, 0}};
  BssrdfTable table = make_bssrdf_table(header);
  table.reflectance = {1, 2, 3, 10, 20, NAN};
  const auto pairs = collect_pairs(*make_slices(table), 0, {1, 0}, {});
  ASSERT_EQ(pairs.size(), 4u);  // itself once from either side, and both neighbours
  EXPECT_EQ(pairs[2].value, 20);
  EXPECT_EQ(pairs[3].value, 10);
  EXPECT_EQ(pairs[3].r_mm, 2);
}

TEST(Studio, StartsWithTheBundledSampleAndTakesStrokes) {
  const StateFolder folder;
  Studio studio;
  start_small(studio, folder);
  run(studio);
  ASSERT_NE(studio.picture, nullptr);
  EXPECT_EQ(studio.picture->width, 64);
  studio.tool = Tool::scribble_minus;
  extend_stroke(studio, 5, 5);
  finish_stroke(studio);
  ASSERT_FALSE(studio.messages.empty());
  EXPECT_TRUE(studio.messages.back().is_error);
  studio.tool = Tool::brush;
  for (int i = 0; i < 5; ++i) extend_stroke(studio, 5 + i, 5);
  finish_stroke(studio);
  run(studio);
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  EXPECT_EQ(as_string(get(get(studio.snapshot->layers[0].source, "selection"), "type")), "union");
  finish_stroke(studio);  // nothing drawn
  studio.tool = Tool::eyedropper;
  pick_pixel(studio, {3, 4});
  ASSERT_TRUE(studio.picked);
  studio.tool = Tool::paint;
  studio.brush_radius_mm = 3;
  extend_stroke(studio, 10, 10);
  extend_stroke(studio, 12, 10);
  finish_stroke(studio);
  run(studio);
  ASSERT_EQ(studio.snapshot->layers.size(), 2u);
  EXPECT_EQ(studio.snapshot->layers[1].kind, "blend");
  // Painted pixels have the picked profile.
  const Profile wanted = get_profile(studio.snapshot->after, 0, 3, 4);
  const double pitch = studio.snapshot->after.pixel_pitch_mm;
  const Profile painted = get_profile(studio.snapshot->after, 0, static_cast<int>(11 / pitch),
                                      static_cast<int>(10 / pitch));
  EXPECT_NEAR(eval_log_profile(painted, 1), eval_log_profile(wanted, 1), 1e-6);
  set_shape_point(studio, 0.5, 2);
  run(studio);
  ASSERT_EQ(studio.snapshot->layers.size(), 3u);
  EXPECT_EQ(studio.snapshot->layers[2].kind, "shape");
}

TEST(Studio, RecoversWhatWasNotSaved) {
  const StateFolder folder;
  {
    Studio studio;
    start_small(studio, folder);
    add_layer(studio, make_adjust(0.5));
    studio.editor->wait();
    run(studio);
    update(studio, studio.last_change_s + 10);
  }
  Studio studio;
  start_small(studio, folder);
  ASSERT_TRUE(studio.recoverable);
  recover(studio);
  run(studio);
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  finish_studio(studio);
  EXPECT_FALSE(std::filesystem::exists(autosave_path(studio.paths)));
  EXPECT_FALSE(find_autosave(studio.paths));
}

TEST(Studio, BadFilesBecomeMessages) {
  const StateFolder folder;
  Studio studio;
  start_studio(studio, {folder.path, "/no/such/folder"});  // no bundled sample either
  EXPECT_TRUE(studio.is_homogeneous);
  make_small(studio);
  studio.use_transport = false;
  for (const char* name : {"/no/such.h5", "/no/such.ply", "/no/such.json", "/no/such.kbm",
                           "/no/such.exr", "/no/such"}) {
    const std::size_t before = studio.messages.size();
    open_file(studio, name);
    run(studio);
    ASSERT_GT(studio.messages.size(), before) << name;
    EXPECT_TRUE(studio.messages.back().is_error) << name;
    EXPECT_NE(studio.messages.back().text.find("/no/such"), std::string::npos);
  }
}

TEST(Studio, LeavesAutosavesOfRunningEditorsAlone) {
  const StateFolder folder;
  std::filesystem::create_directories(folder.path);
  const StudioPaths paths{folder.path, ""};
  const auto put = [&](const std::string& name) {
    save_document(folder.path + "/" + name, Document(Document::Object{{"material", name}}));
  };
  EXPECT_FALSE(find_autosave(paths));
  put("autosave-1.json");  // the first process always runs
  put("autosave-x.json");  // no number
  put("autosave-999999999.json.bak");
  EXPECT_FALSE(find_autosave(paths));
  put("autosave-999999999.json");  // beyond the largest process
  const auto found = find_autosave(paths);
  ASSERT_TRUE(found);
  EXPECT_EQ(as_string(get(load_document(*found), "material")), "autosave-999999999.json");
  EXPECT_EQ(find_autosave(paths), found);  // until it is taken or thrown away
  Studio studio;
  studio.recoverable = found;
  discard_recoverable(studio);
  EXPECT_FALSE(find_autosave(paths));
}

TEST(Studio, RecipesWaitForTheMapThatTheyComeWith) {
  const StateFolder folder;
  Studio studio;
  start_draft(studio, folder);
  run(studio);
  const std::string map = folder.path + "/small.h5", recipe = folder.path + "/a.json";
  save_profile_map(map, make_map());
  Document document{Document::Object{}};
  set(document, "layers", Document::Array{make_adjust(3)});
  save_document(recipe, document);
  open_files(studio, {recipe, map, folder.path + "/none.json"});
  run(studio);
  EXPECT_EQ(studio.material_path, map);
  EXPECT_EQ(studio.snapshot->after.width, 12);
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  EXPECT_EQ(studio.recipe_path, recipe);
  EXPECT_EQ(studio.selected_layer, std::optional<std::size_t>(0));
  EXPECT_TRUE(studio.waiting_files.empty());
}

// The order in which they are named counts, not which is read faster.
TEST(Studio, OfTwoMapsTheSecondIsToPickFrom) {
  const StateFolder folder;
  Studio studio;
  start_draft(studio, folder);
  run(studio);
  ProfileMap large = make_profile_map(200, 150, 3, 0.5, {0, 1, 2, 3});
  for (std::size_t i = 0; i < large.log_profile.size(); ++i) large.log_profile[i] = -2;
  const std::string first = folder.path + "/large.h5", second = folder.path + "/small.h5";
  save_profile_map(first, large);
  save_profile_map(second, make_map());
  for (const bool is_turned : {false, true}) {
    const std::string &base = is_turned ? second : first, &other = is_turned ? first : second;
    open_files(studio, {base, other, folder.path + "/small.h5"});
    EXPECT_NE(studio.messages.back().text.find("small.h5: not opened"), std::string::npos);
    run(studio);
    EXPECT_EQ(studio.material_path, base);
    ASSERT_NE(studio.second, nullptr);
    EXPECT_EQ(studio.second->path, other);
    // Of two that are opened one after the other the later one is shown.
    open_file(studio, other);
    open_file(studio, base);
    run(studio);
    EXPECT_EQ(studio.material_path, base);
  }
}

TEST(Studio, CompressionsAreInOrder) {
  const StateFolder folder;
  Studio studio;
  start_small(studio, folder);
  studio.compression.bases = 16;
  compress_map(studio);
  run(studio);
  ASSERT_EQ(studio.compressed.size(), 4u);  // 2, 4, 8, 16
  show_compressed(studio, 3);
  const auto shown = studio.compressed[3].blend;
  EXPECT_TRUE(std::holds_alternative<ProfileBlend>(*studio.material));
  studio.compression.per_pixel = 1;
  compress_map(studio);
  run(studio);
  ASSERT_EQ(studio.compressed.size(), 8u);
  EXPECT_EQ(studio.compressed[*studio.shown_compressed].blend, shown);  // another place in the list
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_GT(studio.compressed[i].bytes, studio.compressed[i - 1].bytes);
    EXPECT_LT(studio.compressed[i].relative_error, studio.compressed[i - 1].relative_error);
  }
  add_layer(studio, make_adjust(2));
  studio.editor->wait();
  run(studio);
  EXPECT_TRUE(studio.compressed.empty());  // they were of another map
}

TEST(Studio, ARecipeThatFailsLeavesThePresentOne) {
  const StateFolder folder;
  Studio studio;
  start_small(studio, folder);
  add_layer(studio, make_adjust(2));
  studio.editor->wait();
  const std::string path = folder.path + "/recipe.json";
  const auto open = [&](const Document& layer) {
    Document recipe{Document::Object{}};
    set(recipe, "layers", Document::Array{layer});
    save_document(path, recipe);
    open_file(studio, path);
    run(studio);
  };
  open(make_adjust(-1));
  EXPECT_NE(studio.messages.back().text.find("range_scale"), std::string::npos);
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  EXPECT_EQ(as_number(get(studio.snapshot->layers[0].source, "range_scale")), 2);
  open(make_adjust(3));
  ASSERT_EQ(studio.snapshot->layers.size(), 1u);
  EXPECT_EQ(as_number(get(studio.snapshot->layers[0].source, "range_scale")), 3);
  EXPECT_EQ(what_is_unsaved(studio), "");
}

TEST(Studio, TheSameErrorIsOneMessage) {
  Studio studio;
  for (int i = 0; i < 3; ++i) report(studio, "no", true);
  report(studio, "yes");
  ASSERT_EQ(studio.messages.size(), 2u);
  EXPECT_EQ(studio.messages[0].count, 3);
}

}  // namespace
}  // namespace parian

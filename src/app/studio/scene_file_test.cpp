#include "app/studio/scene_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "app/cli/inputs.h"
#include "app/studio/stage_layers.h"
#include "app/studio/test_studio_internal.h"
#include "base/test_documents.h"
#include "io/hdf5/map_file.h"
#include "io/json/json.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

// Two lamps (one of them off), a point light, environments and layers: the file's path.
std::string write_rich_scene(const std::string& folder, Document material) {
  std::filesystem::create_directories(folder);
  save_profile_map(folder + "/map.h5", make_map());
  ProfileMap over = make_map();
  for (float& value : over.log_profile) value -= 0.5f;
  save_profile_map(folder + "/over.h5", over);
  const Document scene = object(
      {{"mesh",
        object({{"shape", "knot"}, {"size_mm", 35}, {"rotation_deg", array({10, 20, 30})}})},
       {"material", std::move(material)},
       {"mapping", object({{"kind", "box"}, {"scale", 2}})},
       {"layers",
        array({object({{"material", object({{"file", "over.h5"}})},
                       {"mask", object({{"type", "sphere"},
                                        {"center", array({5, 10, 0})},
                                        {"radius_mm", 12},
                                        {"feather_mm", 3}})},
                       {"range", 0.5}}),
               object({{"name", "wax"},
                       {"material", object({{"sigma_a", 0.1}, {"sigma_s_prime", 2}, {"eta", 1.3}})},
                       {"enabled", false}})})},
       {"specular", object({{"roughness", 0.2}})},
       {"camera", object({{"position", array({60, 70, 80})},
                          {"target", array({1, 12, 2})},
                          {"up", array({0.4, 1, -0.2})},
                          {"fov_deg", 25},
                          {"width", 64},
                          {"height", 48}})},
       {"lights",
        array(
            {object({{"type", "directional"},
                     {"direction", array({0.3, 0.7, 0.4})},
                     {"irradiance", array({2, 1, 0.5})}}),
             object(
                 {{"type", "environment"}, {"sky", "clear"}, {"rotation_deg", 40}, {"scale", 0.4}}),
             object({{"type", "directional"}, {"direction", array({-1, 0.2, 0.4})}}),
             object({{"type", "point"},
                     {"position", array({-30, 40, 20})},
                     {"intensity", array({900, 1500, 2500})}}),
             object(
                 {{"type", "directional"}, {"direction", array({0, 1, 0})}, {"enabled", false}})})},
       {"exposure", 0.5},
       {"background", array({0.1, 0.2, 0.3})}});
  save_document(folder + "/scene.json", scene);
  return folder + "/scene.json";
}

Scene shown_scene(const Studio& studio) {
  Scene scene = make_scene(*studio.stage, *studio.material, shown_layers(studio), studio.lighting,
                           make_view_camera(studio, 1));
  scene.exposure = studio.exposure;  // which the renderers take by itself
  return scene;
}

SceneState state_of(const Studio& studio) {
  return {studio.is_homogeneous, studio.homogeneous, studio.lighting, {}, studio.exposure};
}

struct SceneFile : testing::Test {
  StateFolder folder;
  Studio studio;
  SceneFile() {
    start_small(studio, folder);
    studio.use_transport = false;
    studio.still = Still::draft;
  }
  void open(const std::string& path) {
    open_file(studio, path);
    run(studio);
    for (const Message& message : studio.messages) EXPECT_FALSE(message.is_error) << message.text;
  }
};

TEST_F(SceneFile, IsShownAsItIsRendered) {
  for (const Document& material :
       {object({{"file", "map.h5"}}), object({{"sigma_a", array({0.01, 0.02, 0.1})},
                                              {"sigma_s_prime", 2},
                                              {"model", "better"},
                                              {"thickness_mm", 3}})}) {
    const std::string path = write_rich_scene(folder.path + "/files", material);
    open(path);
    const Scene wanted = load_scene(path).scene;
    const Scene shown = shown_scene(studio);
    ASSERT_EQ(shown.lights.size(), wanted.lights.size());
    ASSERT_EQ(shown.lights.size(), 4u);
    EXPECT_EQ(std::get<DirectionalLight>(shown.lights[0]).direction,
              std::get<DirectionalLight>(wanted.lights[0]).direction);
    EXPECT_EQ(std::get<PointLight>(shown.lights[3]).intensity, (Rgb{900, 1500, 2500}));
    ASSERT_EQ(shown.layers.size(), 1u);
    EXPECT_EQ(studio.layers.size(), 2u);
    EXPECT_EQ(shown.layers[0].range, 0.5);
    EXPECT_EQ(studio.exposure, 0.5);
    EXPECT_LT(largest_difference(shown, wanted), 1e-3);
  }
}

TEST_F(SceneFile, IsWrittenAndReadBack) {
  open(write_rich_scene(folder.path + "/files", object({{"file", "map.h5"}})));
  studio.lighting[0].enabled = false;
  turn_light(studio.lighting[3], 20, 5, center(studio.stage->box));
  turn(studio.orbit, 10, 5, 48);
  SurfaceLayer layer = *studio.layers[0];
  layer.opacity = 0.75;
  layer.mask = make_mask(6, *studio.stage);
  set_stage_layer(studio, 0, layer);
  run(studio);
  const Scene shown = shown_scene(studio);
  const SceneState before = state_of(studio);
  const Orbit orbit = studio.orbit;
  const std::string path = folder.path + "/other/saved.json";
  std::filesystem::create_directories(folder.path + "/other");
  save_scene(studio, path);
  run(studio);
  // Nothing but the file: the map is where it was.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path + "/other"), {}), 1);
  EXPECT_EQ(as_string(get(get(load_document(path), "material"), "file")), "../files/map.h5");
  // What it is rendered to is what was shown.
  EXPECT_LT(largest_difference(load_scene(path).scene, shown), 1e-3);
  start_studio(studio, {folder.path, PARIAN_SOURCE_DIR "/data"});
  EXPECT_NE(state_of(studio), before);
  open(path);
  SceneState after = state_of(studio);
  ASSERT_EQ(after.lighting.size(), before.lighting.size());
  for (std::size_t i = 0; i < after.lighting.size(); ++i) {
    const auto& then = before.lighting[i].sky;
    if (then != nullptr) {
      EXPECT_EQ(after.lighting[i].sky->image.values, then->image.values);
    }
    after.lighting[i].sky = then;  // another one of the same
  }
  EXPECT_EQ(after, before);
  EXPECT_NEAR(studio.orbit.yaw_deg, orbit.yaw_deg, 1e-3);
  EXPECT_NEAR(studio.orbit.pitch_deg, orbit.pitch_deg, 1e-3);
  EXPECT_NEAR(studio.orbit.roll_deg, orbit.roll_deg, 1e-3);
  EXPECT_NEAR(studio.orbit.distance_mm, orbit.distance_mm, 1e-3);
  ASSERT_EQ(studio.layers.size(), 2u);
  EXPECT_EQ(studio.layers[0]->opacity, 0.75);
  EXPECT_EQ(std::get<StripesMask>(studio.layers[0]->mask.at(0).shape).period_mm,
            std::get<StripesMask>(layer.mask[0].shape).period_mm);
  EXPECT_FALSE(studio.layers[1]->enabled);
  EXPECT_EQ(studio.layers[1]->material_name, "wax");
}

TEST_F(SceneFile, AnEditedMapIsWrittenBesideIt) {
  open(write_rich_scene(folder.path + "/files", object({{"file", "map.h5"}})));
  add_layer(studio, make_adjust(2));
  studio.editor->wait();
  run(studio);
  const Scene shown = shown_scene(studio);
  const std::string path = folder.path + "/files/edited.json";
  save_scene(studio, path);
  run(studio);
  EXPECT_EQ(as_string(get(get(load_document(path), "material"), "file")), "edited-material.h5");
  EXPECT_LT(largest_difference(load_scene(path).scene, shown), 1e-3);
  // Opened, edited and saved again it does not replace what is being edited.
  open(path);
  add_layer(studio, make_adjust(0.5));
  studio.editor->wait();
  run(studio);
  save_scene(studio, path);
  run(studio);
  EXPECT_EQ(as_string(get(get(load_document(path), "material"), "file")), "edited-material-2.h5");
}

TEST_F(SceneFile, CoefficientsAreInIt) {
  Dipole material = first_homogeneous();
  material.channels[1].g = 0.25;
  material.eta = 1.45;
  set_homogeneous(studio, material);
  studio.lighting.push_back({.kind = LightKind::point, .place = {10, 50, 0}, .power = {9, 9, 9}});
  run(studio);
  const std::string path = folder.path + "/homogeneous.json";
  save_scene(studio, path);
  run(studio);
  start_studio(studio, {folder.path, PARIAN_SOURCE_DIR "/data"});
  ASSERT_FALSE(studio.is_homogeneous);
  open(path);
  EXPECT_TRUE(studio.is_homogeneous);
  EXPECT_EQ(studio.homogeneous, material);
  EXPECT_EQ(studio.lighting.size(), 3u);
}

TEST_F(SceneFile, WhatCannotBeWrittenIsAMessage) {
  run(studio);
  save_scene(studio, "/no/such/folder/scene.json");
  run(studio);
  ASSERT_FALSE(studio.messages.empty());
  EXPECT_TRUE(studio.messages.back().is_error);
  EXPECT_NE(studio.messages.back().text.find("/no/such/folder"), std::string::npos);
}

TEST_F(SceneFile, LayersAreAddedMovedAndUndone) {
  save_profile_map(folder.path + "/over.h5", make_map());
  run(studio);
  open_layer(studio, folder.path + "/over.h5");
  run(studio);
  ASSERT_EQ(studio.layers.size(), 1u);
  EXPECT_EQ(studio.selected_stage_layer, 0u);
  note_scene_now(studio);
  add_stage_layer(studio, *studio.layers[0]);
  note_scene_now(studio);
  move_stage_layer(studio, 1, 0);
  note_scene_now(studio);
  remove_stage_layer(studio, 0);
  note_scene_now(studio);
  EXPECT_EQ(studio.layers.size(), 1u);
  undo(studio);
  undo(studio);
  EXPECT_EQ(studio.layers.size(), 2u);
  undo(studio);
  EXPECT_EQ(studio.layers.size(), 1u);
  // One of another boundary cannot lie there: it waits.
  run(studio);
  EXPECT_EQ(shown_layers(studio).size(), 1u);
  Dipole other = first_homogeneous();
  other.eta = 1.7;
  set_homogeneous(studio, other);
  EXPECT_TRUE(shown_layers(studio).empty());
  EXPECT_NE(why_not(*studio.layers[0], *studio.stage, *studio.material).find("eta"),
            std::string::npos);
  run(studio);
  EXPECT_NE(studio.picture, nullptr);
}

TEST(StageLayers, MasksAreOfTheirKindAndFitTheMesh) {
  const auto stage = make_plain_stage(make_shape("fin"), {.shape = "fin"});
  for (std::size_t kind = 0; kind + 1 < mask_kind_names().size(); ++kind) {
    const SurfaceMask mask = make_mask(kind, *stage);
    EXPECT_EQ(mask_kind_of(mask), kind);
    EXPECT_NO_THROW(check(mask, stage->scene.mesh, {}, {}));
    double least = 1, most = 0;
    for (std::uint32_t t = 0; t < stage->scene.mesh.triangles.size(); ++t) {
      const double weight =
          eval_mask(mask, stage->scene.mesh, get_surface_point(stage->scene.mesh, t, {0.3f, 0.3f}));
      least = std::min(least, weight);
      most = std::max(most, weight);
    }
    EXPECT_TRUE(mask_kind_names()[kind] == "painted" || most > 0.9) << mask_kind_names()[kind];
    EXPECT_TRUE(kind == 0 || least < 0.1) << mask_kind_names()[kind];
  }
  EXPECT_EQ(mask_kind_of({{VertexMask{{}, "w.json"}}}), mask_kind_names().size() - 1);
}

// Also where the recipe is empty.
void expect_recovery(std::size_t layers) {
  const StateFolder folder;
  Dipole material = first_homogeneous();
  material.channels[0].sigma_a = 0.5;
  Lighting lighting;
  Orbit orbit;
  {
    Studio studio;
    start_small(studio, folder);
    studio.use_transport = false;
    studio.still = Still::draft;
    run(studio);
    update(studio, studio.last_change_s + 1);
    turn_light(studio.lighting[0], 30, 0, {});
    set_homogeneous(studio, material);
    turn(studio.orbit, 10, 0, 48);
    if (layers > 0) add_layer(studio, make_adjust(0.5));
    studio.editor->wait();
    run(studio);
    update(studio, studio.last_change_s + 10);
    update(studio, studio.last_change_s + 20);
    lighting = studio.lighting;
    orbit = studio.orbit;
  }
  Studio studio;
  start_small(studio, folder);
  studio.use_transport = false;
  studio.still = Still::draft;
  ASSERT_TRUE(studio.recoverable);
  recover(studio);
  run(studio);
  EXPECT_TRUE(studio.is_homogeneous);
  EXPECT_EQ(studio.homogeneous, material);
  ASSERT_EQ(studio.lighting.size(), 2u);
  EXPECT_EQ(studio.lighting[0], lighting[0]);
  EXPECT_NEAR(studio.orbit.yaw_deg, orbit.yaw_deg, 1e-3);
  EXPECT_EQ(studio.snapshot->layers.size(), layers);
  leave_homogeneous(studio);
  EXPECT_TRUE(std::holds_alternative<ProfileMap>(*studio.material));
  finish_studio(studio);
}

TEST(Studio, RecoversLightsAndCoefficients) {
  expect_recovery(1);
  expect_recovery(0);
}

}  // namespace
}  // namespace parian

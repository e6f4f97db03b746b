#include "app/studio/mask_tool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "app/cli/inputs.h"
#include "app/studio/scene_file.h"
#include "app/studio/stage_layers.h"
#include "app/studio/test_studio_internal.h"
#include "io/json/json.h"
#include "mesh/shapes.h"
#include "mesh/test_meshes.h"

namespace parian {
namespace {

using Weights = std::vector<float>;

// A dipole of another colour over the small map, on a ball.
struct MaskToolTest : testing::Test {
  StateFolder folder;
  Studio studio;

  void SetUp() override {
    std::filesystem::create_directories(folder.path + "/files");
    start(studio);
    set_homogeneous(studio, first_homogeneous());
    show_stage(studio, make_plain_stage(make_shape("sphere"), {.shape = "sphere"}), "sphere");
    SurfaceLayer layer;
    Dipole red = first_homogeneous();
    red.channels[1].sigma_a = red.channels[2].sigma_a = 0.5;
    layer.material = std::make_shared<const Material>(red);
    layer.material_name = "red";
    add_stage_layer(studio, layer);
    note_scene_now(studio);
    studio.messages.clear();
    studio.mask.brush = {.radius_mm = 8, .softness = 0.3};
  }
  void start(Studio& other) const {
    start_small(other, folder);
    other.use_transport = false;
    other.still = Still::draft;
  }
  // Across the middle of the view.
  void draw(bool erases = false, double from = 0.4, double to = 0.6) {
    const std::array a{from * studio.view_width, 0.5 * studio.view_height},
        b{to * studio.view_width, 0.5 * studio.view_height};
    begin_mask_stroke(studio, erases);
    extend_mask_stroke(studio, a, a);
    extend_mask_stroke(studio, a, b);
    finish_mask_stroke(studio);
  }
  void set_mask(const SurfaceMask& mask) {
    SurfaceLayer layer = *studio.layers[0];
    layer.mask = mask;
    set_stage_layer(studio, 0, layer);
    note_scene_now(studio);
  }
  const Weights& weights() const {
    return std::get<VertexMask>(studio.layers.at(0)->mask.at(0).shape).weights;
  }
  std::string last_message() const {
    return studio.messages.empty() ? "" : studio.messages.back().text;
  }
};

double mean(const Weights& weights) {
  double sum = 0;
  for (const float w : weights) sum += static_cast<double>(w);
  return sum / static_cast<double>(weights.size());
}

TEST_F(MaskToolTest, PaintsFromNothingAndErasesFromAll) {
  draw();
  EXPECT_EQ(last_message(), "red lies where it is painted now");
  EXPECT_EQ(mask_kind_names()[mask_kind_of(studio.layers[0]->mask)], "painted");
  const double painted = mean(weights());
  EXPECT_GT(painted, 0.005);
  EXPECT_LT(painted, 0.1);
  EXPECT_EQ(*std::max_element(weights().begin(), weights().end()), 1);
  // On the side that the camera sees alone.
  const Vec3 middle = center(studio.stage->box);
  const Vec3 eye = make_view_camera(studio, 1).position - middle;
  for (std::size_t v = 0; v < weights().size(); ++v)
    if (weights()[v] > 0) {
      EXPECT_GT(dot(studio.stage->scene.mesh.positions[v] - middle, eye), 0);
    }
  draw(true);
  EXPECT_LT(mean(weights()), 0.3 * painted);
  fill_mask(studio, 1);
  draw(true);
  EXPECT_NEAR(mean(weights()), 1 - painted, 2e-3);
  set_mask({});
  draw(true);
  EXPECT_NEAR(mean(weights()), 1 - painted, 2e-3);
}

TEST_F(MaskToolTest, AStrokeIsOneEntry) {
  const std::size_t entries = studio.scene_history.done.size();
  draw();
  const Weights first = weights();
  draw(false, 0.3, 0.4);
  const Weights second = weights();
  EXPECT_NE(first, second);
  note_scene_now(studio);
  ASSERT_EQ(studio.scene_history.done.size(), entries + 2);
  EXPECT_EQ(studio.scene_history.done.back().label, "mask of red");
  undo(studio);
  EXPECT_EQ(weights(), first);
  undo(studio);
  EXPECT_TRUE(studio.layers[0]->mask.empty());
  redo(studio);
  redo(studio);
  EXPECT_EQ(weights(), second);
}

TEST_F(MaskToolTest, PaintsOnTheMaskThatIsThere) {
  const Vec3 middle = center(studio.stage->box);
  const SurfaceMask slab{{SlabMask{middle, {0, -1, 0}, 0, 5}}};
  const Weights below = sample_at_vertices(slab, studio.stage->scene.mesh).weights;
  set_mask(slab);
  draw();
  EXPECT_EQ(last_message(), "the mask of red is painted at the mesh's vertices now");
  std::size_t more = 0;
  for (std::size_t v = 0; v < below.size(); ++v) {
    EXPECT_GE(weights()[v], below[v]);
    more += weights()[v] > below[v] ? 1 : 0;
  }
  EXPECT_GT(more, 20u);
  // An inverted one is painted as it is seen.
  set_mask({{VertexMask{below}, true}});
  draw();
  EXPECT_FALSE(studio.layers[0]->mask[0].invert);
  for (std::size_t v = 0; v < below.size(); ++v) EXPECT_GE(weights()[v], 0.999f - below[v]);
}

TEST_F(MaskToolTest, SaysWhatIsMissing) {
  const StageLayers layers = studio.layers;
  const auto expect_nothing = [&](const std::string& message) {
    draw();
    EXPECT_EQ(last_message(), message);
    for (const auto& layer : studio.layers) EXPECT_TRUE(layer->mask.empty());
  };
  SurfaceLayer layer = *layers[0];
  layer.enabled = false;
  set_stage_layer(studio, 0, layer);
  expect_nothing("red is switched off under Surface");
  studio.layers = {layers[0], layers[0]};
  studio.selected_stage_layer.reset();
  expect_nothing("choose a layer under Surface first: its mask is painted");
  studio.layers.clear();
  expect_nothing("add a material under Surface first: the tool 'mask' paints where it lies");
  studio.layers = layers;
  Dipole other = first_homogeneous();
  other.eta = 1.5;
  set_homogeneous(studio, other);
  expect_nothing(why_not(*layers[0], *studio.stage, *studio.material));
  EXPECT_NE(last_message().find("eta"), std::string::npos);
}

TEST_F(MaskToolTest, WhatGoesAwayWhileItIsPaintedEndsTheStroke) {
  const std::array from{20.0, 24.0}, to{44.0, 24.0};
  begin_mask_stroke(studio, false);
  extend_mask_stroke(studio, from, from);
  const Weights before = weights();
  set_mask({{VertexMask{before}}});  // another one from now on
  extend_mask_stroke(studio, from, to);
  EXPECT_EQ(weights(), before);
  EXPECT_FALSE(studio.mask.stroke);
  begin_mask_stroke(studio, false);
  studio.layers.clear();
  extend_mask_stroke(studio, from, to);
  EXPECT_FALSE(studio.mask.stroke);
}

TEST_F(MaskToolTest, AnotherMeshBeginsAnew) {
  draw();
  show_stage(studio, make_plain_stage(make_shape("box"), {.shape = "box"}), "box");
  EXPECT_TRUE(shown_layers(studio).empty());
  draw();
  EXPECT_EQ(weights().size(), studio.stage->scene.mesh.positions.size());
  EXPECT_EQ(shown_layers(studio).size(), 1u);
  EXPECT_GT(mean(weights()), 0);
  EXPECT_LT(mean(weights()), 0.2);
}

TEST_F(MaskToolTest, IsSavedBesideItsScene) {
  const std::string path = folder.path + "/files/ball.json";
  const auto save = [&] {
    save_scene(studio, path);
    run(studio);
  };
  draw();
  save();
  const Weights first = weights();
  const LoadedScene loaded = load_scene(path);
  const auto& mask = std::get<VertexMask>(loaded.scene.layers.at(0).mask.at(0).shape);
  EXPECT_EQ(mask.file, "ball-mask-1.json");
  EXPECT_EQ(mask.weights, first);
  Scene shown = make_scene(*studio.stage, *studio.material, shown_layers(studio), studio.lighting,
                           make_view_camera(studio, 1));
  EXPECT_LT(largest_difference(shown, loaded.scene), 1e-3);
  // Opened again and painted, it leaves the file alone that undo may come back to.
  open_file(studio, path);
  run(studio);
  ASSERT_EQ(weights(), first);
  studio.selected_stage_layer = 0;
  note_scene_now(studio);
  draw(false, 0.2, 0.5);
  const Weights second = weights();
  save();
  EXPECT_EQ(std::get<VertexMask>(load_scene(path).scene.layers[0].mask[0].shape).weights, second);
  undo(studio);
  save();
  EXPECT_EQ(std::get<VertexMask>(load_scene(path).scene.layers[0].mask[0].shape).weights, first);
}

std::size_t count_masks(const std::string& folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    count += entry.path().filename().string().find("-mask-") != std::string::npos ? 1 : 0;
  return count;
}

TEST_F(MaskToolTest, IsAutosavedAndRecovered) {
  const auto rest = [&] {
    run(studio);
    update(studio, studio.last_change_s + 10);
  };
  draw();
  rest();
  EXPECT_EQ(count_masks(folder.path), 1u);
  draw(false, 0.2, 0.5);
  rest();
  EXPECT_EQ(count_masks(folder.path), 1u);  // the one before is not needed
  const Weights painted = weights();
  Studio other;
  start(other);
  ASSERT_TRUE(other.recoverable);
  recover(other);
  run(other);
  ASSERT_EQ(other.layers.size(), 1u);
  const auto& mask = std::get<VertexMask>(other.layers[0]->mask.at(0).shape);
  EXPECT_EQ(mask.weights, painted);
  EXPECT_EQ(mask.file, "");  // it is nobody's
  finish_studio(other);
  EXPECT_EQ(count_masks(folder.path), 0u);
}

}  // namespace
}  // namespace parian

// Splatting against the CPU renderer, for every kind of material and light, on meshes with thin
// parts; and what it must conserve.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "tests/splat/compare_pictures.h"
#include "tests/splat/scenes.h"

namespace parian {
namespace {

using namespace splat_scenes;

void expect_like_reference(const Scene& scene, const std::string& name) {
  const OffscreenContext context;
  SplatRenderer renderer(context.limits(), scene, make_params());
  renderer.draw();
  const Image image = renderer.read();
  const Image reference = render_reference(scene, samples, rays);
  for (const float value : image.values) ASSERT_TRUE(std::isfinite(value));
  expect_close(reference, image, renderer.coverage(), "parian-splat-" + name);
}

TEST(Splat, ProfileMapUnderASun) {
  expect_like_reference(
      make_scene(make_knot(2), Material(make_chequered_map()), {make_sun({1, 2, 1})}), "map");
}

TEST(Splat, ProfileMapUnderASkyWithFresnelLosses) {
  expect_like_reference(
      make_scene(make_knot(2), Material(make_chequered_map(Boundary::excluded)), {make_sky()}),
      "map-sky");
}

TEST(Splat, BlendUnderTwoLamps) {
  expect_like_reference(make_scene(make_knot(2), Material(make_mixed_blend()),
                                   {PointLight{{60, 60, 40}, {9000, 9000, 9000}},
                                    PointLight{{-70, 10, 30}, {6000, 4000, 2000}}}),
                        "blend");
}

TEST(Splat, BlendWithAGainUnderASun) {
  ProfileBlend blend = make_mixed_blend();
  for (std::size_t i = 0; i < 3 * blend.pixels(); ++i)
    blend.gain.push_back((i / 6) % 2 == 0 ? 1.0f : 0.5f);
  check(blend, "test blend");
  expect_like_reference(make_scene(make_knot(2), Material(blend), {make_sun({-1, 1, 1})}),
                        "blend-gain");
}

TEST(Splat, HomogeneousMarble) {
  expect_like_reference(
      make_scene(make_knot(2), Material(make_marble()), {make_sun({-1, 1, 1}), make_sky()}),
      "marble");
}

TEST(Splat, ThinSheetLitFromBehind) {
  expect_like_reference(
      make_scene(make_fin(2), Material(make_chequered_map()), {make_sun({-0.3f, 0.4f, -1})}),
      "fin");
}

// A gradient into another map, and a ball of a third material whose albedo alone counts.
TEST(Splat, LayersOverAMap) {
  Scene scene = make_scene(make_knot(2), Material(make_chequered_map()), {make_sun({1, 2, 1})});
  ProfileMap pale = make_chequered_map();
  for (float& value : pale.log_profile) value = 0.8f * value - 0.7f;
  SurfaceLayer gradient;
  gradient.material = std::make_shared<const Material>(pale);
  gradient.mask = {{GradientMask{{-15, 0, 0}, {15, 0, 0}}}};
  SurfaceLayer ball;
  ball.material = std::make_shared<const Material>(make_mixed_blend());
  ball.mask = {{SphereMask{center(bounds(scene.mesh)) + Vec3{12, 0, 8}, 12, 2}}};
  ball.range = ball.shape = 0;
  scene.layers = {gradient, ball};
  expect_like_reference(scene, "layers");
}

TEST(Splat, LayersFollowMaterialAndCamera) {
  Scene scene = make_scene(make_knot(1), Material(make_chequered_map()), {make_sun({1, 2, 1})});
  SurfaceLayer layer;
  layer.material = std::make_shared<const Material>(make_mixed_blend());
  layer.mask = {{GradientMask{{-15, 0, 0}, {15, 0, 0}}}};
  scene.layers = {layer};
  SplatParams params = make_params();
  params.samples = 3000;
  params.antialias = 2;
  const OffscreenContext context;
  SplatRenderer renderer(context.limits(), scene, params);
  renderer.draw();
  const Image first = renderer.read();
  Scene other = scene;
  other.camera.position = scene.camera.target + Vec3{0, 100, 80};
  other.material = Material(make_mixed_blend());
  renderer.set_camera(other.camera);
  renderer.set_material(std::get<Material>(other.material));
  renderer.draw();
  const Image second = renderer.read();
  SplatRenderer fresh(context.limits(), other, params);
  fresh.draw();
  EXPECT_EQ(second.values, fresh.read().values);
  renderer.set_exposure(1);
  renderer.draw();
  const Image brighter = renderer.read();
  for (std::size_t i = 0; i < second.values.size(); ++i)
    EXPECT_FLOAT_EQ(brighter.values[i], 2 * second.values[i]);  // before black
  renderer.set_exposure(0);
  renderer.set_camera(scene.camera);
  renderer.set_material(std::get<Material>(scene.material));
  renderer.draw();
  EXPECT_EQ(renderer.read().values, first.values);
  // Without layers and with others.
  for (const double opacity : {0.0, 0.5}) {
    other = scene;
    other.layers[0].opacity = opacity;
    if (opacity == 0) other.layers.clear();
    renderer.set_material(std::get<Material>(other.material), other.layers);
    renderer.draw();
    SplatRenderer changed(context.limits(), other, params);
    changed.draw();
    EXPECT_EQ(renderer.read().values, changed.read().values) << opacity;
  }
}

// Gives up at the n-th question; true: it was asked as often.
template <typename Work>
bool cancel_at(int n, const Work& work) {
  int asked = 0;
  try {
    work(Progress{.is_cancelled = [&] { return asked++ == n; }});
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::cancelled);
  }
  return asked > n;
}

// Wherever a picture of layers, or the light, is given up, the next one is whole.
TEST(Splat, WhatIsCancelledLeavesNothingBehind) {
  Scene scene =
      make_scene(make_knot(1), Material(make_chequered_map()), {make_sun({1, 2, 1}), make_sky()});
  SurfaceLayer layer;
  layer.material = std::make_shared<const Material>(make_mixed_blend());
  layer.mask = {{GradientMask{{-15, 0, 0}, {15, 0, 0}}}};
  scene.layers = {layer};
  scene.specular.enabled = true;
  scene.camera.width = 80;
  scene.camera.height = 60;
  SplatParams params = make_params();
  params.samples = 3000;
  const OffscreenContext context;
  SplatRenderer fresh(context.limits(), scene, params);
  fresh.draw();
  const Image wanted = fresh.read();
  int stages = 0;
  for (bool was_asked = true; was_asked; ++stages) {
    SplatRenderer renderer(context.limits(), scene, params);
    was_asked = cancel_at(stages, [&](const Progress& p) { renderer.draw(true, p); });
    renderer.draw(true);
    EXPECT_EQ(renderer.read().values, wanted.values) << stages;
  }
  EXPECT_GT(stages, 2);
  // The lights before, where others were given up.
  EXPECT_TRUE(cancel_at(0, [&](const Progress& p) {
    fresh.set_lights({make_sun({-1, 1, 1})}, p);
  }));
  fresh.draw(true);
  EXPECT_EQ(fresh.read().values, wanted.values);
}

// So near that splats cover more than the largest points, and some lie around the camera.
TEST(Splat, FromVeryNear) {
  Scene scene = make_scene(make_knot(2), Material(make_chequered_map()), {make_sun({1, 2, 1})});
  scene.camera.target = scene.mesh.positions[0];
  scene.camera.position = scene.camera.target + scene.mesh.normals[0] * 12.0f;
  scene.camera.fov_deg = 60;
  expect_like_reference(scene, "near");
}

}  // namespace
}  // namespace parian

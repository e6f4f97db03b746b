// Splatting against the CPU renderer, for every kind of material and light, on meshes with thin
// parts; and what it must conserve.
#include <gtest/gtest.h>

#include <cmath>

#include "mesh/shapes.h"
#include "scene/camera.h"
#include "scene/environment.h"
#include "tests/splat/compare_pictures.h"

namespace parian {
namespace {

constexpr int samples = 40000, rays = 64;

// Two materials in a chequer of two, 16 x 16 pixels of 1 mm: mean free paths and albedos differ.
ProfileMap make_chequered_map(Boundary boundary = Boundary::included) {
  std::vector<double> knots;
  for (int k = 0; k <= 10; ++k) knots.push_back(0.9 * k);
  ProfileMap map = make_profile_map(16, 16, 3, 1.0, knots);
  map.boundary = boundary;
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k <= 10; ++k)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
          const bool dark = ((x / 4) + (y / 4)) % 2 == 0;
          const double length = (dark ? 1.2 : 2.0) * (c == 0 ? 1.2 : c == 1 ? 1.0 : 0.8);
          const double albedo = dark ? 0.3 + 0.1 * c : 0.8 - 0.1 * c;
          knot_plane(map, c, k)[y * 16 + x] = static_cast<float>(
              std::log(albedo / (2 * 3.14159265358979 * length * length)) - 0.9 * k / length);
        }
  return map;
}

// Six bases from narrow to wide, two per pixel, mixed smoothly over the plane.
ProfileBlend make_mixed_blend() {
  ProfileBlend blend;
  blend.width = blend.height = 24;
  blend.pixel_pitch_mm = 0.8;
  blend.boundary = Boundary::included;
  for (int k = 0; k <= 10; ++k) blend.knots_mm.push_back(0.8 * k);
  for (int base = 0; base < 6; ++base)
    for (int c = 0; c < 3; ++c) {
      const double length = 0.9 + 0.3 * base - 0.1 * c, albedo = 0.35 + 0.08 * ((base + c) % 6);
      for (const double knot : blend.knots_mm)
        blend.base_log_profile.push_back(static_cast<float>(
            std::log(albedo / (2 * 3.14159265358979 * length * length)) - knot / length));
    }
  const std::size_t pixels = blend.pixels();
  blend.index.resize(2 * pixels);
  blend.weight.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::size_t row = i / 24;
    const double x = static_cast<double>(i % 24), y = static_cast<double>(row);
    blend.index[i] = static_cast<std::uint16_t>((i / 4) % 6);
    blend.index[pixels + i] = static_cast<std::uint16_t>((row / 3) % 6);
    blend.weight[i] = static_cast<float>(0.5 + 0.5 * std::sin(0.7 * x) * std::cos(0.5 * y));
  }
  check(blend, "test blend");
  return blend;
}

Dipole make_marble() {
  Dipole marble;
  marble.channels = {{0.0021, 2.19, 0}, {0.0041, 2.62, 0}, {0.0071, 3.0, 0}};
  marble.eta = 1.5;
  return marble;
}

Scene make_scene(TriangleMesh mesh, SurfaceMaterial material, std::vector<Light> lights) {
  Scene scene;
  clean_mesh(mesh, "test mesh");
  fit_to_size(mesh, 50);
  scene.mesh = std::move(mesh);
  scene.mesh_name = "test mesh";
  scene.material = std::move(material);
  scene.lights = std::move(lights);
  scene.camera.width = 200;
  scene.camera.height = 150;
  scene.camera.target = center(bounds(scene.mesh));
  scene.specular.enabled = false;
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

Light make_sun(Vec3 direction) {
  return DirectionalLight{normalize(direction), {3, 2.8f, 2.5f}};
}
Light make_sky() {
  EnvironmentLight light;
  light.image = make_sky_image(64, 32);
  return light;
}

SplatParams make_params() {
  SplatParams params;
  params.samples = samples;
  params.rays = rays;
  params.antialias = 1;
  return params;
}

void expect_like_reference(const Scene& scene, const std::string& name) {
  const OffscreenContext context;
  SplatRenderer renderer(context.limits(), scene, make_params());
  renderer.draw();
  const Image image = renderer.read();
  const Image reference = render_reference(scene, samples, rays);
  const RelativeErrors errors = relative_errors(reference, image, renderer.coverage());
  EXPECT_GT(errors.pixels, 2000u);
  EXPECT_LE(errors.mean, 0.02);
  EXPECT_LE(errors.p99, 0.08);
  ::testing::Test::RecordProperty("mean", std::to_string(errors.mean));
  ::testing::Test::RecordProperty("p99", std::to_string(errors.p99));
  if (::testing::Test::HasFailure())
    ADD_FAILURE() << dump_pictures("parian-splat-" + name, reference, image);
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
  gradient.material = pale;
  gradient.mask = {{GradientMask{{-15, 0, 0}, {15, 0, 0}}}};
  SurfaceLayer ball;
  ball.material = make_mixed_blend();
  ball.mask = {{SphereMask{center(bounds(scene.mesh)) + Vec3{12, 0, 8}, 12, 2}}};
  ball.range = ball.shape = 0;
  scene.layers = {gradient, ball};
  expect_like_reference(scene, "layers");
}

TEST(Splat, LayersFollowMaterialAndCamera) {
  Scene scene = make_scene(make_knot(1), Material(make_chequered_map()), {make_sun({1, 2, 1})});
  SurfaceLayer layer;
  layer.material = make_mixed_blend();
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
  renderer.set_camera(scene.camera);
  renderer.set_material(std::get<Material>(scene.material));
  renderer.draw();
  EXPECT_EQ(renderer.read().values, first.values);
}

}  // namespace
}  // namespace parian

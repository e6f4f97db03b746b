// Pictures compared with stored references (tests/golden). On a mismatch the picture, the reference
// and their difference are written beside the test's working directory. To store a picture anew:
// PARIAN_UPDATE_GOLDEN=1 test_cross --gtest_filter='golden*', then look at it.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "io/image/image_file.h"
#include "mesh/shapes.h"
#include "render/render.h"
#include "scene/camera.h"
#include "scene/environment.h"

namespace parian {
namespace {

// The largest difference that the sampling of another compiler may make, relative to the picture's
// mean, and the same for the mean difference.
constexpr double largest_difference = 0.25;
constexpr double mean_difference = 0.01;

void expect_golden(const Image& image, const std::string& name) {
  const std::string path = PARIAN_SOURCE_DIR "/tests/golden/" + name + ".exr";
  if (std::getenv("PARIAN_UPDATE_GOLDEN")) save_image(path, image);
  const Image reference = load_image(path);
  ASSERT_EQ(image.width, reference.width);
  ASSERT_EQ(image.height, reference.height);
  ASSERT_EQ(image.channels, reference.channels);
  Image difference = image;
  double mean = 0, apart = 0, most = 0;
  for (std::size_t i = 0; i < image.values.size(); ++i) {
    difference.values[i] = std::abs(image.values[i] - reference.values[i]);
    mean += static_cast<double>(reference.values[i]);
    apart += static_cast<double>(difference.values[i]);
    most = std::max(most, static_cast<double>(difference.values[i]));
  }
  const auto count = static_cast<double>(image.values.size());
  mean /= count;
  apart /= count;
  if (most <= largest_difference * mean && apart <= mean_difference * mean) return;
  save_image(name + "-found.exr", image);
  save_image(name + "-reference.exr", reference);
  save_image(name + "-difference.exr", difference);
  ADD_FAILURE() << name << ": relative to the mean of " << mean << ", the difference is "
                << apart / mean << " on average and " << most / mean << " at most; see " << name
                << "-{found,reference,difference}.exr in the working directory";
}

Scene make_golden_scene(const char* shape, SurfaceMaterial material) {
  Scene scene;
  scene.mesh = make_shape(shape);
  clean_mesh(scene.mesh, shape);
  fit_to_size(scene.mesh, 30);
  scene.mesh_name = shape;
  scene.material = std::move(material);
  scene.lights = {EnvironmentLight{.image = make_sky_image(128, 64)}};
  scene.camera.width = 64;
  scene.camera.height = 48;
  scene.camera.target = center(bounds(scene.mesh));
  scene.background = {0.05f, 0.05f, 0.05f};
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

RenderParams golden_params() {
  RenderParams params;
  params.samples = 10000;
  params.rays = 64;
  return params;
}

Dipole make_jade() {
  return {{{0.03, 0.9}, {0.012, 1.1}, {0.04, 1.0}}, 1.5};
}

// Two kinds of stone in bands, 1/mm^2 over 4 mm.
ProfileMap make_bands() {
  ProfileMap map = make_profile_map(16, 16, 3, 0.5, {0, 0.5, 1, 2, 3, 4});
  const float lengths[3] = {0.9f, 0.7f, 0.5f};
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 6; ++k)
      for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
          const bool is_band = (x + y) % 8 < 3;
          const float length = lengths[c] * (is_band ? 0.5f : 1.0f);
          const float scale = is_band ? 0.4f : 0.8f;
          knot_plane(map, c, k)[y * 16 + x] =
              std::log(scale / (6.2832f * length * length)) -
              static_cast<float>(map.knots_mm[static_cast<std::size_t>(k)]) / length;
        }
  return map;
}

TEST(golden, jade_knot_under_the_sky) {
  const Scene scene = make_golden_scene("knot", Material(make_jade()));
  expect_golden(render(scene, golden_params()).image, "render-knot");
}

TEST(golden, banded_fin_from_a_profile_map_and_from_its_table) {
  Scene scene = make_golden_scene("fin", Material(make_bands()));
  expect_golden(render(scene, golden_params()).image, "render-fin-map");
  const Material material = make_bands();
  scene.material = read_table(*make_slices(material, natural_header(material)));
  expect_golden(render(scene, golden_params()).image, "render-fin-table");
}

TEST(golden, slab_lit_from_behind_by_brute_force) {
  const Dipole wax = {{{0.002, 1.0}, {0.01, 0.9}, {0.05, 0.8}}, 1.4};
  Scene scene = make_golden_scene("slab", Material(wax));
  const Vec3 middle = center(bounds(scene.mesh));
  scene.camera.position = middle + Vec3{20, 15, 60};
  scene.camera.target = middle;
  scene.lights = {PointLight{.position = middle - Vec3{5, 0, 25}, .intensity = {2000, 1900, 1700}}};
  RenderParams params = golden_params();
  params.method = GatherMethod::brute;
  expect_golden(render(scene, params).image, "render-slab");
}

TEST(golden, sphere_shaded_at_its_vertices) {
  Scene scene = make_golden_scene("sphere", Material(make_jade()));
  scene.lights = {DirectionalLight{.direction = normalize(Vec3{-1, 1, 0.3f})}};
  RenderParams params = golden_params();
  params.shading = Shading::vertex;
  expect_golden(render(scene, params).image, "render-sphere");
}

}  // namespace
}  // namespace parian

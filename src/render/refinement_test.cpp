#include "render/refinement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/parallel.h"
#include "base/test_errors.h"
#include "render/test_scenes.h"

namespace parian {
namespace {

using namespace testing_scenes;

// Stripes whose profiles reach over a good part of a small sphere.
Scene make_striped_scene(SurfaceMaterial material = Material(make_striped_map(1.5))) {
  Scene scene = make_scene(make_sphere(3), 20, std::move(material), 36, 28);
  scene.lights = {DirectionalLight{normalize({0.5f, 0.7f, 0.6f}), {1, 0.8f, 0.6f}}};
  return scene;
}

RefinementParams few_params() {
  RefinementParams params;
  params.render = quick_params();
  params.render.samples = 3000;
  params.render.antialias = 2;
  params.render.quality = 0.1;
  params.tile = 10;
  params.first_tolerance = 0.4;
  return params;
}

Image render_brute(const Scene& scene, const RefinementParams& params) {
  RenderParams all = params.render;
  all.method = GatherMethod::brute;
  return render(scene, all).image;
}

void finish(Refinement& refinement) {
  while (!refinement.is_done()) refinement.advance();
}

// Until a pass has ended.
void finish_pass(Refinement& refinement) {
  do refinement.advance();
  while (refinement.report().done < 1);
}

// The largest difference of a pixel over its value.
double largest_error(const Image& image, const Image& reference) {
  double largest = 0;
  for (std::size_t i = 0; i < image.values.size(); ++i)
    if (reference.values[i] > 0)
      largest = std::max(largest, std::abs(static_cast<double>(image.values[i]) /
                                               static_cast<double>(reference.values[i]) -
                                           1));
  return largest;
}

TEST(Refinement, EndsAtTheSumOverAllSamples) {
  const Scene scene = make_striped_scene();
  Refinement refinement(scene, few_params());
  finish(refinement);
  EXPECT_EQ(refinement.report().passes, 5);  // quality, 0.4, 0.2, 0.1, all samples
  EXPECT_EQ(refinement.report().max_half_width, 0);
  for (const float width : refinement.half_width()) EXPECT_EQ(width, 0);
  const Image reference = render_brute(scene, few_params());
  EXPECT_GT(reference.values[3 * (14 * 36 + 18)], 0);
  EXPECT_LT(largest_error(refinement.image(), reference), 2e-5);
}

TEST(Refinement, EveryPassHoldsWhatItCertifies) {
  const Scene scene = make_striped_scene();
  const Image reference = render_brute(scene, few_params());
  Refinement refinement(scene, few_params());
  double before = 1e30;
  const double wanted[] = {1e30, 0.4, 0.2, 0.1, 0};
  for (const double tolerance : wanted) {
    finish_pass(refinement);
    const double widest = refinement.report().max_half_width;
    EXPECT_LE(widest, tolerance);
    EXPECT_LT(widest, before);
    before = widest;
    std::size_t seen = 0;
    for (std::size_t i = 0; i < refinement.half_width().size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) {
        const auto found = static_cast<double>(refinement.image().values[3 * i + c]);
        const auto sum = static_cast<double>(reference.values[3 * i + c]);
        EXPECT_LE(std::abs(found - sum),
                  (static_cast<double>(refinement.half_width()[i]) + 2e-5) * found);
        seen += sum > 0 ? 1 : 0;
      }
    EXPECT_GT(seen, 500u);
  }
  EXPECT_TRUE(refinement.is_done());
}

TEST(Refinement, StopsAtTheToleranceAskedFor) {
  RefinementParams params = few_params();
  params.tolerance = 0.15;
  Refinement refinement(make_striped_scene(), params);
  finish(refinement);
  EXPECT_EQ(refinement.report().passes, 4);  // quality, 0.4, 0.2, 0.15
  EXPECT_EQ(refinement.report().tolerance, 0.15);
  EXPECT_LE(refinement.report().max_half_width, 0.15);
  EXPECT_GT(refinement.report().max_half_width, 0);
}

TEST(Refinement, SameBitsForAnyNumberOfThreads) {
  RefinementParams params = few_params();
  params.tolerance = 0.2;
  std::vector<float> values, widths;
  for (const int threads : {1, 3}) {
    const ThreadLimit limit(threads);
    Refinement refinement(make_striped_scene(), params);
    finish(refinement);
    if (threads > 1) {
      EXPECT_EQ(refinement.image().values, values);
      EXPECT_EQ(refinement.half_width(), widths);
    }
    values = refinement.image().values;
    widths = refinement.half_width();
  }
}

TEST(Refinement, CancelledStepsAreDoneAgain) {
  RefinementParams params = few_params();
  params.tolerance = 0.2;
  Refinement whole(make_striped_scene(), params);
  finish(whole);
  Refinement refinement(make_striped_scene(), params);
  int cancelled = 0;
  for (int step = 0; !refinement.is_done(); ++step) {
    if (step % 2 == 1) {
      refinement.advance();
      continue;
    }
    try {  // stages that never look go through
      refinement.advance({.is_cancelled = [] { return true; }});
    } catch (const Error& error) {
      EXPECT_EQ(error.kind, ErrorKind::cancelled);
      ++cancelled;
    }
  }
  EXPECT_GT(cancelled, 5);
  EXPECT_EQ(refinement.image().values, whole.image().values);
  EXPECT_EQ(refinement.half_width(), whole.half_width());
}

TEST(Refinement, ChangesLeaveNothingBehind) {
  RefinementParams params = few_params();
  params.tolerance = 0.4;
  Scene scene = make_striped_scene();
  scene.specular.enabled = true;
  Refinement refinement(scene, params);
  finish(refinement);
  const auto expect_like_a_new_one = [&] {
    EXPECT_EQ(refinement.half_width().front(), -2);
    finish(refinement);
    Refinement fresh(scene, params);
    finish(fresh);
    EXPECT_EQ(refinement.image().values, fresh.image().values);
  };
  scene.material = Material(make_uniform_map(1, 0.5, Boundary::excluded));
  refinement.set_material(scene.material);
  expect_like_a_new_one();
  scene.lights.emplace_back(white_environment());
  refinement.set_lights(scene.lights);
  expect_like_a_new_one();
  scene.camera.width = 20;
  scene.camera.position = scene.camera.position + Vec3{0, 10, 0};
  refinement.set_camera(scene.camera);
  expect_like_a_new_one();
}

TEST(Refinement, LayersAndSingleScatteringAreThoseOfRender) {
  Scene scene = make_striped_scene();
  SurfaceLayer layer;
  layer.material = make_uniform_map(2, 0.4);
  layer.mask = {{GradientMask{{0, 0, 0}, {0, 20, 0}}}};
  scene.layers.push_back(layer);
  RefinementParams params = few_params();
  params.render.antialias = 1;
  Refinement layered(scene, params);
  finish(layered);
  EXPECT_LT(largest_error(layered.image(), render_brute(scene, params)), 2e-5);

  Dipole milk;
  milk.channels = {{0.02, 1.5, 0}, {0.04, 1.2, 0}, {0.1, 1.0, 0}};
  milk.single_scattering = true;
  const Scene homogeneous = make_striped_scene(Material(milk));
  Refinement single(homogeneous, params);
  finish(single);
  EXPECT_LT(largest_error(single.image(), render_brute(homogeneous, params)), 2e-5);
}

TEST(Refinement, ProfilesThatRiseHaveNoBrackets) {
  ProfileMap map = make_uniform_map(1.5, 0.6);
  knot_plane(map, 0, 3)[12] += 3;
  RefinementParams params = few_params();
  Refinement refinement(make_striped_scene(Material(map)), params);
  finish_pass(refinement);
  EXPECT_EQ(refinement.report().max_half_width, -1);
  EXPECT_EQ(refinement.half_width()[14 * 36 + 18], -1);
  finish(refinement);
  EXPECT_EQ(refinement.report().passes, 2);
  EXPECT_EQ(refinement.report().max_half_width, 0);
}

TEST(Refinement, ParametersOutOfRangeAreErrors) {
  RefinementParams params;
  params.tile = 0;
  EXPECT_EQ(error_of([&] { const Refinement refinement(make_striped_scene(), params); }),
            "tile: expected a value in [1, 1024], found 0");
}

}  // namespace
}  // namespace parian

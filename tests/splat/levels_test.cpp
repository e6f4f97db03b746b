// What the structure of levels must not change: the flux that enters, and the picture.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/splat/compare_pictures.h"
#include "tests/splat/scenes.h"

namespace parian {
namespace {

using namespace splat_scenes;

Image draw(const OffscreenContext& context, const Scene& scene, const SplatParams& params,
           std::vector<float>& coverage, int* levels = nullptr) {
  SplatRenderer renderer(context.limits(), scene, params);
  renderer.draw();
  Image image = renderer.read();
  coverage = renderer.coverage();
  if (levels != nullptr) *levels = renderer.report().levels;
  return image;
}

// A convex body takes the irradiance times its shadow's area, whatever its samples.
TEST(Levels, HoldTheFluxOfTheLightEach) {
  const OffscreenContext context;
  const Scene scene =
      make_scene(make_sphere(5), Material(make_chequered_map()), {make_sun({1, 2, 1})});
  const double shadow = std::numbers::pi * 25 * 25;
  for (const LightMode mode : {LightMode::traced, LightMode::mapped})
    for (const int count : {4000, 20000}) {
      SplatParams params = make_params();
      params.samples = count;
      params.lights = mode;
      SplatRenderer renderer(context.limits(), scene, params);
      renderer.draw();
      ASSERT_GT(renderer.report().levels, 2);
      for (int level = 0; level < renderer.report().levels; ++level) {
        const Rgb flux = renderer.level_flux(level), first = renderer.level_flux(0);
        EXPECT_NEAR(static_cast<double>(flux.x) / (3 * shadow), 1, 0.01);
        EXPECT_NEAR(static_cast<double>(flux.z) / (2.5 * shadow), 1, 0.01);
        EXPECT_NEAR(static_cast<double>(flux.y / first.y), 1, 1e-5) << level;
      }
    }
}

TEST(Levels, TheirNumberDoesNotChangeThePicture) {
  const OffscreenContext context;
  const Scene scene =
      make_scene(make_knot(2), Material(make_chequered_map()), {make_sun({1, 2, 1}), make_sky()});
  SplatParams params = make_params();
  params.samples = 20000;
  params.rays = 32;
  std::vector<float> coverage;
  int many = 0, few = 0;
  const Image with_many = draw(context, scene, params, coverage, &many);
  params.octave = 6;
  const Image with_few = draw(context, scene, params, coverage, &few);
  EXPECT_GE(many, few + 1);
  const RelativeErrors errors = relative_errors(with_few, with_many, coverage);
  EXPECT_GT(errors.mean, 0);
  EXPECT_LE(errors.mean, 0.02);
  EXPECT_LE(errors.p99, 0.08);
  RecordProperty("mean", std::to_string(errors.mean));
  RecordProperty("p99", std::to_string(errors.p99));
}

TEST(Levels, NumberOfSamplesChangesLittle) {
  const OffscreenContext context;
  const Scene scene =
      make_scene(make_sphere(5), Material(make_chequered_map()), {make_sun({1, 2, 1})});
  SplatParams params = make_params();
  std::vector<float> coverage;
  params.samples = 30000;
  const Image few = draw(context, scene, params, coverage);
  params.samples = 90000;
  const Image many = draw(context, scene, params, coverage);
  const RelativeErrors errors = relative_errors(many, few, coverage);
  EXPECT_GT(errors.mean, 0);
  EXPECT_LE(errors.mean, 0.02);
  RecordProperty("mean", std::to_string(errors.mean));
}

// Few samples, most of them in the dark: these count where the sums' weights are found.
TEST(Levels, SamplesInTheDarkCount) {
  const OffscreenContext context;
  const Scene scene = make_scene(make_knot(2), Material(make_marble()), {make_sun({0, 0.3f, -1})});
  SplatParams params = make_params();
  params.samples = 4000;
  std::vector<float> coverage;
  const Image image = draw(context, scene, params, coverage);
  const Image reference = render_reference(scene, params.samples, params.rays);
  const RelativeErrors errors = relative_errors(reference, image, coverage);
  EXPECT_LE(errors.mean, 0.08);
  RecordProperty("mean", std::to_string(errors.mean));
}

// A body much larger than its material's range, all around it radiance 1: what leaves is the
// albedo.
TEST(Levels, WhiteFurnace) {
  const OffscreenContext context;
  std::vector<double> knots;
  for (int k = 0; k <= 10; ++k) knots.push_back(0.5 * k);
  ProfileMap map = make_profile_map(2, 2, 3, 1, knots);
  map.boundary = Boundary::included;
  for (std::size_t i = 0; i < map.log_profile.size(); ++i)
    map.log_profile[i] = -0.9f * static_cast<float>((i / 4) % 11);
  const double albedo = diffuse_albedo(get_profile(map, 0, 0, 0));
  EnvironmentLight white;
  white.image = make_image(8, 4, 3, static_cast<float>(0.6 / albedo));
  const Scene scene = make_scene(make_sphere(5), Material(map), {white});
  std::vector<float> coverage;
  const Image image = draw(context, scene, make_params(), coverage);
  expect_close(make_image(image.width, image.height, 3, 0.6f), image, coverage, "parian-furnace");
}

}  // namespace
}  // namespace parian

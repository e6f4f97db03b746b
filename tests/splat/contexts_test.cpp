// Pictures do not depend on the kind of context, and on sums of 16 bits little.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "mesh/shapes.h"
#include "scene/camera.h"
#include "tests/splat/compare_pictures.h"

namespace parian {
namespace {

Scene make_scene() {
  Scene scene;
  scene.mesh = make_knot(2);
  clean_mesh(scene.mesh, "test mesh");
  fit_to_size(scene.mesh, 50);
  scene.mesh_name = "test mesh";
  Dipole marble;
  marble.channels = {{0.0021, 2.19, 0}, {0.0041, 2.62, 0}, {0.0071, 3.0, 0}};
  marble.eta = 1.5;
  scene.material = Material(marble);
  scene.lights = {DirectionalLight{normalize(Vec3{1, 2, 1}), {3, 2.8f, 2.5f}},
                  PointLight{{60, 60, 40}, {9000, 9000, 9000}}};
  scene.camera.width = 120;
  scene.camera.height = 90;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

SplatParams make_params() {
  SplatParams params;
  params.samples = 20000;
  params.antialias = 1;
  params.lights = LightMode::mapped;
  params.shadow_size = 512;
  return params;
}

// Its coverage too.
Image draw(const GlLimits& limits, std::vector<float>& coverage) {
  SplatRenderer renderer(limits, make_scene(), make_params());
  renderer.draw();
  Image image = renderer.read();
  coverage = renderer.coverage();
  EXPECT_EQ(renderer.report().warnings.empty(), limits.float_blend);
  return image;
}

TEST(Contexts, DesktopAndEmbeddedDrawTheSame) {
  std::vector<float> coverage, ignored;
  Image embedded, desktop;
  {
    const OffscreenContext context(ContextKind::embedded);
    embedded = draw(context.limits(), coverage);
  }
  {
    const OffscreenContext context(ContextKind::desktop);
    desktop = draw(context.limits(), ignored);
  }
  const RelativeErrors errors = relative_errors(embedded, desktop, coverage);
  EXPECT_GT(errors.pixels, 1000u);
  EXPECT_LE(errors.mean, 1e-4);
  EXPECT_LE(errors.max, 1e-2);
}

TEST(Contexts, SumsIn16BitsAreCloseAndSaidSo) {
  std::vector<float> coverage;
  const OffscreenContext context;
  ASSERT_TRUE(context.limits().float_blend);
  const Image full = draw(context.limits(), coverage);
  GlLimits without = context.limits();
  without.float_blend = false;
  const RelativeErrors errors = relative_errors(full, draw(without, coverage), coverage);
  EXPECT_GT(errors.mean, 0);  // another way
  EXPECT_LE(errors.mean, 0.02);
  EXPECT_LE(errors.p99, 0.08);
  RecordProperty("mean", std::to_string(errors.mean));
}

TEST(Contexts, APictureBeyondTheLimitIsAnError) {
  const OffscreenContext context;
  Scene scene = make_scene();
  scene.camera.width = context.limits().max_texture_size;
  scene.camera.height = 1;
  SplatParams params = make_params();
  params.antialias = 2;
  SplatRenderer renderer(context.limits(), scene, params);
  try {
    renderer.draw();
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind, ErrorKind::resource);
    EXPECT_NE(std::string(error.what()).find("the graphics driver's limit"), std::string::npos);
  }
}

}  // namespace
}  // namespace parian

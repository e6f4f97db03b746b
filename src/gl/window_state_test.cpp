// State that a window's own drawing left set does not change pictures.
#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "gl/splat_renderer.h"
#include "mesh/shapes.h"
#include "scene/camera.h"

namespace parian {
namespace {

Image draw(const GlLimits& limits) {
  Scene scene;
  scene.mesh = make_knot(1);
  clean_mesh(scene.mesh, "test mesh");
  fit_to_size(scene.mesh, 50);
  scene.mesh_name = "test mesh";
  Dipole marble;
  marble.channels = {{0.0021, 2.19, 0}, {0.0041, 2.62, 0}, {0.0071, 3.0, 0}};
  scene.material = Material(marble);
  scene.lights = {DirectionalLight{normalize(Vec3{1, 2, 1}), {3, 2.8f, 2.5f}}};
  scene.camera.width = 60;
  scene.camera.height = 40;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  SplatParams params;
  params.samples = 2000;
  params.antialias = 1;
  params.lights = LightMode::mapped;
  params.shadow_size = 256;
  SplatRenderer renderer(limits, scene, params);
  renderer.draw();
  return renderer.read();
}

TEST(WindowState, IsOfNoAccount) {
  const OffscreenContext context(ContextKind::desktop);
  const Image clean = draw(context.limits());
  glEnable(GL_SCISSOR_TEST);
  glScissor(3, 4, 5, 6);
  glEnable(GL_CULL_FACE);
  glCullFace(GL_FRONT_AND_BACK);
  glColorMask(GL_FALSE, GL_TRUE, GL_FALSE, GL_TRUE);
  glDepthMask(GL_FALSE);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 7);
  EXPECT_EQ(draw(context.limits()).values, clean.values);
  EXPECT_GT(*std::max_element(clean.values.begin(), clean.values.end()), 0);
}

}  // namespace
}  // namespace parian

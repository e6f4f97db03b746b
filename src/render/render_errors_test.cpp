// What render refuses, warns of and stops at.
#include <gtest/gtest.h>

#include "base/test_errors.h"
#include "render/render.h"
#include "render/test_scenes.h"

namespace parian {
namespace {

using namespace testing_scenes;

TEST(render_errors, open_meshes_are_refused) {
  Scene scene = make_scene(make_plane(1), 20, Material(make_uniform_map(0.7, 0.8)));
  scene.camera.position = {0, 50, 50};
  EXPECT_EQ(error_of([&] { render(scene, quick_params()); }),
            "test mesh: faces: expected a closed surface, found 4000 of 4000 rays into the "
            "mesh escape (100 %): it has holes");
}

TEST(render_errors, small_holes_are_a_warning) {
  Scene scene = make_scene(make_sphere(5), 20, Material(make_uniform_map(0.7, 0.8)));
  scene.lights = {white_environment()};
  scene.mesh.triangles.resize(scene.mesh.triangles.size() - 20);
  const RenderResult result = render(scene, quick_params());
  ASSERT_EQ(result.report.warnings.size(), 1u);
  EXPECT_NE(result.report.warnings[0].find(" of 4000 rays into the mesh escape"),
            std::string::npos);
  EXPECT_GT(result.report.escaping_fraction, 0);
  EXPECT_LT(result.report.escaping_fraction, 0.003);
}

TEST(render_errors, closed_shapes_have_no_holes) {
  for (const std::string& name : shape_names()) {
    Scene scene = make_scene(make_shape(name), 20, Material(make_uniform_map(0.7, 0.8)), 4, 4);
    EXPECT_EQ(render(scene, quick_params()).report.escaping_fraction, 0) << name;
  }
}

TEST(render_errors, camera_that_sees_nothing_is_a_warning) {
  Scene scene = make_scene(make_sphere(3), 20, Material(make_uniform_map(0.7, 0.8)), 4, 4);
  scene.lights = {white_environment()};
  scene.camera.target = scene.camera.position * 2;
  const RenderResult away = render(scene, quick_params());
  EXPECT_EQ(away.report.warnings, std::vector<std::string>{"the camera sees nothing of the mesh"});
  scene.camera.position = center(bounds(scene.mesh));
  const RenderResult inside = render(scene, quick_params());
  EXPECT_EQ(inside.report.warnings, std::vector<std::string>{"the camera is inside the mesh"});
}

TEST(render_errors, memory_is_estimated_before_it_is_needed) {
  Scene scene = make_scene(make_sphere(3), 20, Material(make_uniform_map(0.7, 0.8)));
  scene.camera.width = scene.camera.height = 16384;
  RenderParams params;
  params.antialias = 16;
  const std::size_t needed = estimate_memory(scene, params);
  EXPECT_GT(needed, std::size_t{16384} * 16384 * 256 * 8);
  const Error error = catch_error([&] { render(scene, params, {}, std::size_t{24} << 30); });
  EXPECT_EQ(error.kind, ErrorKind::resource);
  EXPECT_EQ(error.parts.place, "memory");
  EXPECT_EQ(error.parts.found, "24.0 GiB");
  EXPECT_NE(error.parts.expected.find(" GiB (fewer pixels, --samples or --antialias need less)"),
            std::string::npos);
}

// The estimate for a blend is that of the map that it stands for: never too low.
TEST(render_errors, memory_of_a_blend_counts_its_pixels) {
  const ProfileMap map = make_uniform_map(0.7, 0.8);
  ProfileBlend blend;
  blend.width = map.width;
  blend.height = map.height;
  blend.per_pixel = 1;
  blend.knots_mm = map.knots_mm;
  blend.index.assign(map.pixels(), 0);
  Scene scene = make_scene(make_sphere(3), 20, Material(map));
  RenderParams params;
  params.method = GatherMethod::brute;
  const std::size_t expected = estimate_memory(scene, params);
  scene.material = Material(blend);
  EXPECT_EQ(estimate_memory(scene, params), expected);
}

TEST(render_errors, stops_when_asked) {
  Scene scene = make_scene(make_sphere(3), 20, Material(make_uniform_map(0.7, 0.8)), 8, 70);
  for (const char* stage : {"looking", "shading"}) {
    bool cancelled = false;
    Progress progress;
    progress.report = [&](std::string_view name, double) { cancelled |= name == stage; };
    progress.is_cancelled = [&] { return cancelled; };
    EXPECT_EQ(catch_error([&] { render(scene, quick_params(), progress); }).kind,
              ErrorKind::cancelled)
        << stage;
  }
}

}  // namespace
}  // namespace parian

// Splatted pictures against those of the CPU renderer's tree, which takes the same samples.
#include <fmt/format.h>

#include <algorithm>

#include "bench/common/assets.h"
#include "bench/splat/study.h"
#include "gl/splat_renderer.h"
#include "image/metrics.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "mesh/shapes.h"
#include "render/render.h"
#include "scene/camera.h"
#include "scene/environment.h"

namespace parian {
namespace {

struct Case {
  std::string name;
  Scene scene;
};

Case make_case(std::string name, TriangleMesh mesh, SurfaceMaterial material,
               std::vector<Light> lights, double size_mm = 60) {
  Case made{std::move(name), {}};
  Scene& scene = made.scene;
  clean_mesh(mesh, "mesh");
  fit_to_size(mesh, size_mm);
  scene.mesh = std::move(mesh);
  scene.mesh_name = "mesh";
  scene.material = std::move(material);
  scene.lights = std::move(lights);
  scene.specular.enabled = false;
  scene.camera.width = 480;
  scene.camera.height = 360;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  return made;
}

std::vector<Case> make_cases() {
  const Light sun = DirectionalLight{normalize(Vec3{1, 2, 1}), {3, 2.8f, 2.5f}};
  const Light behind = DirectionalLight{normalize(Vec3{-0.3f, 0.4f, -1}), {3, 3, 3}};
  const std::vector<Light> lamps{PointLight{{60, 60, 40}, {9000, 9000, 9000}},
                                 PointLight{{-70, 10, 30}, {6000, 4000, 2000}}};
  EnvironmentLight sky;
  sky.image = make_sky_image(64, 32);
  const auto dragon = [] { return make_bench_mesh("dragon-22998.ply", 2, 60); };
  const SampleFiles jade = make_sample_files("jade");
  std::vector<Case> cases;
  cases.push_back(make_case("map, sun, knot", make_knot(2), Material(stone_map()), {sun}));
  cases.push_back(make_case("map, sun, dragon", dragon(), Material(stone_map()), {sun}));
  cases.push_back(make_case("map, sky, dragon", dragon(), Material(stone_map()), {sky}));
  cases.push_back(
      make_case("map of jade, sun", dragon(), Material(load_profile_map(jade.map)), {sun}));
  cases.push_back(make_case("blend, two lamps", dragon(), Material(stone_blend()), lamps));
  cases.push_back(make_case("marble, sun and sky", dragon(), Material(make_marble()), {sun, sky}));
  cases.push_back(make_case("marble lit from behind", dragon(), Material(make_marble()), {behind}));
  cases.push_back(
      make_case("thin sheet lit from behind", make_fin(2), Material(stone_map()), {behind}, 40));
  return cases;
}

std::vector<std::string> compare(const GlLimits& limits, const Case& made, int samples) {
  SplatParams params;
  params.samples = samples;
  params.antialias = 1;
  SplatRenderer renderer(limits, made.scene, params);
  renderer.draw(true);
  RenderParams tree;
  tree.samples = samples;
  tree.antialias = 1;
  const Image image = renderer.read(), reference = render(made.scene, tree).image;
  const RelativeErrors errors = relative_errors(reference, image, renderer.coverage());
  return {made.name, fmt::format("{}", samples), fmt::format("{:.2f}", 100 * errors.mean),
          fmt::format("{:.1f}", 100 * errors.p99)};
}

}  // namespace

void study_accuracy(const Page& page, const GlLimits& limits) {
  MarkdownTable table;
  table.header = {"scene", "samples", "mean, %", "99 % below, %"};
  for (const Case& made : make_cases())
    for (const int samples : {4000, 20'000, 50'000})
      table.rows.push_back(compare(limits, made, samples));
  write_table(page, "accuracy",
              "Relative errors over pixels against the tree with the same samples, 480 x 360, "
              "without reflection; the dragon of 23 k vertices.",
              table);
}

}  // namespace parian

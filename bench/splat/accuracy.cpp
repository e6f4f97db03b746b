// Splatted pictures against those of the CPU renderer's tree, which takes the same samples.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include "bench/splat/study.h"
#include "gl/splat_renderer.h"
#include "image/metrics.h"
#include "io/image/image_file.h"
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
  scene.camera.width = 320;
  scene.camera.height = 240;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  return made;
}

std::vector<Case> make_cases() {
  const Light sun = DirectionalLight{normalize(Vec3{1, 2, 1}), {3, 2.8f, 2.5f}};
  const Light behind = DirectionalLight{normalize(Vec3{-0.3f, 0.4f, -1}), {3, 3, 3}};
  const Light lamps[] = {PointLight{{60, 60, 40}, {9000, 9000, 9000}},
                         PointLight{{-70, 10, 30}, {6000, 4000, 2000}}};
  EnvironmentLight sky;
  sky.image = make_sky_image(64, 32);
  const auto dragon = [] { return make_bench_mesh("dragon-22998.ply", 2, 60); };
  std::vector<Case> cases;
  cases.push_back(make_case("map, sun, knot", make_knot(2), Material(stone_map()), {sun}));
  cases.push_back(make_case("map, sun, dragon", dragon(), Material(stone_map()), {sun}));
  cases.push_back(make_case("map, sky, dragon", dragon(), Material(stone_map()), {sky}));
  cases.push_back(make_case("blend, two lamps, dragon", dragon(), Material(stone_blend()),
                            {lamps[0], lamps[1]}));
  cases.push_back(
      make_case("marble, sun and sky, dragon", dragon(), Material(make_marble()), {sun, sky}));
  cases.push_back(make_case("map, thin sheet lit from behind", make_fin(2), Material(stone_map()),
                            {behind}, 40));
  cases.push_back(
      make_case("marble, dragon lit from behind", dragon(), Material(make_marble()), {behind}));
  return cases;
}

}  // namespace

void study_accuracy(const Page& page, const GlLimits& limits) {
  MarkdownTable table;
  table.header = {"scene", "samples", "mean", "99 % below", "largest", "splats ms"};
  for (Case& made : make_cases()) {
    for (const int samples : {4000, 20000}) {
      SplatParams params;
      params.samples = samples;
      params.antialias = 1;
      set_from_environment(params);
      SplatRenderer renderer(limits, made.scene, params);
      double best = 1e30;
      for (int run = 0; run < 3; ++run) {
        renderer.draw(true);
        best = std::min(best, renderer.report().splat_s + renderer.report().resolve_s);
      }
      const Image image = renderer.read();
      RenderParams tree;
      tree.samples = samples;
      tree.antialias = 1;
      const Image reference = render(made.scene, tree).image;
      const RelativeErrors errors = relative_errors(reference, image, renderer.coverage());
      if (std::getenv("DUMP") != nullptr) {
        const std::string base = fmt::format("/tmp/pics/{}-{}", made.name.substr(0, 30), samples);
        Image difference = image;
        for (std::size_t i = 0; i < image.values.size(); ++i)
          difference.values[i] =
              std::clamp(0.5f + 10 * (image.values[i] - reference.values[i]), 0.0f, 1.0f);
        save_image(base + "-splat.png", image);
        save_image(base + "-tree.png", reference);
        save_image(base + "-diff.png", difference);
      }
      table.rows.push_back(
          {made.name, fmt::format("{}", samples), fmt::format("{:.2f} %", 100 * errors.mean),
           fmt::format("{:.2f} %", 100 * errors.p99), fmt::format("{:.1f} %", 100 * errors.max),
           fmt::format("{:.0f}", 1e3 * best)});
    }
  }
  write_table(page, "accuracy", "", table);
}

}  // namespace parian

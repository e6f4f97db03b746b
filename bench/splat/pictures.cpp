// The pictures of docs/splatting.md.
#include <algorithm>

#include "bench/common/assets.h"
#include "bench/splat/study.h"
#include "gl/live_renderer.h"
#include "gl/splat_renderer.h"
#include "image/color.h"
#include "io/hdf5/map_file.h"
#include "mesh/shapes.h"
#include "render/render.h"
#include "scene/camera.h"
#include "transport/precompute.h"

namespace parian {
namespace {

constexpr int samples = 100'000;

Image splat(const GlLimits& limits, const Scene& scene) {
  SplatParams params;
  params.samples = samples;
  SplatRenderer renderer(limits, scene, params);
  renderer.draw();
  return renderer.read();
}

Image gather(const Scene& scene) {
  RenderParams params;
  params.samples = samples;
  return render(scene, params).image;
}

Image difference(const Image& a, const Image& b) {
  Image image = a;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    image.values[i] = std::clamp(0.2f + 10 * (a.values[i] - b.values[i]), 0.0f, 1.0f);
  return image;
}

void show(const Page& page, const std::string& name, const GlLimits& limits, const Scene& scene) {
  const Image image = splat(limits, scene), reference = gather(scene);
  write_picture(page, name + "-splat", image);
  write_picture(page, name + "-tree", reference);
  write_picture(page, name + "-difference", difference(image, reference));
}

Scene make_picture_scene() {
  Scene scene = make_dragon("dragon-437645.ply",
                            Material(load_profile_map(make_sample_files("jade").map)), 480, 360);
  scene.mapping.scale = 1.5;
  EnvironmentLight sky = make_bench_environment();
  sky.scale = {0.7f, 0.7f, 0.7f};
  scene.lights.emplace_back(sky);
  return scene;
}

Scene make_fin_scene() {
  Scene scene;
  scene.mesh = make_fin(2);
  clean_mesh(scene.mesh, "fin");
  fit_to_size(scene.mesh, 40);
  scene.mesh_name = "fin";
  scene.material = Material(stone_map());
  scene.lights = {DirectionalLight{normalize(Vec3{-0.3f, 0.4f, -1}), {4, 4, 4}}};
  scene.camera.width = 480;
  scene.camera.height = 360;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

Scene make_layered_scene() {
  Scene scene = make_dragon("dragon-100250.ply", Material(make_marble()), 480, 360);
  SurfaceLayer layer;
  layer.material =
      std::make_shared<const Material>(Dipole{{{0.02, 1.5, 0}, {0.4, 1.2, 0}, {0.9, 1.0, 0}}, 1.3});
  const Bounds3 box = bounds(scene.mesh);
  layer.mask = {{GradientMask{box.lower, box.upper}}};
  scene.layers = {layer};
  return scene;
}

Dipole make_wax(double sigma_s) {
  Dipole wax;
  wax.channels = {{0.01, sigma_s, 0}, {0.03, 0.9 * sigma_s, 0}, {0.1, 0.8 * sigma_s, 0}};
  wax.single_scattering = true;
  return wax;
}

void show_live(const Page& page, const GlLimits& limits) {
  const Scene scene = make_dragon("dragon-22998.ply", Material(make_wax(1)), 480, 360);
  PrecomputeParams params;
  params.samples = 50'000;
  params.single_params.directions = 32;
  params.single_params.resolution = 1024;
  LiveRenderer renderer(limits, scene, precompute_transport(scene, params));
  for (const double sigma_s : {0.5, 2.0, 6.0}) {
    renderer.set_material(make_wax(sigma_s));
    renderer.draw();
    write_picture(page, "live-" + std::to_string(static_cast<int>(10 * sigma_s)), renderer.read());
  }
}

}  // namespace

void study_pictures(const Page& page, const GlLimits& limits) {
  show(page, "dragon", limits, make_picture_scene());
  show(page, "fin", limits, make_fin_scene());
  show(page, "layers", limits, make_layered_scene());
  show_live(page, limits);
}

}  // namespace parian

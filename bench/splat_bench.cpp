// Splatting: milliseconds per stage and frames per second on the dragon at 1280 x 720, beside the
// rate at which the device adds bare squares, in the same run.
//
//   ./run bench splat [stages] [rate]
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/common/assets.h"
#include "fit/fit.h"
#include "gl/splat_rate.h"
#include "gl/splat_renderer.h"
#include "io/hdf5/table_file.h"
#include "scene/camera.h"

namespace parian {
namespace {

Scene make_scene() {
  Scene scene;
  scene.mesh = make_bench_mesh("dragon-100250.ply", 2, 80);
  scene.mesh_name = "dragon";
  scene.material =
      Material(fit_profiles(*open_table(PARIAN_SOURCE_DIR "/data/stone-72x64.h5"), {}).map);
  scene.lights = {DirectionalLight{normalize(Vec3{1, 1, 0.5f}), {3, 3, 3}}};
  scene.camera.width = 1280;
  scene.camera.height = 720;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

void bench_rate() {
  fmt::print("\nBare squares added to a float picture of 1280 x 720\n\n");
  fmt::print("| side, pixels | squares/s | pixels/s |\n|---:|---:|---:|\n");
  for (const int side : {4, 8, 16, 20, 32}) {
    const SplatRate rate = measure_splat_rate(1280, 720, 100'000, side);
    fmt::print("| {} | {:.3g} M | {:.3g} M |\n", side, rate.splats_per_s * 1e-6,
               rate.pixels_per_s * 1e-6);
  }
}

void bench_stages(const GlLimits& limits) {
  const Scene scene = make_scene();
  fmt::print("\n{} triangles, 1280 x 720, one ray a pixel, profiles of {}\n\n",
             scene.mesh.triangles.size(), "data/stone-72x64.h5");
  fmt::print(
      "| samples | levels | emitters | light ms | edit ms | groups | view | splats | resolve "
      "| shade | frames/s | emitters/s | textures |\n"
      "|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  for (const int samples : {5'000, 20'000, 50'000, 200'000}) {
    SplatParams params;
    params.samples = samples;
    params.antialias = 1;
    SplatRenderer renderer(limits, scene, params);
    renderer.draw(true);
    const double groups = renderer.report().group_s;
    double best = 1e30;
    SplatReport fastest;
    for (int run = 0; run < 3; ++run) {
      renderer.draw(true);
      const SplatReport& report = renderer.report();
      const double seconds = report.view_s + report.splat_s + report.resolve_s + report.shade_s;
      if (seconds >= best) continue;
      best = seconds;
      fastest = report;
    }
    renderer.set_lights(scene.lights);
    renderer.set_material(std::get<Material>(scene.material));
    const SplatReport& report = renderer.report();
    fmt::print(
        "| {} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | "
        "{:.3g} | {:.3g} M | {:.0f} MB |\n",
        report.samples, report.levels, report.splats, 1e3 * report.irradiance_s,
        1e3 * report.material_s, 1e3 * groups, 1e3 * fastest.view_s, 1e3 * fastest.splat_s,
        1e3 * fastest.resolve_s, 1e3 * fastest.shade_s, 1 / best,
        1e-6 * static_cast<double>(report.splats) / fastest.splat_s,
        1e-6 * static_cast<double>(report.texture_bytes));
  }
}

}  // namespace
}  // namespace parian

int main(int argc, char** argv) {
  try {
    const std::vector<std::string> chosen(argv + 1, argv + argc);
    const auto is_chosen = [&](const char* name) {
      return chosen.empty() || std::find(chosen.begin(), chosen.end(), name) != chosen.end();
    };
    const parian::OffscreenContext context;
    fmt::print("{}, {}\n", context.limits().renderer, context.limits().version);
    if (is_chosen("rate")) parian::bench_rate();
    if (is_chosen("stages")) parian::bench_stages(context.limits());
  } catch (const parian::Error& error) {
    fmt::print(stderr, "bench_splat: {}\n", error.what());
    return 1;
  }
  return 0;
}

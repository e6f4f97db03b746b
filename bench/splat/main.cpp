// Splatting: milliseconds per stage and frames per second on the dragon at 1280 x 720, beside the
// rate at which the device adds bare squares, in the same run.
//
//   ./run bench splat [stages] [rate] [edit] [live]
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <cstdlib>
#include "base/error.h"
#include "base/stopwatch.h"
#include "bench/splat/study.h"
#include "compress/compress.h"
#include "fit/fit.h"
#include "gl/live_renderer.h"
#include "gl/splat_rate.h"
#include "gl/splat_renderer.h"
#include "io/hdf5/table_file.h"
#include "scene/camera.h"
#include "transport/precompute.h"

namespace parian {

const ProfileMap& stone_map() {
  static const ProfileMap map =
      fit_profiles(*open_table(PARIAN_SOURCE_DIR "/data/stone-72x64.h5"), {}).map;
  return map;
}
const ProfileBlend& stone_blend() {
  static const ProfileBlend blend = compress_profiles(stone_map(), nullptr, {});
  return blend;
}
Dipole make_marble(double scale) {
  Dipole marble;
  marble.channels = {{0.0021, 2.19 * scale, 0}, {0.0041, 2.62 * scale, 0}, {0.0071, 3 * scale, 0}};
  return marble;
}
void set_from_environment(SplatParams& params) {
  if (const char* v = std::getenv("OCTAVE")) params.octave = std::atof(v);
  if (const char* v = std::getenv("OVERLAP")) params.overlap = std::atof(v);
  if (const char* v = std::getenv("TEXEL")) params.texel = std::atof(v);
}

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

void bench_probe(const GlLimits& limits) {
  Scene scene = make_scene();
  for (const bool blend : {false, true}) {
    if (blend) scene.material = Material(stone_blend());
    SplatParams params;
    params.samples = 50'000;
    params.antialias = 1;
    SplatRenderer renderer(limits, scene, params);
    std::vector<double> best(10, 1e30);
    double resolve = 1e30;
    for (int run = 0; run < 5; ++run) {
      renderer.draw(true);
      for (std::size_t l = 0; l < renderer.report().level_s.size(); ++l)
        best[l] = std::min(best[l], renderer.report().level_s[l]);
      resolve = std::min(resolve, renderer.report().resolve_s);
    }
    for (std::size_t l = 0; l < renderer.report().level_s.size(); ++l)
      fmt::print("level {} block {}: {:.1f} ms; ", l, renderer.report().blocks[l], 1e3 * best[l]);
    fmt::print("resolve {:.1f}\n", 1e3 * resolve);
  }
}

double seconds_of(const std::function<void()>& work) {
  double best = 1e30;
  for (int run = 0; run < 5; ++run) {
    Stopwatch watch;
    work();
    best = std::min(best, watch.lap());
  }
  return best;
}

Scene make_editor_scene(Material material) {
  Scene scene = make_scene();
  scene.material = std::move(material);
  scene.camera.width = 640;
  scene.camera.height = 480;
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

// What changes between frames, and the picture with it on the screen.
void bench_edit(const GlLimits& limits) {
  fmt::print(
      "\nAn edit at the interactive quality, 640 x 480, 100 k vertices, ms to the picture\n\n"
      "| material | samples | material | light | camera | nothing | start s |\n"
      "|---|---:|---:|---:|---:|---:|---:|\n");
  const std::pair<const char*, Material> materials[] = {
      {"stone, a map", std::get<Material>(make_scene().material)}, {"marble", make_marble()}};
  for (const auto& [name, material] : materials)
    for (const int samples : {2000, 4000, 16'000}) {
      Scene scene = make_editor_scene(material);
      SplatParams params = make_interactive_params();
      params.samples = samples;
      Stopwatch watch;
      SplatRenderer renderer(limits, scene, params);
      renderer.draw(true);
      const double start = watch.lap();
      const double edit = seconds_of([&] {
        renderer.set_material(material);
        renderer.draw(true);
        (void)renderer.read();
      });
      const double light = seconds_of([&] {
        renderer.set_lights(scene.lights);
        renderer.draw(true);
        (void)renderer.read();
      });
      const double camera = seconds_of([&] {
        renderer.set_camera(scene.camera);
        renderer.draw(true);
        (void)renderer.read();
      });
      const double nothing = seconds_of([&] {
        renderer.draw(true);
        (void)renderer.read();
      });
      fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.2f} |\n", name,
                 renderer.report().samples, 1e3 * edit, 1e3 * light, 1e3 * camera, 1e3 * nothing,
                 start);
    }
}

// Coefficients of a homogeneous material: one pass over the vertices. The transport is a coarse
// one; its size, and so the time, is that of a fine one.
void bench_live(const GlLimits& limits) {
  fmt::print(
      "\nHomogeneous edits from transport, 640 x 480, 100 k vertices, ms\n\n"
      "| single scattering | project | update | view | shade | read | edits/s | loading s "
      "| textures |\n|---|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  PrecomputeParams coarse;
  coarse.samples = 2000;
  coarse.rays = 8;
  coarse.single_params.directions = 4;
  coarse.single_params.path_samples = 8;
  coarse.single_params.resolution = 128;
  for (const bool has_single : {false, true}) {
    Dipole marble = make_marble();
    marble.single_scattering = has_single;
    const Scene scene = make_editor_scene(marble);
    const HomogeneousTransport transport = precompute_transport(scene, coarse);
    LiveParams params;
    params.antialias = 1;
    LiveRenderer renderer(limits, scene, transport, params);
    renderer.draw(true);
    const double edit = seconds_of([&] {
      renderer.set_material(marble);
      renderer.draw(true);
      (void)renderer.read();
    });
    const LiveReport& report = renderer.report();
    fmt::print(
        "| {} | {:.2f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.0f} | {:.2f} | {:.1f} MB |\n",
        has_single ? "yes" : "no", 1e3 * report.project_s, 1e3 * report.update_s,
        1e3 * report.view_s, 1e3 * report.shade_s, 1e3 * report.read_s, 1 / edit, report.loading_s,
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
    if (is_chosen("accuracy"))
      parian::study_accuracy({.name = "splatting", .folder = "out/bench", .docs = {}},
                             context.limits());
    if (is_chosen("probe")) parian::bench_probe(context.limits());
    if (is_chosen("rate")) parian::bench_rate();
    if (is_chosen("stages")) parian::bench_stages(context.limits());
    if (is_chosen("edit")) parian::bench_edit(context.limits());
    if (is_chosen("live")) parian::bench_live(context.limits());
  } catch (const parian::Error& error) {
    fmt::print(stderr, "bench_splat: {}\n", error.what());
    return 1;
  }
  return 0;
}

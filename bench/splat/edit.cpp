// What changes between frames, and the picture with it read back.
#include <fmt/format.h>

#include "base/stopwatch.h"
#include "bench/common/timing.h"
#include "bench/splat/study.h"
#include "gl/live_renderer.h"
#include "gl/splat_renderer.h"
#include "render/transport_renderer.h"
#include "transport/precompute.h"

namespace parian {
namespace {

std::string ms(double seconds) {
  return fmt::format("{:.0f}", 1e3 * seconds);
}

std::vector<std::string> measure_edits(const GlLimits& limits, const std::string& name,
                                       const Material& material, int samples) {
  const Scene scene = make_dragon("dragon-100250.ply", material, 640, 480);
  SplatParams params = make_interactive_params();
  params.samples = samples;
  Stopwatch watch;
  SplatRenderer renderer(limits, scene, params);
  renderer.draw(true);
  const double start = watch.lap();
  const auto show = [&] {
    renderer.draw(true);
    (void)renderer.read();
  };
  const double edit = best_seconds(5, [&] {
    renderer.set_material(material);
    show();
  });
  const double light = best_seconds(5, [&] {
    renderer.set_lights(scene.lights);
    show();
  });
  const double camera = best_seconds(5, [&] {
    renderer.set_camera(scene.camera);
    show();
  });
  return {name,     fmt::format("{}", renderer.report().samples), ms(edit), ms(light), ms(camera),
          ms(start)};
}

PrecomputeParams coarse_transport() {
  PrecomputeParams coarse;
  coarse.samples = 2000;
  coarse.rays = 8;
  coarse.single_params.directions = 16;
  coarse.single_params.path_samples = 8;
  coarse.single_params.resolution = 128;
  return coarse;
}

}  // namespace

void study_edits(const Page& page, const GlLimits& limits) {
  MarkdownTable table;
  table.header = {"material", "samples", "edit", "light", "camera", "start"};
  for (const int samples : {2000, 4000, 16'000}) {
    table.rows.push_back(measure_edits(limits, "stone, a map", Material(stone_map()), samples));
    table.rows.push_back(measure_edits(limits, "stone, a blend", Material(stone_blend()), samples));
    table.rows.push_back(measure_edits(limits, "marble", Material(make_marble()), samples));
  }
  write_table(
      page, "edits",
      fmt::format("{}; dragon of 100 k vertices, 640 x 480, shadow maps, milliseconds until "
                  "the picture is read back.",
                  limits.renderer),
      table);
}

// The transport is a coarse one; its size, and so the time, is that of a fine one.
void study_live(const Page& page, const GlLimits& limits) {
  MarkdownTable table;
  table.header = {"single scattering", "coefficients", "vertices", "view", "shade", "read",
                  "edits/s, device",   "CPU, edits/s", "MB"};
  for (const bool has_single : {false, true}) {
    Dipole marble = make_marble();
    marble.single_scattering = has_single;
    const Scene scene = make_dragon("dragon-100250.ply", Material(marble), 640, 480);
    const HomogeneousTransport transport = precompute_transport(scene, coarse_transport());
    LiveParams params;
    params.antialias = 1;
    params.update = LiveUpdate::device;
    LiveRenderer renderer(limits, scene, transport, params);
    renderer.draw(true);
    const double edit = best_seconds(5, [&] {
      renderer.set_material(marble);
      renderer.draw(true);
      (void)renderer.read();
    });
    const TransportView view =
        make_transport_view(scene.mesh.positions, scene.mesh.normals, scene.camera.position,
                            transport.eta, /*has_fresnel=*/true);
    std::vector<Rgb> radiance;
    const TransportProjection projection(transport);
    const double on_cpu = best_seconds(5, [&] {
      const TransportCoefficients coefficients = projection.fit(marble);
      eval_transport(transport, coefficients, {Rgb{1, 1, 1}}, view, radiance);
    });
    const LiveReport& report = renderer.report();
    const auto fine = [](double seconds) { return fmt::format("{:.2f}", 1e3 * seconds); };
    table.rows.push_back({has_single ? "with" : "without", fine(report.project_s),
                          fine(report.update_s), fine(report.view_s), fine(report.shade_s),
                          fine(report.read_s), fmt::format("{:.0f}", 1 / edit),
                          fmt::format("{:.0f}", 1 / on_cpu),
                          fmt::format("{:.1f}", 1e-6 * static_cast<double>(report.texture_bytes))});
  }
  write_table(page, "live",
              fmt::format("{}; dragon of 100 k vertices, 640 x 480, milliseconds and edits per "
                          "second with the picture read back; on the CPU new radiance at all "
                          "vertices.",
                          limits.renderer),
              table);
}

}  // namespace parian

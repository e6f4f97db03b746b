#include "app/cli/render_splat.h"

#include <memory>

#include "gl/live_renderer.h"
#include "gl/splat_renderer.h"

namespace parian {
namespace {

struct SplatFrames {
  OffscreenContext context;
  SplatRenderer renderer;
};

struct LiveFrames {
  OffscreenContext context;
  LiveRenderer renderer;
};

RenderReport to_report(const LiveReport& live) {
  RenderReport report;
  report.gather = "transport on the graphics device";
  report.triangles = live.triangles;
  report.vertices = report.targets = live.vertices;
  report.gather_s = live.project_s + live.update_s;
  report.shading_s = live.view_s + live.shade_s + live.read_s;
  report.total_s = report.gather_s + report.shading_s;
  report.warnings = live.warnings;
  return report;
}

RenderReport to_report(const SplatReport& splat, const Scene& scene) {
  RenderReport report;
  report.gather = "splat";
  report.triangles = scene.mesh.triangles.size();
  report.vertices = scene.mesh.positions.size();
  report.samples = splat.samples;
  report.sample_spacing_mm = splat.sample_spacing_mm;
  report.area_mm2 = splat.area_mm2;
  report.targets = splat.targets;
  report.escaping_fraction = splat.escaping_fraction;
  report.sampling_s = splat.sampling_s;
  report.irradiance_s = splat.irradiance_s;
  report.tree_s = splat.material_s + splat.group_s;
  report.gather_s = splat.splat_s + splat.resolve_s;
  report.shading_s = splat.view_s + splat.shade_s + splat.read_s;
  report.total_s =
      report.sampling_s + report.irradiance_s + report.tree_s + report.gather_s + report.shading_s;
  report.warnings = splat.warnings;
  return report;
}

}  // namespace

std::function<RenderResult(const Dipole* material)> make_splat_frames(const Scene& scene,
                                                                      const RenderParams& params,
                                                                      const Progress& progress) {
  SplatParams splat;
  splat.samples = params.samples;
  splat.rays = params.rays;
  splat.antialias = params.antialias;
  splat.seed = params.seed;
  OffscreenContext context;
  SplatRenderer renderer(context.limits(), scene, splat, progress);
  const auto frames =
      std::make_shared<SplatFrames>(SplatFrames{std::move(context), std::move(renderer)});
  return [frames, &scene](const Dipole* material) {
    if (material != nullptr) frames->renderer.set_material(Material(*material));
    frames->renderer.draw(/*timed=*/true);
    RenderResult result;
    result.image = frames->renderer.read();
    result.report = to_report(frames->renderer.report(), scene);
    return result;
  };
}

std::function<RenderResult(const Dipole* material)> make_live_frames(
    const Scene& scene, const HomogeneousTransport& transport, const RenderParams& params) {
  LiveParams live;
  live.antialias = params.antialias;
  OffscreenContext context;
  LiveRenderer renderer(context.limits(), scene, transport, live);
  const auto frames =
      std::make_shared<LiveFrames>(LiveFrames{std::move(context), std::move(renderer)});
  const Dipole own = std::get<Dipole>(std::get<Material>(scene.material));
  return [frames, own](const Dipole* material) {
    frames->renderer.set_material(material != nullptr ? *material : own);
    frames->renderer.draw(/*timed=*/true);
    RenderResult result;
    result.image = frames->renderer.read();
    result.report = to_report(frames->renderer.report());
    return result;
  };
}

}  // namespace parian

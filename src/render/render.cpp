#include "render/render.h"

#include "mesh/closed.h"
#include "render/exitance_internal.h"
#include "render/shade_internal.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

void check_view(const PrimaryView& view, RenderReport& report) {
  if (view.hits.empty()) {
    report.warnings.push_back("the camera sees nothing of the mesh");
  } else if (2 * view.from_inside > view.hits.size()) {
    report.warnings.push_back("the camera is inside the mesh");
  }
}

SurfaceSamples make_samples(const Scene& scene, const RayTracer& tracer, const RenderParams& params,
                            RenderReport& report, const Progress& progress) {
  SurfaceSamples samples = make_surface_samples(
      scene.mesh, static_cast<std::size_t>(params.samples), params.seed, progress);
  report.samples = samples.points.size();
  report.area_mm2 = samples.area_mm2 * static_cast<double>(samples.points.size());
  report.sample_spacing_mm = samples.spacing_mm();
  report.escaping_fraction = check_closed(samples, tracer, scene.mesh_name, report.warnings);
  return samples;
}

}  // namespace

ParamList describe(RenderParams& params) {
  return {{.name = "method",
           .help = "how light is gathered: every sample, or the moment tree; a table without a fit "
                   "is always gathered from every sample",
           .target = make_choice(params.method, {"brute", "tree"})},
          {.name = "shading",
           .help = "where scattered light is gathered: for each pixel, or at the vertices",
           .target = make_choice(params.shading, {"pixel", "vertex"})},
          describe_samples(params.samples),
          describe_rays(params.rays),
          {.name = "antialias",
           .help = "n x n rays per pixel",
           .target = &params.antialias,
           .min = 1,
           .max = 16,
           .symbol = "n"},
          {.name = "quality",
           .help = "estimated relative error at which the tree is not opened further; 0: brute "
                   "force",
           .target = &params.quality,
           .min = 0,
           .max = 1},
          {.name = "tolerance",
           .help = "certified relative half-width of the result; 0: quality rules",
           .target = &params.tolerance,
           .min = 0,
           .max = 1},
          describe_seed(params.seed)};
}

RenderResult render(const Scene& scene, const RenderParams& params_, const Progress& progress,
                    std::size_t memory_limit) {
  RenderParams params = params_;
  check(describe(params));
  check_layers(scene, scene.mesh_name);
  check_memory(estimate_memory(scene, params), memory_limit,
               "fewer pixels, --samples or --antialias need less");
  Stopwatch total, watch;
  RenderResult result;
  RenderReport& report = result.report;
  report.triangles = scene.mesh.triangles.size();
  report.vertices = scene.mesh.positions.size();

  const RayTracer tracer(scene.mesh);
  const SurfaceSamples samples = make_samples(scene, tracer, params, report, progress);
  report.sampling_s = watch.lap();
  PrimaryView view = trace_primary(scene.mesh, tracer, scene.camera, params.antialias, progress);
  check_view(view, report);
  report.shading_s = watch.lap();

  std::vector<Rgb> exitance;
  if (!view.hits.empty()) {
    if (params.shading == Shading::vertex) view.targets = vertex_places(scene.mesh);
    report.targets = view.targets.size();
    exitance = compute_exitance(scene, tracer, samples, view.targets, params, report, progress);
  }
  watch.lap();
  result.image = shade(scene, tracer, view, exitance, params, progress);
  report.shading_s += watch.lap();
  report.total_s = total.lap();
  return result;
}

}  // namespace parian

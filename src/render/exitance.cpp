#include <numbers>

#include "render/exitance_internal.h"
#include "transport/irradiance.h"
#include "transport/moment_tree.h"
#include "transport/precompute.h"

namespace parian {
namespace {

struct GatherWork {
  GatherInput input;
  const RenderParams& params;
  RenderReport& report;
  const Progress& progress;
};

void report_brackets(const TreeGatherResult& result, RenderReport& report) {
  report.certified = result.certified;
  report.nodes_per_target = result.nodes_per_target;
  if (result.certified == 0) return;
  report.max_half_width = result.max_half_width;
  report.mean_half_width = result.mean_half_width;
}

std::vector<Rgb> gather(const GatherWork& work, const Material& material, std::vector<Rgb> flux) {
  Stopwatch watch;
  const PlacedProfiles placed = place_profiles(work.input, material, std::move(flux));
  if (work.params.method == GatherMethod::brute) {
    work.report.gather = "brute";
    std::vector<Rgb> exitance =
        gather_brute(placed.field, placed.sources, placed.targets, placed.near_mm, work.progress);
    work.report.gather_s = watch.lap();
    return exitance;
  }
  work.report.gather = "tree";
  const MomentTree tree(placed.field, placed.sources);
  work.report.tree_s = watch.lap();
  TreeGatherParams params;
  params.quality = work.params.quality;
  params.tolerance = work.params.tolerance;
  TreeGatherResult result = tree.gather(placed.targets, placed.near_mm, params, work.progress);
  work.report.gather_s = watch.lap();
  report_brackets(result, work.report);
  return std::move(result.exitance);
}

std::vector<Rgb> gather(const GatherWork& work, const BssrdfTable& table, std::vector<Rgb> flux) {
  Stopwatch watch;
  const PlacedTable placed = place_table(work.input, table, std::move(flux));
  work.report.gather = "table";
  std::vector<Rgb> exitance =
      gather_table(table, placed.sources, placed.targets, placed.near_mm, work.progress);
  work.report.gather_s = watch.lap();
  return exitance;
}

}  // namespace

std::vector<Rgb> compute_single_exitance(const GatherInput& input, const RayTracer& tracer,
                                         const Dipole& material, std::uint64_t seed,
                                         const Progress& progress) {
  const Scene& scene = input.scene;
  std::vector<SurfacePoint> points;
  std::vector<Vec3> positions, normals;
  points.reserve(input.targets.size());
  for (std::size_t i = 0; i < input.targets.size(); ++i) {
    points.push_back(input.get_target(i));
    positions.push_back(points[i].position);
    normals.push_back(points[i].normal);
  }
  HomogeneousTransport transport = make_empty_transport(scene);
  transport.places = points.size();
  SingleScatteringParams params;
  params.seed = seed;
  for (const Light& light : scene.lights) {
    const std::vector<float> value = compute_single_transport(
        transport.single_basis, points, light, scene.mesh, tracer, material.eta, params, progress);
    transport.lights.push_back(
        {.single = pack_transport(value, transport.single_basis.size(), single_components)});
  }
  std::vector<Rgb> radiance;
  eval_transport(
      transport, TransportProjection(transport).fit(material),
      std::vector<Rgb>(scene.lights.size(), Rgb{1, 1, 1}),
      make_transport_view(positions, normals, scene.camera.position, material.eta, false),
      radiance);
  for (Rgb& value : radiance) value *= std::numbers::pi_v<float>;
  return radiance;
}

const Dipole* find_single_scattering(const Scene& scene, std::vector<std::string>& warnings) {
  const auto* material = std::get_if<Material>(&scene.material);
  const auto* dipole = material != nullptr ? std::get_if<Dipole>(material) : nullptr;
  if (dipole == nullptr || !dipole->single_scattering) return nullptr;
  if (scene.layers.empty()) return dipole;
  warnings.emplace_back("single scattering is left out under layers");
  return nullptr;
}

std::vector<MeshPlace> vertex_places(const TriangleMesh& mesh) {
  std::vector<MeshPlace> places(mesh.positions.size());
  for (std::size_t t = mesh.triangles.size(); t-- > 0;)
    for (std::size_t corner = 0; corner < 3; ++corner)
      places[mesh.triangles[t][corner]] = {static_cast<std::uint32_t>(t),
                                           {corner == 1 ? 1.0f : 0.0f, corner == 2 ? 1.0f : 0.0f}};
  return places;
}

std::vector<Rgb> compute_flux(const Scene& scene, const RayTracer& tracer,
                              const SurfaceSamples& samples, const RenderParams& params,
                              const Progress& progress) {
  IrradianceParams irradiance;
  irradiance.rays = params.rays;
  irradiance.seed = params.seed;
  std::vector<Rgb> flux =
      compute_irradiance(samples.points, scene.lights, tracer, boundary_of(scene.material),
                         eta_of(scene.material), irradiance, progress);
  for (Rgb& value : flux) value *= static_cast<float>(samples.area_mm2);
  return flux;
}

std::vector<Rgb> compute_exitance(const Scene& scene, const RayTracer& tracer,
                                  const SurfaceSamples& samples,
                                  const std::vector<MeshPlace>& targets, const RenderParams& params,
                                  RenderReport& report, const Progress& progress) {
  Stopwatch watch;
  std::vector<Rgb> flux = compute_flux(scene, tracer, samples, params, progress);
  report.irradiance_s = watch.lap();
  const GatherWork work{{scene, samples, targets}, params, report, progress};
  if (const auto* table = std::get_if<BssrdfTable>(&scene.material))
    return gather(work, *table, std::move(flux));
  std::vector<Rgb> exitance = gather(work, std::get<Material>(scene.material), std::move(flux));
  if (const Dipole* dipole = find_single_scattering(scene, report.warnings)) {
    const std::vector<Rgb> single =
        compute_single_exitance(work.input, tracer, *dipole, params.seed, progress);
    for (std::size_t i = 0; i < exitance.size(); ++i) exitance[i] += single[i];
  }
  return exitance;
}

}  // namespace parian

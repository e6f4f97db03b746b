#include <numbers>

#include "base/parallel.h"
#include "material/profile_field.h"
#include "render/exitance_internal.h"
#include "render/layered_field.h"
#include "scene/mapping.h"
#include "transport/gather_table.h"
#include "transport/irradiance.h"
#include "transport/moment_tree.h"
#include "transport/precompute.h"

namespace parian {
namespace {

constexpr std::size_t block = 1024;

GatherPoint to_gather_point(const SurfacePoint& point, const SamplePoint& place) {
  return {point.position, point.normal, static_cast<float>(place.x), static_cast<float>(place.y)};
}
TableGatherPoint to_table_point(const SurfacePoint& point, const SamplePoint& place) {
  return {point.position, point.normal, place};
}

// point(i) for i < count, each through `convert` with its place in the sample.
template <typename Point, typename Get, typename Convert>
std::vector<Point> map_points(std::size_t count, const Get& get, const Mapping& mapping,
                              const SampleGrid& grid, const Convert& convert) {
  std::vector<Point> points(count);
  parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SurfacePoint& point = get(i);
      points[i] = convert(point, map_to_sample(mapping, grid, point));
    }
  });
  return points;
}

struct GatherWork {
  const Scene& scene;
  const SurfaceSamples& samples;
  const std::vector<MeshPlace>& targets;
  const RenderParams& params;
  RenderReport& report;
  const Progress& progress;

  template <typename Point, typename Convert>
  std::vector<Point> map_samples(const SampleGrid& grid, const Convert& convert) const {
    return map_points<Point>(
        samples.points.size(), [&](std::size_t i) { return samples.points[i]; }, scene.mapping,
        grid, convert);
  }
  template <typename Point, typename Convert>
  std::vector<Point> map_targets(const SampleGrid& grid, const Convert& convert) const {
    return map_points<Point>(
        targets.size(), [&](std::size_t i) { return get_target(i); }, scene.mapping, grid, convert);
  }
  SurfacePoint get_target(std::size_t i) const {
    return get_surface_point(scene.mesh, targets[i].triangle, targets[i].barycentric);
  }
};

void report_brackets(const TreeGatherResult& result, RenderReport& report) {
  report.certified = result.certified;
  report.nodes_per_target = result.nodes_per_target;
  if (result.certified == 0) return;
  report.max_half_width = result.max_half_width;
  report.mean_half_width = result.mean_half_width;
}

// The field of the material or of the layers over it, with samples and targets at their places
// there.
ProfileField place_profiles(const GatherWork& work, const Material& material,
                            std::vector<GatherPoint>& samples, std::vector<GatherPoint>& targets) {
  const std::size_t count = work.samples.points.size(), all = count + work.targets.size();
  const auto get = [&](std::size_t i) {
    return i < count ? work.samples.points[i] : work.get_target(i - count);
  };
  std::optional<ProfileField> layered;
  if (!work.scene.layers.empty()) layered = make_layered_field(work.scene, all, get);
  if (!layered) {
    ProfileField field = make_profile_field(material);
    const SampleGrid grid{field.width, field.height, field.pixel_pitch_mm};
    samples = work.map_samples<GatherPoint>(grid, to_gather_point);
    targets = work.map_targets<GatherPoint>(grid, to_gather_point);
    return field;
  }
  samples.resize(count);
  targets.resize(work.targets.size());
  parallel_for_blocks(all, block, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const SurfacePoint point = get(i);
      const Vec2 place = layered_place(i);
      (i < count ? samples[i] : targets[i - count]) = {point.position, point.normal, place.x,
                                                       place.y};
    }
  });
  return std::move(*layered);
}

std::vector<Rgb> gather(const GatherWork& work, const Material& material, std::vector<Rgb> flux) {
  Stopwatch watch;
  GatherSources sources;
  std::vector<GatherPoint> targets;
  const ProfileField field = place_profiles(work, material, sources.points, targets);
  sources.flux = std::move(flux);
  sources.area_mm2 = work.samples.area_mm2;
  const double near_mm = default_near_mm(sources.area_mm2);
  if (work.params.method == GatherMethod::brute) {
    work.report.gather = "brute";
    std::vector<Rgb> exitance = gather_brute(field, sources, targets, near_mm, work.progress);
    work.report.gather_s = watch.lap();
    return exitance;
  }
  work.report.gather = "tree";
  const MomentTree tree(field, sources);
  work.report.tree_s = watch.lap();
  TreeGatherParams params;
  params.quality = work.params.quality;
  params.tolerance = work.params.tolerance;
  TreeGatherResult result = tree.gather(targets, near_mm, params, work.progress);
  work.report.gather_s = watch.lap();
  report_brackets(result, work.report);
  return std::move(result.exitance);
}

std::vector<Rgb> gather(const GatherWork& work, const BssrdfTable& table, std::vector<Rgb> flux) {
  Stopwatch watch;
  const TableHeader& header = table.header;
  const SampleGrid grid{header.width, header.height, header.pixel_pitch_mm};
  TableGatherSources sources;
  sources.points = work.map_samples<TableGatherPoint>(grid, to_table_point);
  sources.flux = std::move(flux);
  sources.area_mm2 = work.samples.area_mm2;
  const auto targets = work.map_targets<TableGatherPoint>(grid, to_table_point);
  work.report.gather = "table";
  std::vector<Rgb> exitance =
      gather_table(table, sources, targets, default_near_mm(sources.area_mm2), work.progress);
  work.report.gather_s = watch.lap();
  return exitance;
}

// Light that scatters once, as exitance that looks the same from the camera: pi L / F_t.
void add_single_scattering(const GatherWork& work, const RayTracer& tracer, const Dipole& material,
                           std::vector<Rgb>& exitance) {
  const Scene& scene = work.scene;
  std::vector<SurfacePoint> points;
  std::vector<Vec3> positions, normals;
  points.reserve(exitance.size());
  for (std::size_t i = 0; i < exitance.size(); ++i) {
    points.push_back(work.get_target(i));
    positions.push_back(points[i].position);
    normals.push_back(points[i].normal);
  }
  HomogeneousTransport transport = make_empty_transport(scene);
  transport.places = points.size();
  SingleScatteringParams params;
  params.seed = work.params.seed;
  for (const Light& light : scene.lights) {
    const std::vector<float> value =
        compute_single_transport(transport.single_basis, points, light, scene.mesh, tracer,
                                 material.eta, params, work.progress);
    transport.lights.push_back(
        {.single = pack_transport(value, transport.single_basis.size(), single_components)});
  }
  std::vector<Rgb> radiance;
  eval_transport(
      transport, TransportProjection(transport).fit(material),
      std::vector<Rgb>(scene.lights.size(), Rgb{1, 1, 1}),
      make_transport_view(positions, normals, scene.camera.position, material.eta, false),
      radiance);
  for (std::size_t i = 0; i < exitance.size(); ++i)
    exitance[i] += radiance[i] * std::numbers::pi_v<float>;
}

// Of a scene of one homogeneous material that asks for it.
const Dipole* find_single_scattering(const Scene& scene, RenderReport& report) {
  const auto* material = std::get_if<Material>(&scene.material);
  const auto* dipole = material != nullptr ? std::get_if<Dipole>(material) : nullptr;
  if (dipole == nullptr || !dipole->single_scattering) return nullptr;
  if (scene.layers.empty()) return dipole;
  report.warnings.emplace_back("single scattering is left out under layers");
  return nullptr;
}

}  // namespace

std::vector<MeshPlace> vertex_places(const TriangleMesh& mesh) {
  std::vector<MeshPlace> places(mesh.positions.size());
  for (std::size_t t = mesh.triangles.size(); t-- > 0;)
    for (std::size_t corner = 0; corner < 3; ++corner)
      places[mesh.triangles[t][corner]] = {static_cast<std::uint32_t>(t),
                                           {corner == 1 ? 1.0f : 0.0f, corner == 2 ? 1.0f : 0.0f}};
  return places;
}

std::vector<Rgb> compute_exitance(const Scene& scene, const RayTracer& tracer,
                                  const SurfaceSamples& samples,
                                  const std::vector<MeshPlace>& targets, const RenderParams& params,
                                  RenderReport& report, const Progress& progress) {
  Stopwatch watch;
  IrradianceParams irradiance;
  irradiance.rays = params.rays;
  irradiance.seed = params.seed;
  std::vector<Rgb> flux =
      compute_irradiance(samples.points, scene.lights, tracer, boundary_of(scene.material),
                         eta_of(scene.material), irradiance, progress);
  for (Rgb& value : flux) value *= static_cast<float>(samples.area_mm2);
  report.irradiance_s = watch.lap();
  const GatherWork work{scene, samples, targets, params, report, progress};
  if (const auto* table = std::get_if<BssrdfTable>(&scene.material))
    return gather(work, *table, std::move(flux));
  std::vector<Rgb> exitance = gather(work, std::get<Material>(scene.material), std::move(flux));
  if (const Dipole* dipole = find_single_scattering(scene, report))
    add_single_scattering(work, tracer, *dipole, exitance);
  return exitance;
}

}  // namespace parian

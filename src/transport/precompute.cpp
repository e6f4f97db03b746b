#include "transport/precompute.h"

#include <fmt/format.h>

#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/stopwatch.h"
#include "mesh/closed.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

// Light paths of single scattering, s_i' + s, and chords of multiple scattering: no distance in the
// mesh's box is longer than its diagonal. E has fallen to 1e-4 after 46 mm at sigma_t = 0.2 / mm.
constexpr double longest_path_mm = 46;

double diagonal_of(const TriangleMesh& mesh) {
  const Bounds3 box = bounds(mesh);
  const Vec3 size = box.upper - box.lower;
  return std::sqrt(static_cast<double>(dot(size, size)));
}

std::uint64_t hash_vec(Vec3 v, std::uint64_t seed) {
  return hash_value(v.z, hash_value(v.y, hash_value(v.x, seed)));
}

struct LightHash {
  std::uint64_t operator()(const DirectionalLight& light) const {
    return hash_vec(light.direction, hash_vec(light.irradiance, 1));
  }
  std::uint64_t operator()(const PointLight& light) const {
    return hash_vec(light.position, hash_vec(light.intensity, 2));
  }
  std::uint64_t operator()(const EnvironmentLight& light) const {
    std::uint64_t hash = hash_vec(light.scale, hash_value(light.rotation_deg, 3));
    hash = hash_value(light.image.height, hash_value(light.image.width, hash));
    return hash_values(light.image.values, hash);
  }
};

std::uint64_t hash_parameters(const PrecomputeParams& params, double eta) {
  std::uint64_t hash = hash_value(eta);
  const auto add = [&](auto value) { hash = hash_value(value, hash); };
  add(params.samples);
  add(params.rays);
  add(params.multiple_intervals);
  add(params.single_intervals);
  add(params.degree);
  add(static_cast<int>(params.knots));
  add(params.opening);
  add(params.single);
  add(params.single_params.path_samples);
  add(params.single_params.directions);
  add(static_cast<int>(params.single_params.method));
  add(params.single_params.resolution);
  add(params.seed);
  return hash;
}

// Each vertex as a point of one of its triangles.
std::vector<SurfacePoint> make_vertex_points(const TriangleMesh& mesh) {
  std::vector<SurfacePoint> points(mesh.positions.size());
  for (std::size_t t = mesh.triangles.size(); t-- > 0;)
    for (std::size_t corner = 0; corner < 3; ++corner)
      points[mesh.triangles[t][corner]] =
          get_surface_point(mesh, static_cast<std::uint32_t>(t),
                            {corner == 1 ? 1.0f : 0.0f, corner == 2 ? 1.0f : 0.0f});
  return points;
}

std::vector<GatherPoint> to_gather_points(const std::vector<SurfacePoint>& points) {
  std::vector<GatherPoint> out;
  out.reserve(points.size());
  for (const SurfacePoint& point : points)
    out.push_back({.position = point.position, .normal = point.normal});
  return out;
}

}  // namespace

ParamList describe(PrecomputeParams& params) {
  ParamList list{
      describe_samples(params.samples),
      describe_rays(params.rays),
      {.name = "multiple-intervals",
       .help = "of the basis for R_d",
       .target = &params.multiple_intervals,
       .min = 1,
       .max = 64},
      {.name = "single-intervals",
       .help = "of the basis for the attenuation",
       .target = &params.single_intervals,
       .min = 1,
       .max = 64},
      {.name = "degree",
       .help = "of both bases: 1 linear, 2 quadratic",
       .target = &params.degree,
       .min = 1,
       .max = 2},
      {.name = "knots",
       .help = "balanced over the range of coefficients, or as Xu et al. 2007 chose them",
       .target = make_choice(params.knots, {"balanced", "published"})},
      {.name = "opening",
       .help = "size over distance up to which samples are taken together; 0: never",
       .target = &params.opening,
       .min = 0,
       .max = 1},
      {.name = "single", .help = "single scattering too", .target = &params.single},
      describe_seed(params.seed)};
  for (Param& param : describe(params.single_params))
    if (param.name != "seed") list.push_back(std::move(param));
  return list;
}

TransportFingerprint fingerprint_of(const Scene& scene, const PrecomputeParams& params) {
  TransportFingerprint fingerprint;
  fingerprint.mesh = hash_values(
      scene.mesh.triangles, hash_values(scene.mesh.normals, hash_values(scene.mesh.positions)));
  fingerprint.parameters = hash_parameters(params, eta_of(scene.material));
  for (const Light& light : scene.lights)
    fingerprint.lights.push_back(std::visit(LightHash{}, light));
  return fingerprint;
}

HomogeneousTransport make_empty_transport(const Scene& scene, const PrecomputeParams& params) {
  HomogeneousTransport transport;
  transport.eta = eta_of(scene.material);
  transport.knots = params.knots;
  transport.places = scene.mesh.positions.size();
  const double diagonal = diagonal_of(scene.mesh);
  CurveBasisParams basis{params.multiple_intervals, params.degree, params.knots};
  transport.multiple_basis = make_reflectance_basis(diagonal, transport.eta, basis);
  basis.intervals = params.single_intervals;
  transport.single_basis = make_attenuation_basis(std::min(2 * diagonal, longest_path_mm), basis);
  return transport;
}

std::string light_name(const Scene& scene, std::size_t light) {
  static constexpr const char* kinds[] = {"directional", "point", "environment"};
  return fmt::format("light {} ({})", light + 1, kinds[scene.lights[light].index()]);
}

Precompute::Precompute(const Scene& scene, const RayTracer& tracer, const PrecomputeParams& params,
                       HomogeneousTransport done, const Progress& progress)
    : scene_(scene), tracer_(tracer), params_(params), transport_(std::move(done)) {
  check(describe(params_));
  params_.single_params.seed = params_.seed;
  if (transport_.lights.empty()) transport_ = make_empty_transport(scene, params_);
  PARIAN_CHECK_EQ(transport_.places, scene.mesh.positions.size());
  PARIAN_CHECK_LE(transport_.lights.size(), scene.lights.size());
  Stopwatch watch;
  samples_ = make_surface_samples(scene.mesh, static_cast<std::size_t>(params_.samples),
                                  params_.seed, progress);
  places_ = make_vertex_points(scene.mesh);
  report_.samples = samples_.points.size();
  report_.sample_spacing_mm = samples_.spacing_mm();
  report_.escaping_fraction = check_closed(samples_, tracer, scene.mesh_name, report_.warnings);
  report_.sampling_s = watch.lap();
}

void Precompute::advance(const Progress& progress) {
  if (is_done()) return;
  const std::size_t index = lights_done();
  transport_.lights.push_back(compute(index, scene_.lights[index], progress));
}

LightTransport Precompute::compute(std::size_t index, const Light& light,
                                   const Progress& progress) {
  LightTransport made;
  made.name = light_name(scene_, index);

  Stopwatch watch;
  GatherSources sources;
  sources.points = to_gather_points(samples_.points);
  sources.area_mm2 = samples_.area_mm2;
  IrradianceParams irradiance;
  irradiance.rays = params_.rays;
  irradiance.seed = params_.seed;
  sources.flux = compute_irradiance(samples_.points, {light}, tracer_, Boundary::excluded,
                                    transport_.eta, irradiance, progress);
  for (Rgb& value : sources.flux) value *= static_cast<float>(sources.area_mm2);
  report_.irradiance_s += watch.lap();

  const RadialMoments moments = compute_radial_moments(
      transport_.multiple_basis, sources, to_gather_points(places_),
      default_near_mm(sources.area_mm2), {.opening = params_.opening}, progress);
  made.multiple = pack_transport(moments.value, transport_.multiple_basis.size(), 3);
  report_.nodes_per_target = moments.nodes_per_target;
  report_.multiple_s += watch.lap();

  if (params_.single) {
    const std::vector<float> value =
        compute_single_transport(transport_.single_basis, places_, light, scene_.mesh, tracer_,
                                 transport_.eta, params_.single_params, progress);
    made.single = pack_transport(value, transport_.single_basis.size(), single_components);
    report_.single_s += watch.lap();
  }
  return made;
}

HomogeneousTransport precompute_transport(const Scene& scene, const PrecomputeParams& params,
                                          const Progress& progress) {
  const RayTracer tracer(scene.mesh);
  Precompute work(scene, tracer, params, {}, progress);
  while (!work.is_done()) work.advance(progress);
  return work.transport();
}

}  // namespace parian

#include "transport/single_scattering_reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "base/check.h"
#include "base/parallel.h"
#include "transport/depth_layers.h"
#include "transport/irradiance.h"
#include "transport/single_scattering.h"
#include "transport/single_scattering_kernels.h"

namespace parian {
namespace {

constexpr std::size_t views_per_block = 16, views_per_report = 256;
// The first nodes are this much denser than the attenuation's mean free path.
constexpr double nodes_per_free_path = 4;

struct Sources {
  std::vector<LightDirection> directions;
  std::vector<PointLight> lamps;
};

Sources collect(const std::vector<Light>& lights, const SingleReferenceParams& params) {
  Sources sources;
  for (const Light& light : lights) {
    if (const auto* lamp = std::get_if<PointLight>(&light)) {
      sources.lamps.push_back(*lamp);
      continue;
    }
    const auto more = make_light_directions(light, params.directions, params.seed);
    sources.directions.insert(sources.directions.end(), more.begin(), more.end());
  }
  return sources;
}

struct Medium {
  double sigma_s = 0, sigma_t = 0, three_g = 0;
  const CurveGain& gain;  // of the attenuation
};
Medium medium_of(const DipoleCoefficients& channel, const CurveGain& gain) {
  const double sigma_s = sigma_s_of(channel);
  return {sigma_s, channel.sigma_a + sigma_s, 3 * std::clamp(channel.g, -1.0 / 3, 1.0 / 3), gain};
}

struct Integrator {
  const TriangleMesh& mesh;
  const RayTracer& tracer;
  const Sources& sources;
  Bounds3 box;
  float eta = 1;
  SingleReferenceParams params;
};

// int int p F_t(w_i) e^{-sigma_t (s_i' + s)} L ds dw for one medium, all channels of the light.
std::array<double, 3> integrate(const Integrator& in, const SurfacePoint& point, Vec3 path,
                                double path_mm, Vec3 outgoing, const Medium& medium) {
  std::array<double, 3> sum{};
  float s[max_path_samples], weight[max_path_samples];
  const int nodes = (in.params.path_samples + 1) / 2 * 2;
  const double scale = std::min(path_mm, 1 / (nodes_per_free_path * medium.sigma_t));
  make_path_nodes(path_mm, nodes, scale, s, weight);
  for (int k = 0; k < nodes; ++k) {
    const Vec3 inside = point.position + path * s[k];
    const auto add = [&](const LightEntry& entry) {
      if (!entry.reached) return;
      const double phase =
          (1 - medium.three_g * static_cast<double>(dot(entry.direction, outgoing))) /
          (4 * std::numbers::pi);
      const double length_mm = entry.length_mm + static_cast<double>(s[k]);
      const double scattered = phase * static_cast<double>(weight[k]) *
                               eval_gain(medium.gain, length_mm) *
                               std::exp(-medium.sigma_t * length_mm);
      sum[0] += scattered * static_cast<double>(entry.light.x);
      sum[1] += scattered * static_cast<double>(entry.light.y);
      sum[2] += scattered * static_cast<double>(entry.light.z);
    };
    for (const LightDirection& light : in.sources.directions)
      add(find_entry(inside, light, in.mesh, in.tracer, in.eta));
    for (const PointLight& lamp : in.sources.lamps)
      add(find_entry(inside, lamp, in.mesh, in.tracer, in.eta));
  }
  for (double& channel : sum) channel *= medium.sigma_s;
  return sum;
}

Rgb integrate_view(const Integrator& in, const SurfaceView& view, const Dipole& material) {
  const Refraction out = refract_entry(view.point.normal, view.to_eye, in.eta);
  if (!(out.transmission > 0)) return {};
  const Vec3 path = in.params.path == ScatteringPath::view ? -out.direction : -view.point.normal;
  const double path_mm = find_path_length(view.point, path, in.box, in.tracer);
  if (!(path_mm > 0)) return {};
  std::array<double, 3> radiance{};
  for (std::size_t c = 0; c < material.channels.size(); ++c) {
    const Medium medium = medium_of(material.channels[c], material.attenuation_gain);
    if (!(medium.sigma_s > 0)) continue;
    const auto sum = integrate(in, view.point, path, path_mm, out.direction, medium);
    if (material.channels.size() == 1)
      radiance = sum;
    else
      radiance[c] = sum[c];
  }
  const double t = static_cast<double>(out.transmission);
  return {static_cast<float>(t * radiance[0]), static_cast<float>(t * radiance[1]),
          static_cast<float>(t * radiance[2])};
}

}  // namespace

ParamList describe(SingleReferenceParams& params) {
  return {{.name = "path",
           .help = "where a place looks for scattered light",
           .target = make_choice(params.path, {"normal", "view"})},
          {.name = "path-samples",
           .help = "points on each path into the object",
           .target = &params.path_samples,
           .min = 8,
           .max = static_cast<double>(max_path_samples)},
          {.name = "directions",
           .help = "directions of an environment light",
           .target = &params.directions,
           .min = 16,
           .max = 65536},
          {.name = "seed", .help = "of the environment's directions", .target = &params.seed}};
}

std::vector<Rgb> integrate_single_scattering(const std::vector<SurfaceView>& views,
                                             const std::vector<Light>& lights,
                                             const TriangleMesh& mesh, const RayTracer& tracer,
                                             const Dipole& material,
                                             const SingleReferenceParams& params,
                                             const Progress& progress) {
  check(describe(const_cast<SingleReferenceParams&>(params)));
  PARIAN_CHECK(material.eta >= 1);
  PARIAN_CHECK(material.channels.size() == 1 || material.channels.size() == 3);
  PARIAN_CHECK_EQ(mesh.normals.size(), mesh.positions.size());
  const Sources sources = collect(lights, params);
  const Integrator in{mesh,  tracer, sources, bounds(mesh), static_cast<float>(material.eta),
                      params};
  std::vector<Rgb> radiance(views.size());
  constexpr std::string_view stage = "single scattering";
  for (std::size_t first = 0; first < views.size(); first += views_per_report) {
    advance_progress(progress, stage,
                     static_cast<double>(first) / static_cast<double>(views.size()));
    parallel_for_blocks(std::min(views_per_report, views.size() - first), views_per_block,
                        [&](std::size_t begin, std::size_t end) {
                          for (std::size_t i = first + begin; i < first + end; ++i)
                            radiance[i] = integrate_view(in, views[i], material);
                        });
  }
  advance_progress(progress, stage, 1);
  return radiance;
}

}  // namespace parian

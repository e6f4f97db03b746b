// Paths into the object, directions of lights, and where light enters.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/random.h"
#include "scene/environment.h"
#include "transport/depth_layers.h"
#include "transport/single_scattering.h"
#include "transport/sobol_internal.h"

namespace parian {
namespace {

constexpr int max_skipped_entries = 16;

// Of the surface where a ray from inside meets it; none where it comes from outside.
std::optional<Vec3> normal_of(const TriangleMesh& mesh, const Hit& hit) {
  if (!hit.from_inside) return std::nullopt;
  const auto& corners = mesh.triangles[hit.triangle];
  const Vec2 b = hit.barycentric;
  return normalize(mesh.normals[corners[0]] * (1 - b.x - b.y) + mesh.normals[corners[1]] * b.x +
                   mesh.normals[corners[2]] * b.y);
}

Vec3 face_normal(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& corners = mesh.triangles[triangle];
  const Vec3 a = mesh.positions[corners[0]];
  return normalize(cross(mesh.positions[corners[1]] - a, mesh.positions[corners[2]] - a));
}

// What a ray towards the light passes: the entry, and from there nothing up to `reach` from inside.
LightEntry trace_entry(Vec3 inside, Vec3 direction, float reach, const TriangleMesh& mesh,
                       const RayTracer& tracer, float eta) {
  const auto hit = tracer.intersect({.origin = inside, .direction = direction, .t_max = reach});
  if (!hit) return {};
  const auto normal = normal_of(mesh, *hit);
  if (!normal) return {};
  const Refraction refraction = refract_entry(*normal, direction, eta);
  if (!(refraction.transmission > 0)) return {};
  const Vec3 outside =
      inside + direction * hit->t + face_normal(mesh, hit->triangle) * tracer.epsilon_mm();
  const float left = reach - hit->t;
  if (tracer.is_occluded({.origin = outside, .direction = direction, .t_max = left})) return {};
  const float t = refraction.transmission;
  return {.direction = refraction.direction,
          .light = {t, t, t},
          .length_mm = static_cast<double>(hit->t) * static_cast<double>(refraction.length_ratio),
          .distance_mm = hit->t,
          .reached = true};
}

}  // namespace

void make_path_nodes(double length_mm, int count, double scale_mm, float* s, float* weight) {
  const double reach = std::log1p(length_mm / scale_mm), width = 2 * reach / count;
  const double offsets[2] = {0.5 - std::sqrt(1.0 / 12), 0.5 + std::sqrt(1.0 / 12)};
  for (int interval = 0; 2 * interval < count; ++interval)
    for (const double offset : offsets) {
      const double grown = std::exp(width * (interval + offset));
      *s++ = static_cast<float>(scale_mm * (grown - 1));
      *weight++ = static_cast<float>(scale_mm * grown * width / 2);
    }
}

double find_path_length(const SurfacePoint& point, Vec3 direction, const Bounds3& box,
                        const RayTracer& tracer) {
  Ray ray{.origin = point.position, .direction = direction, .t_min = tracer.epsilon_mm()};
  for (int i = 0; i < max_skipped_entries; ++i) {
    const auto hit = tracer.intersect(ray);
    if (!hit) break;
    if (hit->from_inside) return static_cast<double>(hit->t);
    ray.t_min = hit->t + tracer.epsilon_mm();
  }
  double length = static_cast<double>(diagonal(box));
  for (int axis = 0; axis < 3; ++axis) {
    const double along = static_cast<double>(component(direction, axis));
    const double to_end = static_cast<double>(component(along > 0 ? box.upper : box.lower, axis)) -
                          static_cast<double>(component(point.position, axis));
    if (along != 0) length = std::min(length, std::max(0.0, to_end / along));
  }
  return length;
}

std::vector<LightDirection> make_light_directions(const Light& light, int count,
                                                  std::uint64_t seed) {
  if (const auto* sun = std::get_if<DirectionalLight>(&light))
    return {{sun->direction, sun->irradiance}};
  const auto* environment = std::get_if<EnvironmentLight>(&light);
  if (environment == nullptr) return {};
  const EnvironmentSampler sampler = make_environment_sampler(*environment);
  std::vector<LightDirection> directions;
  if (!(sampler.density > 0)) return directions;
  directions.reserve(static_cast<std::size_t>(count));
  const SobolScramble shuffle = make_scramble(hash_u64(seed, 0x51));
  for (const SobolPoint& place : make_sobol_points(count)) {
    const DirectionSample drawn = sample_environment(sampler, scramble(place, shuffle));
    if (!(drawn.pdf > 0)) continue;
    const float share = 1 / (drawn.pdf * static_cast<float>(count));
    directions.push_back({drawn.direction, eval_environment_at(*environment, drawn.uv) * share});
  }
  return directions;
}

LightEntry find_entry(Vec3 inside, const LightDirection& light, const TriangleMesh& mesh,
                      const RayTracer& tracer, float eta) {
  LightEntry entry = trace_entry(inside, light.direction, std::numeric_limits<float>::infinity(),
                                 mesh, tracer, eta);
  entry.light = entry.light * light.weight;
  return entry;
}

LightEntry find_entry(Vec3 inside, const PointLight& light, const TriangleMesh& mesh,
                      const RayTracer& tracer, float eta) {
  const float reach = distance(inside, light.position);
  if (!(reach > 0)) return {};
  LightEntry entry =
      trace_entry(inside, (light.position - inside) / reach, reach, mesh, tracer, eta);
  const float left = reach - entry.distance_mm;
  if (!(left > 0)) return {};
  entry.light = entry.light * light.intensity * (1 / left / left);
  return entry;
}

}  // namespace parian

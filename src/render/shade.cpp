#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/parallel.h"
#include "base/random.h"
#include "render/shade_internal.h"
#include "render/specular_internal.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

// Rays of each kind (facets, brightness) to each environment light, shared by a pixel's sub-rays.
constexpr int specular_rays = 8;
// Interpolated normals may turn away at a silhouette: their cosine to the viewer is at least this
// (or the triangle's own), so that no edge is black.
constexpr float least_cosine = 0.1f;

struct Shader {
  const Scene& scene;
  const PrimaryView& view;
  const std::vector<Rgb>& exitance;
  bool per_vertex = false;
  bool is_transmitting = false;  // Fresnel transmission towards the viewer
  float eta = 1.3f;              // of that
  float alpha = 0.1f;
  std::uint64_t seed = 1;
  std::optional<SpecularShader> specular;
};

Rgb exitance_at(const Shader& shader, const PrimaryHit& hit) {
  if (!shader.per_vertex) return shader.exitance[hit.target];
  const auto& v = shader.scene.mesh.triangles[hit.triangle];
  const Vec2 b = hit.barycentric;
  return shader.exitance[v[0]] * (1 - b.x - b.y) + shader.exitance[v[1]] * b.x +
         shader.exitance[v[2]] * b.y;
}

// The point as the viewer sees it.
Reflector make_reflector(const Shader& shader, const SurfacePoint& point, bool from_inside) {
  Reflector seen;
  const float side = from_inside ? -1.0f : 1.0f;
  seen.position = point.position;
  seen.view = normalize(shader.view.frame.position - point.position);
  seen.geometric_normal = point.geometric_normal * side;
  seen.normal = point.normal * side;
  const float wanted = std::clamp(dot(seen.geometric_normal, seen.view), 1e-4f, least_cosine);
  const float cosine = dot(seen.normal, seen.view);
  if (cosine < wanted) {  // bend it towards the viewer until it is seen at that cosine
    const Vec3 across = normalize(seen.normal - seen.view * cosine);
    seen.normal = normalize(seen.view * wanted + across * std::sqrt(1 - wanted * wanted));
  }
  return seen;
}

// For each hit the variance of the normals among those that share its target, per sub-pixel cell:
// slopes that the sub-rays miss (Tokuyoshi and Kaplanyan 2019: alpha^2 grows by it, up to 0.18).
float normal_variance(const std::vector<SurfacePoint>& points, const PrimaryHit* hits,
                      std::size_t count, std::size_t i, int antialias) {
  Vec3 sum;
  float members = 0;
  for (std::size_t j = 0; j < count; ++j) {
    if (hits[j].target != hits[i].target) continue;
    sum += points[j].normal;
    ++members;
  }
  const Vec3 mean = sum / members;
  const float variance = std::max(0.0f, 1 - dot(mean, mean));
  return std::min(0.18f, variance / static_cast<float>(antialias * antialias));
}

Rgb shade_hit(const Shader& shader, const PrimaryHit& hit, Reflector seen,
              const PixelSequence& sequence, std::uint32_t rays) {
  const float transmission =
      shader.is_transmitting ? fresnel_transmission(shader.eta, dot(seen.normal, seen.view)) : 1.0f;
  Rgb radiance = exitance_at(shader, hit) * (transmission / std::numbers::pi_v<float>);
  if (shader.specular)
    radiance += eval_specular(*shader.specular, seen, sequence, hit.sub_ray * rays, rays);
  return radiance;
}

Rgb shade_hits(const Shader& shader, std::size_t pixel) {
  const PrimaryView& view = shader.view;
  const PrimaryHit* hits = view.hits.data() + view.begin[pixel];
  const std::size_t count = view.begin[pixel + 1] - view.begin[pixel];
  const int sub_rays = view.antialias * view.antialias;
  const auto rays = static_cast<std::uint32_t>((specular_rays + sub_rays - 1) / sub_rays);
  const PixelSequence sequence{hash_u64(shader.seed, pixel),
                               static_cast<std::uint32_t>(sub_rays) * rays};
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(get_surface_point(shader.scene.mesh, hits[i].triangle, hits[i].barycentric));
  Rgb sum;
  for (std::size_t i = 0; i < count; ++i) {
    Reflector seen = make_reflector(shader, points[i], hits[i].from_inside);
    const float spread =
        shader.specular ? normal_variance(points, hits, count, i, view.antialias) : 0.0f;
    seen.alpha = std::min(1.0f, std::sqrt(shader.alpha * shader.alpha + spread));
    sum += shade_hit(shader, hits[i], seen, sequence, rays);
  }
  return sum;
}

Rgb environment_behind(const Scene& scene, Vec3 direction) {
  Rgb sum;
  for (const Light& light : scene.lights)
    if (const auto* environment = std::get_if<EnvironmentLight>(&light))
      sum += eval_environment(*environment, direction);
  return sum;
}

// Sub-rays that hit nothing.
Rgb shade_background(const Shader& shader, std::size_t pixel, float exposure) {
  const PrimaryView& view = shader.view;
  const int sub_rays = view.antialias * view.antialias;
  std::size_t next = view.begin[pixel];
  const std::size_t end = view.begin[pixel + 1];
  if (!shader.scene.show_environment)
    return shader.scene.background * static_cast<float>(sub_rays - static_cast<int>(end - next));
  const auto width = static_cast<std::size_t>(view.frame.width);
  Rgb sum;
  for (int s = 0; s < sub_rays; ++s) {
    if (next < end && view.hits[next].sub_ray == s) {
      ++next;
      continue;
    }
    const CameraRay ray = make_sub_ray(view.frame, view.antialias, static_cast<int>(pixel % width),
                                       static_cast<int>(pixel / width), s);
    sum += environment_behind(shader.scene, ray.direction) * exposure;
  }
  return sum;
}

Shader make_shader(const Scene& scene, const RayTracer& tracer, const PrimaryView& view,
                   const std::vector<Rgb>& exitance, const RenderParams& params) {
  Shader shader{scene, view, exitance};
  shader.per_vertex = params.shading == Shading::vertex;
  shader.is_transmitting = boundary_of(scene.material) == Boundary::excluded;
  shader.eta = static_cast<float>(eta_of(scene.material));
  shader.alpha = specular_alpha(scene.specular.roughness);
  shader.seed = params.seed;
  if (scene.specular.enabled)
    shader.specular.emplace(scene.lights, tracer,
                            scene.specular.eta > 0 ? scene.specular.eta : eta_of(scene.material));
  return shader;
}

}  // namespace

Image shade(const Scene& scene, const RayTracer& tracer, const PrimaryView& view,
            const std::vector<Rgb>& exitance, const RenderParams& params,
            const Progress& progress) {
  const Shader shader = make_shader(scene, tracer, view, exitance, params);
  const int width = view.frame.width, height = view.frame.height;
  const float exposure = std::exp2(static_cast<float>(scene.exposure));
  const float share = 1 / static_cast<float>(view.antialias * view.antialias);
  Image image = make_image(width, height, 3);
  constexpr int batch = 32;  // rows between two looks at the progress
  for (int first = 0; first < height; first += batch) {
    advance_progress(progress, "shading", static_cast<double>(first) / height);
    parallel_for(static_cast<std::size_t>(std::min(batch, height - first)), [&](std::size_t i) {
      const int y = first + static_cast<int>(i);
      for (int x = 0; x < width; ++x) {
        const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(x);
        const Rgb radiance =
            (shade_hits(shader, pixel) * exposure + shade_background(shader, pixel, exposure)) *
            share;
        at(image, x, y, 0) = radiance.x;
        at(image, x, y, 1) = radiance.y;
        at(image, x, y, 2) = radiance.z;
      }
    });
  }
  return image;
}

}  // namespace parian

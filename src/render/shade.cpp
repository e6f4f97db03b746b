#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"
#include "base/random.h"
#include "render/shade_internal.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

// Rays of each kind (facets, brightness) to each environment light, shared by a pixel's sub-rays.
constexpr int specular_rays = 8;
// Interpolated normals may turn away at a silhouette: their cosine to the viewer is at least this
// (or the triangle's own), so that no edge is black.
constexpr float least_cosine = 0.1f;

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

Rgb environment_behind(const Scene& scene, Vec3 direction) {
  Rgb sum;
  for (const Light& light : scene.lights)
    if (const auto* environment = std::get_if<EnvironmentLight>(&light))
      sum += eval_environment(*environment, direction);
  return sum;
}

}  // namespace

PixelShader::PixelShader(const Scene& scene, const RayTracer& tracer, const PrimaryView& view,
                         const std::vector<Rgb>& exitance, const RenderParams& params)
    : scene_(scene), view_(view), exitance_(exitance) {
  per_vertex_ = params.shading == Shading::vertex;
  is_transmitting_ = boundary_of(scene.material) == Boundary::excluded;
  eta_ = static_cast<float>(eta_of(scene.material));
  alpha_ = specular_alpha(scene.specular.roughness);
  exposure_ = std::exp2(static_cast<float>(scene.exposure));
  seed_ = params.seed;
  if (scene.specular.enabled)
    specular_.emplace(scene.lights, tracer,
                      scene.specular.eta > 0 ? scene.specular.eta : eta_of(scene.material));
}

Rgb PixelShader::exitance_at(const PrimaryHit& hit) const {
  if (!per_vertex_) return exitance_[hit.target];
  const auto& v = scene_.mesh.triangles[hit.triangle];
  const Vec2 b = hit.barycentric;
  return exitance_[v[0]] * (1 - b.x - b.y) + exitance_[v[1]] * b.x + exitance_[v[2]] * b.y;
}

// The point as the viewer sees it.
Reflector PixelShader::make_reflector(const SurfacePoint& point, bool from_inside) const {
  Reflector seen;
  const float side = from_inside ? -1.0f : 1.0f;
  seen.position = point.position;
  seen.view = normalize(view_.frame.position - point.position);
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

Rgb PixelShader::shade_hit(const PrimaryHit& hit, Reflector seen, const PixelSequence& sequence,
                           std::uint32_t rays) const {
  const float transmission =
      is_transmitting_ ? fresnel_transmission(eta_, dot(seen.normal, seen.view)) : 1.0f;
  Rgb radiance = exitance_at(hit) * (transmission / std::numbers::pi_v<float>);
  if (specular_) radiance += eval_specular(*specular_, seen, sequence, hit.sub_ray * rays, rays);
  return radiance;
}

Rgb PixelShader::shade_hits(std::size_t pixel) const {
  const PrimaryHit* hits = view_.hits.data() + view_.begin[pixel];
  const std::size_t count = view_.begin[pixel + 1] - view_.begin[pixel];
  const int sub_rays = view_.antialias * view_.antialias;
  const auto rays = static_cast<std::uint32_t>((specular_rays + sub_rays - 1) / sub_rays);
  const PixelSequence sequence{hash_u64(seed_, pixel), static_cast<std::uint32_t>(sub_rays) * rays};
  std::vector<SurfacePoint> points;
  for (std::size_t i = 0; i < count; ++i)
    points.push_back(get_surface_point(scene_.mesh, hits[i].triangle, hits[i].barycentric));
  Rgb sum;
  for (std::size_t i = 0; i < count; ++i) {
    Reflector seen = make_reflector(points[i], hits[i].from_inside);
    const float spread =
        specular_ ? normal_variance(points, hits, count, i, view_.antialias) : 0.0f;
    seen.alpha = std::min(1.0f, std::sqrt(alpha_ * alpha_ + spread));
    sum += shade_hit(hits[i], seen, sequence, rays);
  }
  return sum;
}

// Sub-rays that hit nothing.
Rgb PixelShader::shade_background(std::size_t pixel) const {
  const int sub_rays = view_.antialias * view_.antialias;
  std::size_t next = view_.begin[pixel];
  const std::size_t end = view_.begin[pixel + 1];
  if (!scene_.show_environment)
    return scene_.background * static_cast<float>(sub_rays - static_cast<int>(end - next));
  const auto width = static_cast<std::size_t>(view_.frame.width);
  Rgb sum;
  for (int s = 0; s < sub_rays; ++s) {
    if (next < end && view_.hits[next].sub_ray == s) {
      ++next;
      continue;
    }
    const CameraRay ray =
        make_sub_ray(view_.frame, view_.antialias, static_cast<int>(pixel % width),
                     static_cast<int>(pixel / width), s);
    sum += environment_behind(scene_, ray.direction) * exposure_;
  }
  return sum;
}

Rgb PixelShader::shade(std::size_t pixel) const {
  const float share = 1 / static_cast<float>(view_.antialias * view_.antialias);
  return (shade_hits(pixel) * exposure_ + shade_background(pixel)) * share;
}

Image shade(const Scene& scene, const RayTracer& tracer, const PrimaryView& view,
            const std::vector<Rgb>& exitance, const RenderParams& params,
            const Progress& progress) {
  const PixelShader shader(scene, tracer, view, exitance, params);
  const int width = view.frame.width, height = view.frame.height;
  Image image = make_image(width, height, 3);
  constexpr int batch = 32;  // rows between two looks at the progress
  for (int first = 0; first < height; first += batch) {
    advance_progress(progress, "shading", static_cast<double>(first) / height);
    parallel_for(static_cast<std::size_t>(std::min(batch, height - first)), [&](std::size_t i) {
      const int y = first + static_cast<int>(i);
      for (int x = 0; x < width; ++x) {
        const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(x);
        const Rgb radiance = shader.shade(pixel);
        at(image, x, y, 0) = radiance.x;
        at(image, x, y, 1) = radiance.y;
        at(image, x, y, 2) = radiance.z;
      }
    });
  }
  return image;
}

}  // namespace parian

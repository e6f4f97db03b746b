#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "render/specular_internal.h"
#include "transport/irradiance.h"

namespace parian {
namespace {

constexpr float pi = std::numbers::pi_v<float>;

// D(h). sin^2 comes from the tangent components, as 1 - cos^2 has no digits left for small alpha.
float eval_distribution(float alpha, Vec3 local_h) {
  const float a2 = alpha * alpha;
  const float sin2 = local_h.x * local_h.x + local_h.y * local_h.y;
  const float t = sin2 + a2 * local_h.z * local_h.z;
  return t > 0 ? a2 / (pi * t * t) : 0.0f;
}

// n.w (2 / G1(w) - 1)
float masking_root(float alpha, float cosine) {
  const float a2 = alpha * alpha;
  return std::sqrt(a2 + (1 - a2) * cosine * cosine);
}

Vec3 offset_origin(const SpecularShader& shader, const Reflector& reflector) {
  return reflector.position + reflector.geometric_normal * shader.tracer.epsilon_mm();
}

bool is_visible(const SpecularShader& shader, const Reflector& reflector, Vec3 light,
                float distance_mm) {
  if (dot(reflector.geometric_normal, light) <= 0) return false;
  return !shader.tracer.is_occluded({offset_origin(shader, reflector), light, 0, distance_mm});
}

Rgb reflect_from(const SpecularShader& shader, const Reflector& reflector, Vec3 light,
                 Rgb irradiance, float distance_mm) {
  const float f = eval_ggx(reflector.alpha, shader.eta, reflector.normal, reflector.view, light);
  if (f <= 0 || !is_visible(shader, reflector, light, distance_mm)) return {};
  return irradiance * f;
}

Rgb reflect(const SpecularShader& shader, const Reflector& reflector,
            const DirectionalLight& light) {
  return reflect_from(shader, reflector, light.direction, light.irradiance,
                      std::numeric_limits<float>::infinity());
}

Rgb reflect(const SpecularShader& shader, const Reflector& reflector, const PointLight& light) {
  const Vec3 to_light = light.position - reflector.position;
  const float far = length(to_light);
  if (!(far > 0)) return {};
  return reflect_from(shader, reflector, to_light / far, light.intensity / (far * far), far);
}

// One direction of either kind; both densities are in the weight (balance heuristic, as many rays
// of each).
Rgb reflect_ray(const SpecularShader& shader, const Reflector& reflector,
                const EnvironmentSampler& sampler, Vec3 light) {
  const float f = eval_ggx(reflector.alpha, shader.eta, reflector.normal, reflector.view, light);
  if (f <= 0) return {};
  const float pdf = pdf_ggx(reflector.alpha, reflector.normal, reflector.view, light) +
                    pdf_environment(sampler, light);
  if (!(pdf > 0) || !is_visible(shader, reflector, light, std::numeric_limits<float>::infinity()))
    return {};
  return eval_environment(*sampler.light, light) * (f / pdf);
}

Rgb reflect(const SpecularShader& shader, const Reflector& reflector,
            const EnvironmentSampler& sampler, const PixelSequence& sequence, std::uint32_t first,
            std::uint32_t rays) {
  Rgb sum;
  for (std::uint32_t i = first; i < first + rays; ++i) {
    sum += reflect_ray(
        shader, reflector, sampler,
        sample_ggx(reflector.alpha, reflector.normal, reflector.view, sample_2d(sequence, i, 0)));
    const DirectionSample bright = sample_environment(sampler, sample_2d(sequence, i, 1));
    if (bright.pdf > 0) sum += reflect_ray(shader, reflector, sampler, bright.direction);
  }
  return sum / static_cast<float>(rays);
}

}  // namespace

float specular_alpha(double roughness) {
  return std::max(1e-3f, static_cast<float>(roughness * roughness));
}

float eval_ggx(float alpha, float eta, Vec3 normal, Vec3 view, Vec3 light) {
  const float nl = dot(normal, light), nv = dot(normal, view);
  if (nl <= 0 || nv <= 0) return 0;
  const Vec3 h = normalize(view + light);
  const float vh = std::min(1.0f, dot(view, h));
  if (vh <= 0) return 0;
  const float fresnel = 1 - fresnel_transmission(eta, vh);
  const float d = eval_distribution(alpha, to_local(make_frame(normal), h));
  // G / (4 n.l n.v)
  const float visible = 0.5f / (nl * masking_root(alpha, nv) + nv * masking_root(alpha, nl));
  return fresnel * d * visible * nl;
}

Vec3 sample_ggx(float alpha, Vec3 normal, Vec3 view, Vec2 random) {
  const Frame frame = make_frame(normal);
  const Vec3 v = to_local(frame, view);
  const Vec3 stretched = normalize({alpha * v.x, alpha * v.y, v.z});
  const Frame around = make_frame(stretched);
  // A disc seen from the view, its lower part squeezed by the foreshortening of the hemisphere.
  const float r = std::sqrt(random.x), angle = 2 * pi * random.y;
  const float t1 = r * std::cos(angle);
  // The tangent frame's second axis must lie in the plane of view and normal.
  Vec3 side = cross(Vec3{0, 0, 1}, stretched);
  side = dot(side, side) > 1e-12f ? normalize(side) : around.tangent;
  const Vec3 up = cross(stretched, side);
  const float s = 0.5f * (1 + stretched.z);
  const float t2 = (1 - s) * std::sqrt(std::max(0.0f, 1 - t1 * t1)) + s * r * std::sin(angle);
  const Vec3 n = side * t1 + up * t2 + stretched * std::sqrt(std::max(0.0f, 1 - t1 * t1 - t2 * t2));
  const Vec3 h = to_world(frame, normalize({alpha * n.x, alpha * n.y, std::max(1e-6f, n.z)}));
  return normalize(h * (2 * dot(view, h)) - view);
}

float pdf_ggx(float alpha, Vec3 normal, Vec3 view, Vec3 light) {
  const float nv = dot(normal, view);
  if (nv <= 0) return 0;
  const Vec3 h = normalize(view + light);
  if (dot(normal, h) <= 0) return 0;
  // G1(v) D(h) v.h / n.v / (4 v.h)
  return eval_distribution(alpha, to_local(make_frame(normal), h)) /
         (2 * (nv + masking_root(alpha, nv)));
}

SpecularShader::SpecularShader(const std::vector<Light>& lights_, const RayTracer& tracer_,
                               double eta_)
    : lights(lights_), tracer(tracer_), eta(static_cast<float>(eta_)) {
  for (const Light& light : lights)
    if (const auto* environment = std::get_if<EnvironmentLight>(&light))
      samplers.push_back(make_environment_sampler(*environment));
}

Vec2 sample_2d(const PixelSequence& sequence, std::uint32_t i, std::uint64_t dimension) {
  // Hammersley: i / count, and i with its bits reversed; shifted around (Cranley-Patterson).
  std::uint32_t bits = i;
  bits = (bits << 16) | (bits >> 16);
  bits = ((bits & 0x00ff00ffu) << 8) | ((bits & 0xff00ff00u) >> 8);
  bits = ((bits & 0x0f0f0f0fu) << 4) | ((bits & 0xf0f0f0f0u) >> 4);
  bits = ((bits & 0x33333333u) << 2) | ((bits & 0xccccccccu) >> 2);
  bits = ((bits & 0x55555555u) << 1) | ((bits & 0xaaaaaaaau) >> 1);
  const std::uint64_t shift = hash_u64(sequence.key, dimension);
  const auto wrap = [](double value) {
    return std::min(static_cast<float>(value - std::floor(value)), 0.99999994f);
  };
  return {wrap((i + 0.5) / sequence.count + hash_to_uniform(shift)),
          wrap(bits * 0x1p-32 + hash_to_uniform(hash_u64(shift)))};
}

Rgb eval_specular(const SpecularShader& shader, const Reflector& reflector,
                  const PixelSequence& sequence, std::uint32_t first, std::uint32_t rays) {
  Rgb sum;
  for (const Light& light : shader.lights) {
    if (const auto* directional = std::get_if<DirectionalLight>(&light))
      sum += reflect(shader, reflector, *directional);
    if (const auto* point = std::get_if<PointLight>(&light))
      sum += reflect(shader, reflector, *point);
  }
  for (const EnvironmentSampler& sampler : shader.samplers)
    sum += reflect(shader, reflector, sampler, sequence, first, rays);
  return sum;
}

}  // namespace parian

#include "transport/irradiance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/parallel.h"
#include "base/random.h"
#include "scene/environment.h"
#include "transport/sobol_internal.h"

namespace parian {
namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr std::size_t max_bright_samples = 1 << 19;
constexpr std::size_t points_per_block = 64;
constexpr std::size_t rays_per_report = 1 << 19;

// What the integrand at a point needs.
struct Receiver {
  const RayTracer& tracer;
  float epsilon_mm = 0;
  bool transmits = false;  // F = Fresnel transmission into eta
  float eta = 1;
};

// F (n . w), or 0 where the surface turns away from w.
float eval_receiver(const Receiver& receiver, const SurfacePoint& point, Vec3 direction) {
  const float cosine = dot(point.normal, direction);
  if (!(cosine > 0) || !(dot(point.geometric_normal, direction) > 0)) return 0;
  return receiver.transmits ? cosine * fresnel_transmission(receiver.eta, cosine) : cosine;
}

bool is_visible(const Receiver& receiver, const SurfacePoint& point, Vec3 direction,
                float t_max = std::numeric_limits<float>::infinity()) {
  return !receiver.tracer.is_occluded(
      {.origin = point.position + point.geometric_normal * receiver.epsilon_mm,
       .direction = direction,
       .t_max = t_max});
}

Rgb receive(const Receiver& receiver, const SurfacePoint& point, const DirectionalLight& light) {
  const float weight = eval_receiver(receiver, point, light.direction);
  if (!(weight > 0) || !is_visible(receiver, point, light.direction)) return {};
  return light.irradiance * weight;
}

Rgb receive(const Receiver& receiver, const SurfacePoint& point, const PointLight& light) {
  const Vec3 origin = point.position + point.geometric_normal * receiver.epsilon_mm;
  const float reach = distance(origin, light.position);
  const float r = distance(point.position, light.position);
  if (!(reach > 0 && r > 0)) return {};
  const Vec3 direction = (light.position - point.position) / r;
  const float weight = eval_receiver(receiver, point, direction);
  if (!(weight > 0)) return {};
  // The ray goes from the offset origin to the light, not past it.
  if (receiver.tracer.is_occluded(
          {.origin = origin, .direction = (light.position - origin) / reach, .t_max = reach}))
    return {};
  return light.intensity * (weight / r / r);
}

// A direction drawn by brightness.
struct BrightSample {
  Vec3 direction;
  Rgb radiance;
  float density = 0;  // n_b p_b
};

// Environment light by two techniques, b by brightness and c by cosine; each sample of either
// counts f / (n_b p_b + n_c p_c): the balance heuristic (Veach and Guibas 1995).
//
// Samples by brightness do not depend on the point. They are drawn once, in `sets` of n_b, each a
// stratified sequence of its own; points take sets by turns of a hash. What points share in this
// way is an error 1 / sqrt(sets) of the noise of one point.
struct EnvironmentRays {
  EnvironmentSampler sampler;
  std::vector<SobolPoint> sequence;
  std::vector<BrightSample> bright;  // [set][n_b]
  std::size_t sets = 1;
  std::size_t by_brightness = 0;  // n_b
  std::size_t by_cosine = 0;      // n_c
  std::uint64_t seed = 0;
};

// Neighbouring directions one after another, so that successive rays meet the same triangles.
std::uint32_t direction_cell(Vec2 uv) {
  const auto spread = [](float part) {
    const auto cell = static_cast<std::uint32_t>(part * 8);
    return (cell & 1u) | ((cell & 2u) << 1u) | ((cell & 4u) << 2u);
  };
  return spread(uv.x) | (spread(uv.y) << 1u);
}

void draw_bright_set(EnvironmentRays& rays, std::size_t set) {
  const SobolScramble seed = make_scramble(hash_u64(hash_u64(rays.seed, 0), set));
  std::vector<std::pair<std::uint32_t, BrightSample>> ordered(rays.by_brightness);
  for (std::size_t i = 0; i < rays.by_brightness; ++i) {
    const DirectionSample drawn =
        sample_environment(rays.sampler, scramble(rays.sequence[i], seed));
    ordered[i] = {direction_cell(drawn.uv),
                  {drawn.direction, eval_environment_at(*rays.sampler.light, drawn.uv),
                   static_cast<float>(rays.by_brightness) * drawn.pdf}};
  }
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < rays.by_brightness; ++i)
    rays.bright[set * rays.by_brightness + i] = ordered[i].second;
}

// A ray to be traced and what it brings.
struct Candidate {
  Vec3 direction;
  Rgb value;  // L F (n . w) / (n_b p_b + n_c p_c)
};
constexpr std::size_t batch_size = 32;

// Draws samples [begin, end) by the cosine into `batch`, as far as they can count; returns how
// many. Apart from tracing, so that the lookups in large images overlap.
std::size_t draw_cosine_batch(const EnvironmentRays& rays, const Receiver& receiver,
                              const SurfacePoint& point, SobolScramble seed, std::size_t begin,
                              std::size_t end, Candidate* batch) {
  const Frame frame = make_frame(point.normal);
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const Vec2 random = scramble(rays.sequence[i], seed);
    const float radius = std::sqrt(random.y), phi = 2 * pi * random.x;
    const Vec3 direction =
        to_world(frame, {radius * std::cos(phi), radius * std::sin(phi), std::sqrt(1 - random.y)});
    const float weight = eval_receiver(receiver, point, direction);
    if (!(weight > 0)) continue;
    const Vec2 uv = environment_uv(*rays.sampler.light, direction);
    const EnvironmentValue light = eval_with_pdf(rays.sampler, uv);
    const float density = static_cast<float>(rays.by_brightness) * light.pdf +
                          static_cast<float>(rays.by_cosine) / pi * dot(point.normal, direction);
    if (light.radiance != Rgb{}) batch[count++] = {direction, light.radiance * (weight / density)};
  }
  return count;
}

// Of set `set` of the samples by brightness.
std::size_t pick_bright_batch(const EnvironmentRays& rays, const Receiver& receiver,
                              const SurfacePoint& point, std::size_t set, std::size_t begin,
                              std::size_t end, Candidate* batch) {
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const BrightSample& sample = rays.bright[set * rays.by_brightness + i];
    const float weight = eval_receiver(receiver, point, sample.direction);
    if (!(weight > 0 && sample.density > 0) || sample.radiance == Rgb{}) continue;
    const float density = sample.density + static_cast<float>(rays.by_cosine) / pi *
                                               dot(point.normal, sample.direction);
    batch[count++] = {sample.direction, sample.radiance * (weight / density)};
  }
  return count;
}

Rgb receive(const Receiver& receiver, const SurfacePoint& point, const EnvironmentRays& rays,
            std::size_t index) {
  Rgb sum;
  std::array<Candidate, batch_size> batch;
  const auto trace = [&](std::size_t count) {
    for (std::size_t k = 0; k < count; ++k)
      if (is_visible(receiver, point, batch[k].direction)) sum += batch[k].value;
  };
  const std::uint64_t key = hash_u64(hash_u64(rays.seed, 1), index);
  const std::size_t set = index < rays.sets ? index : static_cast<std::size_t>(key % rays.sets);
  for (std::size_t i = 0; i < rays.by_brightness; i += batch_size)
    trace(pick_bright_batch(rays, receiver, point, set, i,
                            std::min(i + batch_size, rays.by_brightness), batch.data()));
  const SobolScramble seed = make_scramble(key);
  for (std::size_t i = 0; i < rays.by_cosine; i += batch_size)
    trace(draw_cosine_batch(rays, receiver, point, seed, i,
                            std::min(i + batch_size, rays.by_cosine), batch.data()));
  return sum;
}

// Per light, in the lights' order; none where the light is no environment or is black.
std::vector<std::optional<EnvironmentRays>> prepare(const std::vector<Light>& lights,
                                                    std::size_t points,
                                                    const IrradianceParams& params) {
  std::vector<std::optional<EnvironmentRays>> prepared(lights.size());
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const auto* light = std::get_if<EnvironmentLight>(&lights[i]);
    if (light == nullptr) continue;
    EnvironmentRays rays;
    rays.sampler = make_environment_sampler(*light);
    if (!(rays.sampler.density > 0)) continue;
    rays.by_brightness = static_cast<std::size_t>(params.rays / 2);
    rays.by_cosine = static_cast<std::size_t>(params.rays) - rays.by_brightness;
    rays.seed = hash_u64(params.seed, i);
    rays.sequence = make_sobol_points(static_cast<int>(rays.by_cosine));
    rays.sets =
        std::clamp<std::size_t>(max_bright_samples / std::max<std::size_t>(1, rays.by_brightness),
                                1, std::max<std::size_t>(1, points));
    rays.bright.resize(rays.sets * rays.by_brightness);
    parallel_for_blocks(rays.sets, 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t set = begin; set < end; ++set) draw_bright_set(rays, set);
    });
    prepared[i] = std::move(rays);
  }
  return prepared;
}

}  // namespace

ParamList describe(IrradianceParams& params) {
  return {{.name = "rays",
           .help = "shadow rays per irradiance sample and environment light",
           .target = &params.rays,
           .min = 1,
           .max = 1 << 20},
          {.name = "seed", .help = "of the rays' directions", .target = &params.seed}};
}

Param describe_samples(int& samples, double most) {
  return {.name = "samples",
          .help = "points of the surface at which light enters",
          .target = &samples,
          .min = 100,
          .max = most};
}

Param describe_rays(int& rays) {
  return {.name = "rays",
          .help = "per sample and environment light",
          .target = &rays,
          .min = 2,
          .max = 65'536};
}

Param describe_seed(std::uint64_t& seed) {
  return {.name = "seed", .help = "of samples and rays", .target = &seed};
}

float fresnel_transmission(float eta, float cos_theta) {
  if (!(cos_theta > 0)) return 0;
  const float cos_i = std::min(cos_theta, 1.0f);
  const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
  if (sin2_t >= 1) return eta == 1 ? 1.0f : 0.0f;  // total reflection, for eta < 1
  const float cos_t = std::sqrt(1 - sin2_t);
  // 1 - (r_s^2 + r_p^2) / 2 = 2 eta cos_i cos_t (1 / (cos_i + eta cos_t)^2 + 1 / (...)^2)
  const float s = 1 / (cos_i + eta * cos_t), p = 1 / (eta * cos_i + cos_t);
  return 2 * eta * cos_i * cos_t * (s * s + p * p);
}

std::vector<Rgb> compute_irradiance(const std::vector<SurfacePoint>& points,
                                    const std::vector<Light>& lights, const RayTracer& tracer,
                                    Boundary boundary, double eta, const IrradianceParams& params,
                                    const Progress& progress) {
  check(describe(const_cast<IrradianceParams&>(params)));
  const Receiver receiver{.tracer = tracer,
                          .epsilon_mm = tracer.epsilon_mm(),
                          .transmits = boundary == Boundary::excluded,
                          .eta = static_cast<float>(eta)};
  const auto environments = prepare(lights, points.size(), params);
  const auto receive_all = [&](std::size_t index) {
    Rgb sum;
    for (std::size_t i = 0; i < lights.size(); ++i) {
      if (const auto* sun = std::get_if<DirectionalLight>(&lights[i])) {
        sum += receive(receiver, points[index], *sun);
      } else if (const auto* lamp = std::get_if<PointLight>(&lights[i])) {
        sum += receive(receiver, points[index], *lamp);
      } else if (environments[i]) {
        sum += receive(receiver, points[index], *environments[i], index);
      }
    }
    return sum;
  };

  std::vector<Rgb> irradiance(points.size());
  constexpr std::string_view stage = "irradiance";
  const std::size_t points_per_report =
      std::max(points_per_block, rays_per_report / static_cast<std::size_t>(params.rays));
  for (std::size_t first = 0; first < points.size(); first += points_per_report) {
    advance_progress(progress, stage,
                     static_cast<double>(first) / static_cast<double>(points.size()));
    const std::size_t count = std::min(points_per_report, points.size() - first);
    parallel_for_blocks(count, points_per_block, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) irradiance[first + k] = receive_all(first + k);
    });
  }
  advance_progress(progress, stage, 1);
  return irradiance;
}

}  // namespace parian

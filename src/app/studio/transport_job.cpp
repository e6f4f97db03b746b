#include "app/studio/transport_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "app/studio/studio.h"
#include "base/error.h"

namespace parian {
namespace {

constexpr double rest_s = 0.8;  // without changes, until the work starts

// The environment's place and the lamp's, apart from how bright they are.
bool is_same_environment(const Lighting& a, const Lighting& b) {
  return a.image == b.image && a.rotation_deg == b.rotation_deg;
}
bool is_same_lamp(const Lighting& a, const Lighting& b) {
  return a.azimuth_deg == b.azimuth_deg && a.elevation_deg == b.elevation_deg;
}
bool has_environment(const Lighting& lighting) {
  return lighting.image != nullptr && lighting.environment > 0;
}
bool has_same_kinds(const Lighting& a, const Lighting& b) {
  return has_environment(a) == has_environment(b) && (a.lamp > 0) == (b.lamp > 0);
}

Scene make_transport_scene(const TransportKey& key) {
  Scene scene = key.stage->scene;
  Dipole material{.channels = {DipoleCoefficients{}}, .eta = key.eta, .single_scattering = true};
  scene.material = Material(std::move(material));
  scene.layers.clear();
  scene.lights = make_lights(key.lighting);
  return scene;
}

// Progress over all lights instead of each stage of each.
Progress count_lights(const Progress& progress, std::size_t done, std::size_t lights) {
  return {.report =
              [&progress, done, lights](std::string_view stage, double part) {
                if (progress.report)
                  progress.report(fmt::format("light {} of {}: {}", done + 1, lights, stage),
                                  (static_cast<double>(done) + part) / static_cast<double>(lights));
              },
          .is_cancelled = progress.is_cancelled};
}

bool is_same_target(const TransportKey& a, const TransportKey& b) {
  return a.stage == b.stage && a.eta == b.eta && has_same_kinds(a.lighting, b.lighting) &&
         is_same_environment(a.lighting, b.lighting) && is_same_lamp(a.lighting, b.lighting);
}

void start_transport(Studio& studio, const TransportKey& wanted) {
  studio.transport_under_way = wanted;
  studio.jobs.start(
      "transport",
      [&studio, wanted, earlier = studio.transport,
       params = studio.transport_params.value_or(choose_transport_params(*wanted.stage))](
          const Progress& progress) -> Jobs::Finish {
        try {
          auto ready = make_ready_transport(wanted, params, earlier.get(), progress);
          return [&studio, ready] {
            studio.transport_under_way.reset();
            studio.transport = ready;
            touch_view(studio);
          };
        } catch (const Error& error) {
          if (error.kind == ErrorKind::cancelled) throw;
          return [&studio, text = std::string(error.what())] {
            studio.transport_under_way.reset();
            studio.use_transport = false;
            report(studio, text + "; without precomputed transport edits are splatted", true);
          };
        }
      });
}

}  // namespace

std::optional<std::vector<Rgb>> find_light_scales(const ReadyTransport& ready,
                                                  const TransportKey& wanted) {
  if (!is_same_target(ready.key, wanted)) return std::nullopt;
  std::vector<Rgb> scales;
  const auto add = [&](double now, double then) {
    const auto factor = static_cast<float>(now / then);
    scales.push_back({factor, factor, factor});
  };
  // In the order of make_lights.
  if (has_environment(wanted.lighting))
    add(wanted.lighting.environment, ready.key.lighting.environment);
  if (wanted.lighting.lamp > 0) add(wanted.lighting.lamp, ready.key.lighting.lamp);
  return scales;
}

PrecomputeParams choose_transport_params(const Stage& stage) {
  constexpr std::size_t per_vertex = 4, least = 20000;
  PrecomputeParams params;
  params.rays = 64;
  params.single_params.path_samples = 16;
  params.single_params.directions = 64;
  params.single_params.resolution = 1024;
  params.samples = static_cast<int>(std::clamp(per_vertex * stage.scene.mesh.positions.size(),
                                               least, static_cast<std::size_t>(params.samples)));
  return params;
}

std::shared_ptr<const ReadyTransport> make_ready_transport(const TransportKey& key,
                                                           const PrecomputeParams& params,
                                                           const ReadyTransport* earlier,
                                                           const Progress& progress) {
  const Scene scene = make_transport_scene(key);
  if (scene.lights.empty())
    throw Error({{}, "light", "a lamp or an environment that is not off", "none"});
  Precompute precompute(scene, key.stage->tracer, params, {}, progress);
  const bool can_keep = earlier != nullptr && earlier->key.stage == key.stage &&
                        earlier->key.eta == key.eta &&
                        has_same_kinds(earlier->key.lighting, key.lighting);
  auto ready = std::make_shared<ReadyTransport>(ReadyTransport{.key = key, .transport = nullptr});
  if (!can_keep) {
    while (!precompute.is_done())
      precompute.advance(count_lights(progress, precompute.lights_done(), scene.lights.size()));
    ready->transport = std::make_shared<const HomogeneousTransport>(precompute.transport());
    return ready;
  }
  auto transport = std::make_shared<HomogeneousTransport>(*earlier->transport);
  const Lighting& then = earlier->key.lighting;
  std::size_t light = 0;
  const auto renew = [&](bool is_kept, double& factor, double old_factor) {
    if (is_kept)
      factor = old_factor;  // the kept transport is of the old brightness
    else
      transport->lights[light] = precompute.compute(light, scene.lights[light], progress);
    ++light;
  };
  Lighting& now = ready->key.lighting;
  if (has_environment(now))
    renew(is_same_environment(then, now), now.environment, then.environment);
  if (now.lamp > 0) renew(is_same_lamp(then, now), now.lamp, then.lamp);
  ready->transport = std::move(transport);
  return ready;
}

void update_transport(Studio& studio) {
  const bool runs = studio.jobs.is_running("transport");
  if (!runs && studio.transport_under_way) {
    // Ended without a result: someone has cancelled it.
    studio.transport_under_way.reset();
    studio.use_transport = false;
  }
  const bool wanted = studio.use_transport && studio.is_homogeneous && studio.stage != nullptr;
  const TransportKey key{studio.stage, studio.lighting, studio.homogeneous.eta};
  const bool has_lights = has_environment(key.lighting) || key.lighting.lamp > 0;
  if (runs && (!wanted || !is_same_target(*studio.transport_under_way, key))) {
    studio.transport_under_way.reset();
    studio.jobs.cancel("transport");
    return;
  }
  if (runs || !wanted || !has_lights || studio.now_s - studio.last_change_s < rest_s) return;
  if (studio.transport != nullptr && find_light_scales(*studio.transport, key)) return;
  start_transport(studio, key);
}

}  // namespace parian

#include "app/studio/transport_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "app/studio/studio.h"
#include "base/error.h"

namespace parian {
namespace {

constexpr double rest_s = 0.8;  // without changes, until the work starts

// Apart from how bright they are. A channel that was dark says nothing about itself.
bool is_same_place(const StageLight& a, const StageLight& b) {
  const auto is_dark = [](Rgb color) { return std::array{color.x > 0, color.y > 0, color.z > 0}; };
  return a.kind == b.kind && a.sky == b.sky && a.place == b.place &&
         a.rotation_deg == b.rotation_deg && is_dark(a.power) == is_dark(b.power);
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
  return a.stage == b.stage && a.eta == b.eta &&
         std::equal(a.lighting.begin(), a.lighting.end(), b.lighting.begin(), b.lighting.end(),
                    is_same_place);
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
  const auto factor = [](float now, float then) { return then > 0 ? now / then : 1.0f; };
  std::vector<Rgb> scales;
  scales.reserve(wanted.lighting.size());
  for (std::size_t i = 0; i < wanted.lighting.size(); ++i) {
    const Rgb now = wanted.lighting[i].power, then = ready.key.lighting[i].power;
    scales.push_back({factor(now.x, then.x), factor(now.y, then.y), factor(now.z, then.z)});
  }
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
  const bool can_keep =
      earlier != nullptr && earlier->key.stage == key.stage && earlier->key.eta == key.eta;
  auto ready = std::make_shared<ReadyTransport>(ReadyTransport{.key = key, .transport = nullptr});
  if (!can_keep) {
    while (!precompute.is_done())
      precompute.advance(count_lights(progress, precompute.lights_done(), scene.lights.size()));
    ready->transport = std::make_shared<const HomogeneousTransport>(precompute.transport());
    return ready;
  }
  auto transport = std::make_shared<HomogeneousTransport>(*earlier->transport);
  transport->lights.clear();
  for (std::size_t i = 0; i < key.lighting.size(); ++i) {
    StageLight& light = ready->key.lighting[i];
    const Lighting& then = earlier->key.lighting;
    const auto kept = std::find_if(
        then.begin(), then.end(), [&](const StageLight& old) { return is_same_place(old, light); });
    if (kept != then.end()) {
      const auto index = static_cast<std::size_t>(kept - then.begin());
      transport->lights.push_back(earlier->transport->lights[index]);
      light.power = kept->power;  // what is kept is of the old strength
    } else {
      transport->lights.push_back(
          precompute.compute(i, scene.lights[i], count_lights(progress, i, scene.lights.size())));
    }
  }
  ready->transport = std::move(transport);
  return ready;
}

TransportKey make_transport_key(const Studio& studio) {
  return {studio.stage, only_enabled(studio.lighting), studio.homogeneous.eta};
}

bool can_use_transport(const Studio& studio) {
  return studio.use_transport && studio.is_homogeneous && studio.stage != nullptr &&
         shown_layers(studio).empty();
}

void update_transport(Studio& studio) {
  const bool runs = studio.jobs.is_running("transport");
  if (!runs && studio.transport_under_way) {
    // Ended without a result: someone has cancelled it.
    studio.transport_under_way.reset();
    studio.use_transport = false;
  }
  const bool wanted = can_use_transport(studio);
  const TransportKey key = make_transport_key(studio);
  const bool has_lights = !key.lighting.empty();
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

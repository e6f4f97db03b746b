// Time, storage and updates per second (Table 2 of Xu et al. 2007).
#include <fmt/format.h>

#include <algorithm>

#include "base/aligned.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "bench/common/assets.h"
#include "bench/common/timing.h"
#include "bench/homogeneous/study.h"
#include "transport/precompute.h"

namespace parian {
namespace {

// GB/s at which all cores read a buffer much larger than their caches.
double measure_bandwidth() {
  const std::size_t count = 64u << 20u;
  std::vector<std::uint64_t> buffer(count, 1);
  constexpr std::size_t block = 1u << 16u;
  std::vector<std::uint64_t> sums(count / block);
  const double seconds = best_seconds(10, [&] {
    parallel_for_blocks(count, block, [&](std::size_t begin, std::size_t end) {
      std::uint64_t sum[8] = {};
      for (std::size_t i = begin; i < end; i += 8)
        for (std::size_t k = 0; k < 8; ++k) sum[k] += buffer[i + k];
      for (const std::uint64_t part : sum) sums[begin / block] += part;
    });
  });
  return static_cast<double>(count * sizeof(std::uint64_t)) / seconds / 1e9;
}

Scene make_scene(const std::string& file, int detail) {
  Scene scene;
  scene.mesh = make_bench_mesh(file, detail, 60);
  scene.mesh_name = file;
  Dipole material;
  material.channels = {{0.004, 1.2}, {0.008, 1.3}, {0.03, 1.5}};
  material.single_scattering = true;
  scene.material = Material(material);
  scene.lights = {make_bench_environment()};
  return scene;
}

struct Speed {
  double multiple = 0, all = 0;  // updates per second
  double bytes = 0;
  double fit_ms = 0;
};

Speed measure_updates(const Scene& scene, const HomogeneousTransport& transport) {
  const auto& material = std::get<Dipole>(std::get<Material>(scene.material));
  const TransportProjection projection(transport);
  const TransportView view =
      make_transport_view(scene.mesh.positions, scene.mesh.normals, {0, 30, 200}, transport.eta);
  TransportCoefficients coefficients;
  Speed speed;
  speed.fit_ms = 1e3 * best_seconds(20, [&] { coefficients = projection.fit(material); });
  std::vector<Rgb> radiance;
  const auto update = [&](const HomogeneousTransport& what) {
    return 1 / best_seconds(40, [&] {
             eval_transport(what, projection.fit(material), {Rgb{1, 1, 1}}, view, radiance);
           });
  };
  speed.all = update(transport);
  speed.bytes = static_cast<double>(transport_bytes(transport));
  HomogeneousTransport multiple = transport;
  multiple.lights[0].single = {};
  speed.multiple = update(multiple);
  return speed;
}

}  // namespace

void study_speed(const Page& page, bool with_largest) {
  struct Mesh {
    const char *file, *name;
    int samples;
  };
  std::vector<Mesh> meshes{{"dragon-5205.ply", "dragon, 5 k", 80000},
                           {"dragon-22998.ply", "dragon, 23 k", 200000},
                           {"dragon-100250.ply", "dragon, 100 k", 200000}};
  if (with_largest) meshes.push_back({"dragon-437645.ply", "dragon, 438 k", 200000});
  const double bandwidth = measure_bandwidth();
  MarkdownTable table;
  table.header = {"",
                  "vertices",
                  "samples",
                  "multiple",
                  "MB",
                  "single",
                  "MB",
                  "updates/s, multiple",
                  "updates/s, all"};
  std::string text;
  for (const Mesh& mesh : meshes) {
    const Scene scene = make_scene(mesh.file, 3);
    const RayTracer tracer(scene.mesh);
    PrecomputeParams params;
    params.samples = mesh.samples;
    Precompute work(scene, tracer, params);
    work.advance();
    const HomogeneousTransport& transport = work.transport();
    const Speed speed = measure_updates(scene, transport);
    const auto megabytes = [](const PackedTransport& packed) {
      return fmt::format("{:.1f}", 2e-6 * static_cast<double>(packed.half.size()));
    };
    const LightTransport& light = transport.lights[0];
    table.rows.push_back(
        {mesh.name, fmt::format("{}", transport.places), fmt::format("{}", params.samples),
         fmt::format("{:.1f} s", work.report().multiple_s), megabytes(light.multiple),
         fmt::format("{:.1f} s", work.report().single_s), megabytes(light.single),
         fmt::format("{:.0f}", speed.multiple), fmt::format("{:.0f}", speed.all)});
    text = fmt::format(
        "Two cores. Sampling {:.1f} s and irradiance {:.1f} s come on top for the largest of these "
        "meshes; {:.0f} MB at most. An update there reads {:.0f} MB at {:.1f} GB/s, {:.0f} % of "
        "the {:.1f} GB/s at which the cores read a large buffer in the same run; new coefficients "
        "take {:.2f} ms of it.",
        work.report().sampling_s, work.report().irradiance_s,
        static_cast<double>(peak_memory()) / 1e6, speed.bytes / 1e6, speed.bytes * speed.all / 1e9,
        100 * speed.bytes * speed.all / 1e9 / bandwidth, bandwidth, speed.fit_ms);
  }
  const auto published = [&](const char* name, const char* vertices, const char* count,
                             const char* multiple, const char* mb, const char* single,
                             const char* single_mb, const char* updates, const char* all) {
    table.rows.push_back({name, vertices, count, multiple, mb, single, single_mb, updates, all});
  };
  published("*paper: Bunny*", "120000", "300000", "118 min", "23", "120 min", "45", "38", "16");
  published("*paper: Buddha*", "80000", "200000", "50 min", "15", "84 min", "30", "50", "26");
  published("*paper: Dragon*", "60000", "200000", "35 min", "12", "60 min", "23", "88", "37");
  published("*paper: Tweety*", "30000", "80000", "8 min", "6", "32 min", "11", "190", "70");
  write_table(page, "speed", text, table);
}

}  // namespace parian

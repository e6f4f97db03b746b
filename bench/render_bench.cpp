// Rendering: the moment tree beside vectorised brute force on the dragon, how its cost grows, and
// whole pictures.
//
//   ./run bench render [gather] [scaling] [picture]
//
// Meshes and environments come from `./run assets`; without them a built-in shape and sky stand in.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/memory.h"
#include "bench/common/assets.h"
#include "bench/common/studies.h"
#include "bench/common/timing.h"
#include "fit/fit.h"
#include "io/hdf5/table_file.h"
#include "mesh/surface_samples.h"
#include "render/render.h"
#include "scene/mapping.h"
#include "transport/irradiance.h"
#include "transport/moment_tree.h"

namespace parian {
namespace {

constexpr double size_mm = 80;

ProfileMap make_stone() {
  return fit_profiles(*open_table(PARIAN_SOURCE_DIR "/data/stone-72x64.h5"), {}).map;
}

GatherPoint to_gather_point(const Mapping& mapping, const ProfileField& field,
                            const SurfacePoint& point) {
  const SamplePoint place =
      map_to_sample(mapping, {field.width, field.height, field.pixel_pitch_mm}, point);
  return {point.position, point.normal, static_cast<float>(place.x), static_cast<float>(place.y)};
}

// The dragon under an environment, ready for gathering.
struct Problem {
  ProfileField field;
  TriangleMesh mesh;
  GatherSources sources;
  std::vector<GatherPoint> vertices;
  double near_mm = 0;
};

GatherSources make_sources(const TriangleMesh& mesh, const ProfileField& field, int count,
                           int rays) {
  const SurfaceSamples samples = make_surface_samples(mesh, static_cast<std::size_t>(count));
  const RayTracer tracer(mesh);
  IrradianceParams params;
  params.rays = rays;
  const std::vector<Rgb> irradiance = compute_irradiance(samples.points, {make_bench_environment()},
                                                         tracer, field.boundary, field.eta, params);
  GatherSources sources;
  sources.area_mm2 = samples.area_mm2;
  for (std::size_t i = 0; i < samples.points.size(); ++i) {
    sources.points.push_back(to_gather_point({}, field, samples.points[i]));
    sources.flux.push_back(irradiance[i] * static_cast<float>(samples.area_mm2));
  }
  return sources;
}

Problem make_problem(int samples) {
  Problem problem;
  problem.field = make_profile_field(make_stone());
  problem.mesh = make_bench_mesh("dragon-100250.ply", 2, size_mm);
  problem.sources = make_sources(problem.mesh, problem.field, samples, 32);
  problem.near_mm = default_near_mm(problem.sources.area_mm2);
  for (std::size_t v = 0; v < problem.mesh.positions.size(); ++v) {
    SurfacePoint point;
    point.position = problem.mesh.positions[v];
    point.normal = problem.mesh.normals[v];
    problem.vertices.push_back(to_gather_point({}, problem.field, point));
  }
  return problem;
}

struct Errors {
  double rms = 0, p99 = 0, max = 0;
  std::size_t values = 0, outside = 0;  // outside their bracket
};

Errors compare_values(const std::vector<Rgb>& exact, const std::vector<Rgb>& values,
                      const std::vector<float>& half_width) {
  std::vector<double> errors;
  Errors result;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const float a[3] = {exact[i].x, exact[i].y, exact[i].z};
    const float b[3] = {values[i].x, values[i].y, values[i].z};
    for (int c = 0; c < 3; ++c) {
      const double difference = std::abs(static_cast<double>(b[c]) - static_cast<double>(a[c]));
      errors.push_back(difference / static_cast<double>(a[c]));
      if (difference > static_cast<double>(half_width[i] * b[c]) + 1e-6 * static_cast<double>(a[c]))
        ++result.outside;
    }
  }
  std::sort(errors.begin(), errors.end());
  for (double error : errors) result.rms += error * error;
  result.rms = std::sqrt(result.rms / static_cast<double>(errors.size()));
  result.p99 = errors[errors.size() * 99 / 100];
  result.max = errors.back();
  result.values = errors.size();
  return result;
}

// About 10,000 targets in patches of 128 neighbours, so that brute force keeps its blocks compact.
std::vector<std::size_t> pick_patches(const std::vector<GatherPoint>& targets) {
  constexpr std::size_t patches = 78, patch = 128;
  std::vector<std::size_t> picked, nearest(targets.size());
  for (std::size_t i = 0; i < patches; ++i) {
    const Vec3 middle = targets[targets.size() * (2 * i + 1) / (2 * patches)].position;
    std::iota(nearest.begin(), nearest.end(), std::size_t{0});
    std::nth_element(
        nearest.begin(), nearest.begin() + patch, nearest.end(), [&](std::size_t a, std::size_t b) {
          return distance(targets[a].position, middle) < distance(targets[b].position, middle);
        });
    picked.insert(picked.end(), nearest.begin(), nearest.begin() + patch);
  }
  return picked;
}

void bench_gather() {
  const Problem problem = make_problem(200000);
  const MomentTree tree(problem.field, problem.sources);
  const std::vector<std::size_t> picked = pick_patches(problem.vertices);
  std::vector<GatherPoint> some;
  some.reserve(picked.size());
  for (std::size_t i : picked) some.push_back(problem.vertices[i]);
  std::vector<Rgb> exact;
  const double brute =
      best_seconds(
          3, [&] { exact = gather_brute(problem.field, problem.sources, some, problem.near_mm); }) /
      static_cast<double>(some.size());
  const double build = best_seconds(3, [&] { MomentTree(problem.field, problem.sources); });
  fmt::print(
      "{} vertices, {} samples, range {:.1f} mm on {} mm; brute force {:.1f} us per vertex over {} "
      "of them; tree built in {:.2f} s\n",
      problem.vertices.size(), problem.sources.points.size(),
      static_cast<double>(problem.field.max_support_mm), size_mm, 1e6 * brute, some.size(), build);
  fmt::print("{:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10} {:>10} {:>8}\n", "quality", "us",
             "ratio", "nodes", "rms %", "99 % %", "max %", "half-w. %", "mean h. %", "outside");
  for (double quality : {1e-2, 2e-3, 1e-3, 5e-4, 2e-4, 5e-5}) {
    TreeGatherParams params;
    params.quality = quality;
    params.certify_every = 0;
    const double seconds =
        best_seconds(3, [&] { tree.gather(problem.vertices, problem.near_mm, params); });
    params.certify_every = 1;
    const TreeGatherResult result = tree.gather(problem.vertices, problem.near_mm, params);
    std::vector<Rgb> values;
    std::vector<float> half_width;
    for (std::size_t i : picked) {
      values.push_back(result.exitance[i]);
      half_width.push_back(result.half_width[i]);
    }
    const Errors errors = compare_values(exact, values, half_width);
    const double each = seconds / static_cast<double>(problem.vertices.size());
    fmt::print(
        "{:>8} {:>8.1f} {:>8.1f} {:>8.0f} {:>8.2f} {:>8.2f} {:>8.2f} {:>10.1f} {:>10.1f} "
        "{:>4} of {}\n",
        quality, 1e6 * each, brute / each, result.nodes_per_target, 100 * errors.rms,
        100 * errors.p99, 100 * errors.max, 100 * result.max_half_width,
        100 * result.mean_half_width, errors.outside, errors.values);
    std::fflush(stdout);
  }
  for (double tolerance : {0.2, 0.05, 0.02}) {
    TreeGatherParams params;
    params.tolerance = tolerance;
    const Stopwatch watch;
    const TreeGatherResult result = tree.gather(some, problem.near_mm, params);
    const double each = watch.seconds() / static_cast<double>(some.size());
    const Errors errors = compare_values(exact, result.exitance, result.half_width);
    fmt::print(
        "certified to {:>4} %: {:.1f} us, {:.2f} of brute force's time, max error {:.3f} %, "
        "outside {} of {}\n",
        100 * tolerance, 1e6 * each, each / brute, 100 * errors.max, errors.outside, errors.values);
    std::fflush(stdout);
  }
}

void bench_scaling() {
  fmt::print("{:>9} {:>9} {:>10} {:>12} {:>16} {:>10}\n", "samples", "targets", "build s",
             "us / target", "us / log2(N)", "nodes");
  const Problem problem = make_problem(1000);
  for (int samples : {12500, 25000, 50000, 100000, 200000, 400000, 800000}) {
    const GatherSources sources = make_sources(problem.mesh, problem.field, samples, 4);
    const Stopwatch watch;
    const MomentTree tree(problem.field, sources);
    const double build = watch.seconds();
    const double near_mm = default_near_mm(sources.area_mm2);
    TreeGatherParams params;
    params.certify_every = 0;
    TreeGatherResult result;
    const double each =
        best_seconds(3, [&] { result = tree.gather(problem.vertices, near_mm, params); }) /
        static_cast<double>(problem.vertices.size());
    fmt::print("{:>9} {:>9} {:>10.2f} {:>12.1f} {:>16.2f} {:>10.0f}\n", samples,
               problem.vertices.size(), build, 1e6 * each, 1e6 * each / std::log2(samples),
               result.nodes_per_target);
    std::fflush(stdout);
  }
  const GatherSources sources = make_sources(problem.mesh, problem.field, 200000, 4);
  const MomentTree tree(problem.field, sources);
  for (std::size_t step : {16u, 8u, 4u, 2u, 1u}) {
    std::vector<GatherPoint> some;
    for (std::size_t i = 0; i < problem.vertices.size(); i += step)
      some.push_back(problem.vertices[i]);
    TreeGatherParams params;
    params.certify_every = 0;
    const double seconds =
        best_seconds(3, [&] { tree.gather(some, default_near_mm(sources.area_mm2), params); });
    fmt::print("{:>9} {:>9} {:>10} {:>12.1f}\n", 200000, some.size(), "",
               1e6 * seconds / static_cast<double>(some.size()));
    std::fflush(stdout);
  }
}

void bench_picture(const std::string& file, int detail) {
  Scene scene;
  const Stopwatch watch;
  scene.mesh = make_bench_mesh(file, detail, size_mm);
  scene.mesh_name = file;
  const double loading = watch.seconds();
  scene.material = Material(make_stone());
  scene.lights = {make_bench_environment()};
  const Bounds3 box = bounds(scene.mesh);
  scene.camera.target = center(box);
  scene.camera.position = center(box) + Vec3{0.3f, 0.35f, 1} * (1.9f * static_cast<float>(size_mm));
  const RenderResult result = render(scene, {});
  const RenderReport& report = result.report;
  fmt::print(
      "{}: {} triangles, {} x {}: {:.1f} s (loading {:.1f}, sampling {:.1f}, irradiance {:.1f}, "
      "tree {:.1f}, gather {:.1f}, shading {:.1f}), {} targets, {:.0f} nodes each, half-width "
      "mean {:.2f} max {:.2f}, peak memory of the process {:.0f} MB\n",
      file, report.triangles, scene.camera.width, scene.camera.height, loading + report.total_s,
      loading, report.sampling_s, report.irradiance_s, report.tree_s, report.gather_s,
      report.shading_s, report.targets, report.nodes_per_target, report.mean_half_width,
      report.max_half_width, static_cast<double>(peak_memory()) / 1e6);
  std::fflush(stdout);
}

}  // namespace
}  // namespace parian

int main(int argc, char** argv) {
  using namespace parian;
  const auto draw = [](const Page&) {
    bench_picture("dragon-100250.ply", 2);
    bench_picture("dragon-437645.ply", 4);
  };
  return run_studies(argc, argv, "rendering",
                     {{"gather", [](const Page&) { bench_gather(); }},
                      {"scaling", [](const Page&) { bench_scaling(); }},
                      {"picture", draw}});
}

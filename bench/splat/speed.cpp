// Milliseconds per stage, beside the rate at which the device adds squares.
#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "bench/common/timing.h"
#include "bench/splat/study.h"
#include "gl/splat_rate.h"
#include "gl/splat_renderer.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"

namespace parian {
namespace {

std::string ms(double seconds) {
  return fmt::format("{:.1f}", 1e3 * seconds);
}
std::string megabytes(std::size_t bytes) {
  return fmt::format("{:.2f}", 1e-6 * static_cast<double>(bytes));
}

void measure_rate(const Page& page) {
  MarkdownTable table;
  table.header = {"side, pixels", "million squares/s", "million pixels/s"};
  for (const int side : {4, 8, 16, 20, 32}) {
    const SplatRate rate = measure_splat_rate(1280, 720, 100'000, side);
    table.rows.push_back({fmt::format("{}", side), fmt::format("{:.2f}", rate.splats_per_s * 1e-6),
                          fmt::format("{:.0f}", rate.pixels_per_s * 1e-6)});
  }
  write_table(page, "rate", "Bare squares of one colour added to a float picture of 1280 x 720.",
              table);
}

struct Frames {
  SplatReport report;  // of the fastest picture
  double seconds = 0;  // of that: splats, resolve, shading
  double view = 0;     // with a camera that moved
  double bare = 0;     // all splats with nothing computed
};

Frames measure_frames(SplatRenderer& renderer, const Camera& camera) {
  Frames frames;
  frames.seconds = frames.view = frames.bare = 1e30;
  renderer.draw(true);
  for (int run = 0; run < 4; ++run) {
    renderer.set_camera(camera);
    renderer.draw(true);
    const SplatReport& report = renderer.report();
    frames.view = std::min(frames.view, report.view_s);
    const double seconds = report.splat_s + report.resolve_s + report.shade_s;
    if (seconds < frames.seconds) {
      frames.seconds = seconds;
      frames.report = report;
    }
    frames.bare = std::min(frames.bare, renderer.time_bare_splats());
  }
  return frames;
}

std::vector<std::string> stage_cells(const Frames& frames) {
  const SplatReport& report = frames.report;
  return {ms(frames.view),
          ms(report.splat_s),
          fmt::format("{:.2f}", report.splat_s / frames.bare),
          ms(report.resolve_s),
          ms(report.shade_s),
          fmt::format("{:.1f}", 1 / (frames.view + frames.seconds)),
          fmt::format("{:.1f}", 1 / frames.seconds)};
}
const std::vector<std::string> stage_names{"view",  "splats",     "over bare", "resolve",
                                           "shade", "moving, /s", "still, /s"};

void append(std::vector<std::string>& row, const std::vector<std::string>& more) {
  row.insert(row.end(), more.begin(), more.end());
}

// Times of one material's file and of its pictures.
std::vector<std::string> measure_material(SplatRenderer& renderer, const Camera& camera,
                                          const std::string& name,
                                          const std::function<Material()>& load) {
  const double loading = best_seconds(5, [&] { (void)load(); });
  const Material material = load();
  renderer.set_material(material);
  renderer.set_material(material);  // programs are there
  const double to_device = renderer.report().material_s;
  std::vector<std::string> row{name, ms(loading), ms(to_device)};
  const Frames frames = measure_frames(renderer, camera);
  row.push_back(megabytes(renderer.report().material_bytes));
  append(row, stage_cells(frames));
  return row;
}

}  // namespace

void study_speed(const Page& page, const GlLimits& limits) {
  measure_rate(page);
  const Scene scene = make_dragon("dragon-437645.ply", Material(stone_blend()), 1280, 720);
  MarkdownTable table;
  table.header = {"samples", "levels", "emitters"};
  append(table.header, stage_names);
  table.header.emplace_back("MB");
  for (const int samples : {4'000, 20'000, 50'000, 200'000}) {
    SplatParams params;
    params.samples = samples;
    params.antialias = 1;
    SplatRenderer renderer(limits, scene, params);
    const Frames frames = measure_frames(renderer, scene.camera);
    std::vector<std::string> row{fmt::format("{}", frames.report.samples),
                                 fmt::format("{}", frames.report.levels),
                                 fmt::format("{}", frames.report.splats)};
    append(row, stage_cells(frames));
    row.push_back(megabytes(frames.report.texture_bytes));
    table.rows.push_back(std::move(row));
  }
  write_table(page, "stages",
              fmt::format("{}; dragon of {} triangles, 1280 x 720, one ray a pixel, a blend of two "
                          "of 128 base materials; milliseconds.",
                          limits.renderer, scene.mesh.triangles.size()),
              table);
}

void study_samples(const Page& page, const GlLimits& limits) {
  MarkdownTable table;
  table.header = {"material", "loading", "to the device", "MB there"};
  append(table.header, stage_names);
  const Scene scene = make_dragon("dragon-437645.ply", Material(stone_map()), 1280, 720);
  SplatParams params;
  params.antialias = 1;
  SplatRenderer renderer(limits, scene, params);
  for (const std::string sample : {"stone-72x64", "chessboard", "jade", "onyx", "blue-wax",
                                   "yellow-wax", "artificial-stone"}) {
    const SampleFiles files = make_sample_files(sample);
    table.rows.push_back(measure_material(renderer, scene.camera, sample + ", map",
                                          [&] { return Material(load_profile_map(files.map)); }));
    table.rows.push_back(measure_material(renderer, scene.camera, sample + ", blend",
                                          [&] { return Material(load_blend(files.blend)); }));
  }
  write_table(page, "samples",
              fmt::format("{}; the dragon of 871 k triangles, 1280 x 720, 50,000 samples; "
                          "milliseconds, frames per second with a camera that moves and a still "
                          "one.",
                          limits.renderer),
              table);
}

}  // namespace parian

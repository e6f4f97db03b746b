// A blend against the map of the same material: cost of evaluating R_d, time to load, memory
// (2019 paper, section 4.2).
//
//   ./run bench blend
#include <fmt/format.h>
#include <malloc.h>

#include <filesystem>
#include <functional>
#include <memory>

#include "base/random.h"
#include "bench/common/ratios.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "material/material.h"
#include "material/profile_field.h"

namespace parian {
namespace {

constexpr int side = 222, knots = 25, bases = 128;

// K = 2; neighbours are alike, as in samples.
ProfileBlend make_blend() {
  ProfileBlend blend;
  blend.width = blend.height = side;
  blend.pixel_pitch_mm = 0.25;
  for (int k = 0; k < knots; ++k) blend.knots_mm.push_back(0.25 * k);
  Rng rng = make_rng(1);
  for (int i = 0; i < 3 * bases; ++i) {
    const double level = 2 * sample_uniform(rng), slope = 1 + sample_uniform(rng);
    for (double r : blend.knots_mm)
      blend.base_log_profile.push_back(static_cast<float>(level - slope * r));
  }
  for (std::uint32_t i = 0; i < 2 * side * side; ++i)
    blend.index.push_back(
        static_cast<std::uint16_t>((i % side / 8 + i / side / 8 + sample_u32(rng) % 4) % bases));
  for (int i = 0; i < side * side; ++i)
    blend.weight.push_back(static_cast<float>(sample_uniform(rng)));
  snap_to_grid(blend, {0.004, 63});
  return blend;
}

const Material& blend_material() {
  static const Material material = make_blend();
  return material;
}
const Material& map_material() {
  static const Material material = make_profile_map(std::get<ProfileBlend>(blend_material()));
  return material;
}

// Rows for points all over the sample, as a renderer asks for them.
void eval_field(benchmark::State& state, const Material& material) {
  const ProfileField field = make_profile_field(material);
  std::vector<float> row(field.row()), support(3);
  Rng rng = make_rng(2);
  for ([[maybe_unused]] auto iteration : state) {
    field.eval(side * sample_uniform(rng), side * sample_uniform(rng), row.data(), support.data());
    benchmark::DoNotOptimize(row[0]);
  }
}

void eval_slices(benchmark::State& state, const Material& material) {
  TableHeader like = natural_header(map_material());
  like.offsets = {{0, 0}, {3, 2}, {-7, 11}};
  const auto slices = make_slices(material, like);
  std::vector<float> slice(like.pixels());
  for ([[maybe_unused]] auto iteration : state)
    for (int d = 0; d < 3; ++d) {
      slices->read_slice(1, d, slice.data());
      benchmark::DoNotOptimize(slice[0]);
    }
}

std::string path_of(const char* name) {
  return (std::filesystem::temp_directory_path() / name).string();
}

void load_blend_file(benchmark::State& state, BlendEncoding encoding) {
  const std::string path = path_of("parian-bench.kbm");
  save_blend(path, std::get<ProfileBlend>(blend_material()), encoding);
  for ([[maybe_unused]] auto iteration : state) benchmark::DoNotOptimize(load_blend(path));
  state.counters["bytes"] = static_cast<double>(std::filesystem::file_size(path));
  std::filesystem::remove(path);
}

void load_map_file(benchmark::State& state) {
  const std::string path = path_of("parian-bench.h5");
  save_profile_map(path, std::get<ProfileMap>(map_material()));
  for ([[maybe_unused]] auto iteration : state) benchmark::DoNotOptimize(load_profile_map(path));
  state.counters["bytes"] = static_cast<double>(std::filesystem::file_size(path));
  std::filesystem::remove(path);
}

// Bytes on the heap that what `make` returns keeps.
double heap_bytes(const std::function<std::shared_ptr<void>()>& make) {
  const auto in_use = [] {
    const auto info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
  };
  const double before = in_use();
  const std::shared_ptr<void> kept = make();
  return in_use() - before;
}

// Of the material as loaded, and of what renderers make of it.
void report_memory() {
  const auto measure = [](const Material& material) {
    return std::pair{
        heap_bytes([&] { return std::make_shared<Material>(material); }),
        heap_bytes([&] { return std::make_shared<ProfileField>(make_profile_field(material)); })};
  };
  const auto [map, map_field] = measure(map_material());
  const auto [blend, blend_field] = measure(blend_material());
  fmt::print("\n{:<24} {:>10} {:>10} {:>8}\n", "memory in MB", "map", "blend", "ratio");
  fmt::print("{:<24} {:>10.3f} {:>10.3f} {:>8.1f}\n", "material", map / 1e6, blend / 1e6,
             map / blend);
  fmt::print("{:<24} {:>10.3f} {:>10.3f} {:>8.1f}\n", "renderers' field", map_field / 1e6,
             blend_field / 1e6, map_field / blend_field);
}

}  // namespace
}  // namespace parian

int main(int argc, char** argv) {
  using namespace parian;
  const auto in_ms = benchmark::kMillisecond;
  benchmark::RegisterBenchmark("field/map", [](auto& state) { eval_field(state, map_material()); });
  benchmark::RegisterBenchmark("field/blend",
                               [](auto& state) { eval_field(state, blend_material()); });
  benchmark::RegisterBenchmark("slices/map",
                               [](auto& state) { eval_slices(state, map_material()); });
  benchmark::RegisterBenchmark("slices/blend",
                               [](auto& state) { eval_slices(state, blend_material()); });
  benchmark::RegisterBenchmark("load/map", load_map_file)->Unit(in_ms);
  benchmark::RegisterBenchmark("load/blend-paper", [](auto& state) {
    load_blend_file(state, BlendEncoding::paper);
  })->Unit(in_ms);
  benchmark::RegisterBenchmark("load/blend-packed", [](auto& state) {
    load_blend_file(state, BlendEncoding::packed);
  })->Unit(in_ms);
  const int status =
      run_benchmarks(argc, argv,
                     {{"rows for renderers", "field/blend", "field/map", "<= 1.3"},
                      {"slices", "slices/blend", "slices/map", "<= 1.3"},
                      {"loading, paper encoding", "load/blend-paper", "load/map", "blend <= 5 ms"},
                      {"loading, packed", "load/blend-packed", "load/map", "blend <= 5 ms"}});
  if (status == 0) report_memory();
  return status;
}

#include <filesystem>

#include "bench/common/assets.h"
#include "bench/common/bench_table.h"
#include "bench/splat/study.h"
#include "compress/compress.h"
#include "fit/fit.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "scene/camera.h"

namespace parian {

SampleFiles make_sample_files(const std::string& sample) {
  const std::filesystem::path folder =
      std::filesystem::path(PARIAN_SOURCE_DIR) / "out" / "bench" / "maps";
  SampleFiles files{(folder / (sample + ".h5")).string(), (folder / (sample + ".kbm")).string()};
  std::filesystem::create_directories(folder);
  if (std::filesystem::exists(files.map) && std::filesystem::exists(files.blend)) return files;
  const auto table = open_table(sample == "stone-72x64" ? PARIAN_SOURCE_DIR "/data/stone-72x64.h5"
                                                        : make_bench_table(sample));
  const ProfileMap map = fit_profiles(*table, {}).map;
  save_profile_map(files.map, map);
  CompressParams params;
  params.weight_levels = default_weight_levels;
  params.profile_step = default_profile_step;
  save_blend(files.blend, compress_profiles(map, table.get(), params), BlendEncoding::packed);
  return files;
}

const ProfileMap& stone_map() {
  static const ProfileMap map = load_profile_map(make_sample_files("stone-72x64").map);
  return map;
}

const ProfileBlend& stone_blend() {
  static const ProfileBlend blend = load_blend(make_sample_files("stone-72x64").blend);
  return blend;
}

Dipole make_marble() {
  Dipole marble;
  marble.channels = {{0.0021, 2.19, 0}, {0.0041, 2.62, 0}, {0.0071, 3, 0}};
  return marble;
}

Scene make_dragon(const std::string& mesh_file, SurfaceMaterial material, int width, int height) {
  Scene scene;
  scene.mesh = make_bench_mesh(mesh_file, 2, 80);
  scene.mesh_name = "dragon";
  scene.material = std::move(material);
  scene.lights = {DirectionalLight{normalize(Vec3{1, 1, 0.5f}), {3, 3, 3}}};
  scene.camera.width = width;
  scene.camera.height = height;
  scene.camera.target = center(bounds(scene.mesh));
  frame_box(scene.camera, bounds(scene.mesh));
  return scene;
}

}  // namespace parian

#include "app/studio/scene_file.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/cli/inputs.h"
#include "app/studio/painted_files.h"
#include "app/studio/studio_files.h"
#include "fit/fit.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/json/json.h"
#include "scene/write_scene.h"

namespace parian {
namespace {

namespace fs = std::filesystem;

// "dragon.json" has "dragon-material.h5" beside it; never the file that is being edited.
std::string name_beside(const std::string& path, const std::string& extension,
                        const std::string& opened) {
  const fs::path folder = fs::path(path).parent_path();
  const std::string stem = fs::path(path).stem().string() + "-material";
  std::error_code ignored;
  fs::path name = folder / (stem + extension);
  for (int i = 2; fs::equivalent(name, opened, ignored); ++i)
    name = folder / (stem + "-" + std::to_string(i) + extension);
  return fs::absolute(name).string();
}

void save_material(const std::string& path, const Material& material) {
  if (const auto* blend = std::get_if<ProfileBlend>(&material))
    save_blend(path, *blend, BlendEncoding::packed);
  else
    save_profile_map(path, std::get<ProfileMap>(material));
}

}  // namespace

OpenedScene open_scene(const Document& description, const std::string& path,
                       const Progress& progress) {
  LoadedScene loaded = load_scene(description, path, Disabled::keep);
  Scene& scene = loaded.scene;
  for_each_file(scene, [folder = fs::path(path).parent_path()](std::string& file) {
    file = fs::absolute(folder / file).lexically_normal().string();
  });
  OpenedScene opened{.orbit = make_orbit(scene.camera),
                     .lighting = take_lights(scene.lights),
                     .exposure = scene.exposure,
                     .material_path = scene.material_file,
                     .warnings = scene.warnings};
  for (SurfaceLayer& layer : scene.layers)
    opened.layers.push_back(std::make_shared<const SurfaceLayer>(std::move(layer)));
  if (std::holds_alternative<BssrdfTable>(scene.material)) {
    opened.table = open_table(scene.material_file);
    opened.material = Material(fit_profiles(*opened.table, {}, progress).map);
  } else {
    opened.material = std::move(std::get<Material>(scene.material));
  }
  opened.stage = make_stage(std::move(scene));
  return opened;
}

void show_scene(Studio& studio, const OpenedScene& scene) {
  const MeshSource& mesh = scene.stage->scene.mesh_source;
  show_stage(studio, scene.stage, mesh.file.empty() ? mesh.shape : mesh.file);
  studio.orbit = scene.orbit;
  studio.lighting = scene.lighting;
  studio.selected_light = find_light(scene.lighting, scene.lighting.size(), false);
  studio.layers = studio.saved_layers = scene.layers;
  studio.selected_stage_layer.reset();
  studio.exposure = scene.exposure;
  if (const auto* map = std::get_if<ProfileMap>(&scene.material))
    show_map(studio, *map, scene.material_path, scene.table);
  else if (const auto* blend = std::get_if<ProfileBlend>(&scene.material))
    show_map(studio, make_profile_map(*blend), scene.material_path);
  else
    set_homogeneous(studio, std::get<Dipole>(scene.material));
  studio.scene_history = {};
  for (const std::string& warning : scene.warnings) report(studio, warning);
}

Scene describe_scene(const Studio& studio) {
  const Scene& stage = studio.stage->scene;
  Scene scene{.mesh_name = stage.mesh_name,
              .mesh_source = stage.mesh_source,
              .mapping = stage.mapping,
              .specular = stage.specular,
              .camera = make_view_camera(studio, 1),
              .lights = make_lights(studio.lighting, Disabled::keep),
              .exposure = studio.exposure,
              .show_environment = stage.show_environment,
              .background = stage.background};
  if (studio.is_homogeneous)
    scene.material = Material(studio.homogeneous);
  else
    scene.material_file = fs::absolute(studio.material_path).string();
  for (const auto& layer : studio.layers)
    if (why_not(*layer, *studio.stage, *studio.material).empty()) scene.layers.push_back(*layer);
  return scene;
}

bool is_material_of_file(const Studio& studio) {
  if (studio.shown_compressed || studio.snapshot == nullptr) return false;
  const auto is_on = [](const LayerSnapshot& layer) { return layer.enabled; };
  if (std::any_of(studio.snapshot->layers.begin(), studio.snapshot->layers.end(), is_on))
    return false;
  const FileKind kind = find_file_kind(studio.material_path);
  return kind == FileKind::map || kind == FileKind::blend;
}

void save_scene(Studio& studio, const std::string& path) {
  if (studio.stage == nullptr || studio.material == nullptr) return;
  try {
    Scene scene = describe_scene(studio);
    std::shared_ptr<const Material> written;
    std::string beside;
    if (!studio.is_homogeneous && !is_material_of_file(studio)) {
      written = studio.material;
      const bool is_blend = std::holds_alternative<ProfileBlend>(*written);
      beside = scene.material_file =
          name_beside(path, is_blend ? ".kbm" : ".h5", studio.material_path);
    }
    std::vector<PaintedFile> painted = name_painted_masks(studio, scene, path);
    for_each_file(scene, [folder = fs::absolute(path).parent_path()](std::string& file) {
      file = fs::path(file).lexically_proximate(folder).string();
    });
    const bool is_whole = scene.layers.size() == studio.layers.size();
    studio.jobs.start(
        "save " + path,
        [&studio, path, written, beside, is_whole, painted = std::move(painted),
         layers = studio.layers,
         description = write_scene(scene)](const Progress&) -> Jobs::Finish {
          if (written != nullptr) save_material(beside, *written);
          for (const PaintedFile& file : painted) save_painted(file);
          save_document(path, description);
          return [&studio, path, is_whole, layers] {
            studio.saved_layers = layers;
            remember(studio, path);
            report(studio, "saved " + path + (is_whole ? "" : " without layers that do not fit"));
          };
        });
  } catch (const std::exception& error) {
    report(studio, error.what(), true);
  }
}

}  // namespace parian

#include "app/studio/studio_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "app/cli/inputs.h"
#include "app/studio/tools.h"
#include "base/error.h"
#include "fit/fit.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/json.h"
#include "io/mesh/mesh_file.h"
#include "scene/environment.h"

namespace parian {
namespace {

constexpr double mesh_size_mm = 60;
constexpr double radian_deg = 57.29577951308232;
constexpr Rgb background{0.02f, 0.02f, 0.025f};

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

RecipeLoaders make_loaders(const std::string& recipe) {
  return make_recipe_loaders(std::filesystem::path(recipe).parent_path().string());
}

// Names of jobs are seen while they run.
std::string opening(const std::string& path) {
  return "open " + file_name(path);
}

void open_table_file(Studio& studio, const std::string& path) {
  studio.jobs.start(opening(path), [&studio, path](const Progress& progress) -> Jobs::Finish {
    std::shared_ptr<const SliceSource> table = open_table(path);
    auto map = std::make_shared<ProfileMap>(fit_profiles(*table, {}, progress).map);
    return [&studio, path, table, map] {
      show_map(studio, *map, path, table);
      remember(studio, path);
      report(studio, "fitted " + file_name(path));
    };
  });
}

void open_map_file(Studio& studio, const std::string& path, bool is_blend) {
  studio.jobs.start(opening(path), [&studio, path, is_blend](const Progress&) -> Jobs::Finish {
    auto map = std::make_shared<ProfileMap>(is_blend ? make_profile_map(load_blend(path))
                                                     : load_profile_map(path));
    return [&studio, path, map] {
      show_map(studio, *map, path);
      remember(studio, path);
      report(studio, "opened " + file_name(path));
    };
  });
}

void open_mesh_file(Studio& studio, const std::string& path) {
  studio.jobs.start(opening(path), [&studio, path](const Progress&) -> Jobs::Finish {
    auto stage = make_plain_stage(load_mesh(path), path);
    return [&studio, path, stage] {
      show_stage(studio, stage, path);
      remember(studio, path);
      report(studio, fmt::format("opened {}: {} triangles", file_name(path),
                                 stage->scene.mesh.triangles.size()));
    };
  });
}

// EXR and Radiance HDR are environments; PNG and JPEG are photographs to hallucinate from.
void open_image_file(Studio& studio, const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".exr" && extension != ".hdr") return hallucinate(studio, path);
  studio.jobs.start(opening(path), [&studio, path](const Progress&) -> Jobs::Finish {
    auto image = std::make_shared<const Image>(make_environment_image(load_image(path), path));
    return [&studio, path, image] {
      studio.lighting.image = image;
      touch_view(studio);
      remember(studio, path);
      report(studio, "lit by " + file_name(path));
    };
  });
}

// The lamp and the environment of a scene; of several the last.
Lighting read_lighting(const std::vector<Light>& lights) {
  Lighting lighting;
  lighting.lamp = lighting.environment = 0;
  for (const Light& light : lights)
    if (const auto* sky = std::get_if<EnvironmentLight>(&light)) {
      lighting.image = std::make_shared<const Image>(sky->image);
      lighting.environment = static_cast<double>(sky->scale.y);
      lighting.rotation_deg = sky->rotation_deg;
    } else if (const auto* sun = std::get_if<DirectionalLight>(&light)) {
      lighting.lamp = static_cast<double>(sun->irradiance.y);
      lighting.elevation_deg = radian_deg * std::asin(static_cast<double>(sun->direction.y));
      lighting.azimuth_deg = radian_deg * std::atan2(static_cast<double>(sun->direction.x),
                                                     static_cast<double>(sun->direction.z));
    }
  return lighting;
}

HomogeneousControls read_controls(const Dipole& dipole) {
  HomogeneousControls controls{.eta = dipole.eta, .single_scattering = dipole.single_scattering};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto& medium = dipole.channels[std::min(c, dipole.channels.size() - 1)];
    controls.sigma_a[c] = medium.sigma_a;
    controls.sigma_s_prime[c] = medium.sigma_s_prime;
    controls.g[c] = medium.g;
  }
  return controls;
}

void show_material(Studio& studio, const Material& material, const std::string& path) {
  if (const auto* map = std::get_if<ProfileMap>(&material))
    show_map(studio, *map, path);
  else if (const auto* blend = std::get_if<ProfileBlend>(&material))
    show_map(studio, make_profile_map(*blend), path);
  else
    set_homogeneous(studio, read_controls(std::get<Dipole>(material)));
}

void open_scene_file(Studio& studio, const std::string& path) {
  studio.jobs.start(opening(path), [&studio, path](const Progress& progress) -> Jobs::Finish {
    LoadedScene loaded = load_scene(path);
    const Lighting lighting = read_lighting(loaded.scene.lights);
    const Orbit orbit = make_orbit(loaded.scene.camera);
    const double exposure = loaded.scene.exposure;
    // A table is fitted: the stage shows materials.
    auto material = std::make_shared<SurfaceMaterial>(loaded.scene.material);
    if (const auto* table = std::get_if<BssrdfTable>(material.get()))
      *material = Material(fit_profiles(*make_slices(*table), {}, progress).map);
    const bool has_layers = !loaded.scene.layers.empty();
    auto stage = make_stage(std::move(loaded.scene));
    return [=, &studio] {
      show_stage(studio, stage, path);
      studio.orbit = orbit;
      studio.lighting = lighting;
      studio.exposure = exposure;
      show_material(studio, std::get<Material>(*material), path);
      remember(studio, path);
      report(studio, has_layers
                         ? "opened " + file_name(path) + "; its layers on the surface are not shown"
                         : "opened " + file_name(path));
    };
  });
}

// A recipe that cannot be applied leaves the present one as it is.
void open_recipe(Studio& studio, const std::string& path, const Document& document) {
  if (studio.editor == nullptr)
    throw Error({path, {}, "a map to be open before its recipe", "none"});
  studio.jobs.start(opening(path),
                    [&studio, path, document,
                     original = studio.original](const Progress& progress) -> Jobs::Finish {
                      EditSession trial =
                          make_edit_session(std::get<ProfileMap>(*original), make_loaders(path));
                      set_recipe(trial, document);
                      evaluate(trial, progress);
                      return [&studio, path, document, original] {
                        if (studio.original != original)
                          return;  // another map was opened meanwhile
                        show_recipe(studio, path, document, "open " + file_name(path));
                        remember(studio, path);
                        report(studio, "opened " + file_name(path));
                      };
                    });
}

void open_json(Studio& studio, const std::string& path) {
  const Document document = load_document(path);
  if (find(document, "layers") == nullptr || find(document, "mesh") != nullptr)
    return open_scene_file(studio, path);
  open_recipe(studio, path, document);
}

}  // namespace

std::shared_ptr<const Stage> make_plain_stage(TriangleMesh mesh, const std::string& name) {
  Scene scene;
  scene.mesh = std::move(mesh);
  fit_to_size(scene.mesh, mesh_size_mm);
  scene.mesh_name = name;
  scene.background = background;
  return make_stage(std::move(scene));
}

void show_map(Studio& studio, const ProfileMap& map, const std::string& path,
              std::shared_ptr<const SliceSource> table) {
  studio.editor = std::make_unique<Editor>(map, make_loaders(studio.recipe_path));
  studio.snapshot = studio.editor->snapshot();
  studio.seen_version = 0;
  studio.saved_version = studio.autosaved_version = studio.snapshot->version;
  studio.original = std::make_shared<const Material>(map);
  studio.table = std::move(table);
  studio.measured_at = {-1, -1, -1};
  studio.material_path = path;
  studio.is_homogeneous = false;
  studio.selected_layer.reset();
  studio.scene_history = {};
  studio.waiting_strokes.clear();
  studio.picked.reset();
  studio.flat_shows_second = false;
  studio.compressed.clear();
  studio.shown_compressed.reset();
  studio.stamp_source.reset();
  studio.inspected = {map.width / 2, map.height / 2};
  studio.beam = studio.inspected;
  studio.brush_radius_mm = std::max(map.pixel_pitch_mm, 0.02 * map.width * map.pixel_pitch_mm);
  touch_view(studio);
}

void show_stage(Studio& studio, std::shared_ptr<const Stage> stage, const std::string& path) {
  studio.stage = std::move(stage);
  studio.mesh_path = path;
  studio.orbit = frame_stage(*studio.stage, studio.view_width, studio.view_height);
  touch_view(studio);
}

// Paths in it are relative to its folder: a session of its own.
void show_recipe(Studio& studio, const std::string& path, const Document& recipe,
                 const std::string& label) {
  studio.recipe_path = path;
  const auto& map = std::get<ProfileMap>(*studio.original);
  studio.editor = std::make_unique<Editor>(map, make_loaders(path));
  // As it is in its file, once it is evaluated.
  studio.saved_version = studio.editor->snapshot()->version + 1;
  studio.editor->post(label, set_whole_recipe(recipe));
  studio.seen_version = studio.autosaved_version = 0;
  studio.selected_layer.reset();
  studio.scene_history = {};
  touch_map(studio);
}

void open_second(Studio& studio, const std::string& path) {
  const std::string whole = std::filesystem::absolute(path).string();
  studio.jobs.start(opening(path), [&studio, whole](const Progress&) -> Jobs::Finish {
    const FileKind kind = find_file_kind(whole);
    if (kind == FileKind::table)
      throw Error({whole, {}, "a map or a blend (open the table, then export its map)", "a table"});
    auto second = std::make_shared<SecondMaterial>();
    second->path = whole;
    auto map = std::make_shared<ProfileMap>(
        kind == FileKind::blend ? make_profile_map(load_blend(whole)) : load_profile_map(whole));
    second->state = make_edit_state(*map);
    second->map = std::move(map);
    return [&studio, second] {
      studio.second = second;
      studio.flat_shows_second = studio.flat_is_stale = true;
      studio.tool = Tool::eyedropper;
      report(studio, "second material " + file_name(second->path) + ": pick or stamp from it");
    };
  });
}

void open_file(Studio& studio, const std::string& path) {
  try {
    switch (find_file_kind(path)) {
      case FileKind::map:
        return open_map_file(studio, path, false);
      case FileKind::blend:
        return open_map_file(studio, path, true);
      case FileKind::mesh:
        return open_mesh_file(studio, path);
      case FileKind::image:
        return open_image_file(studio, path);
      case FileKind::json:
        return open_json(studio, path);
      case FileKind::transport:
        throw Error({path, {}, "a material, mesh, recipe, scene or image", "transport"});
      default:
        return open_table_file(studio, path);
    }
  } catch (const std::exception& error) {
    report(studio, error.what(), true);
  }
}

}  // namespace parian

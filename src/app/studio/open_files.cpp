#include "app/studio/studio_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "app/cli/inputs.h"
#include "app/studio/figures.h"
#include "app/studio/scene_file.h"
#include "app/studio/stage_layers.h"
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

// A job that opens something in the place of what an earlier one is still opening ends that one.
void start_opening(Studio& studio, std::string& slot, const std::string& path, Jobs::Work work) {
  if (!slot.empty()) studio.jobs.cancel(slot);
  slot = opening(path);
  studio.jobs.start(slot, std::move(work));
}

void open_table_file(Studio& studio, const std::string& path) {
  const auto work = [&studio, path](const Progress& progress) -> Jobs::Finish {
    std::shared_ptr<const SliceSource> table = open_table(path);
    auto map = std::make_shared<ProfileMap>(fit_profiles(*table, {}, progress).map);
    return [&studio, path, table, map] {
      show_map(studio, *map, path, table);
      remember(studio, path);
      report(studio, "fitted " + file_name(path));
    };
  };
  start_opening(studio, studio.base_job, path, work);
}

void open_map_file(Studio& studio, const std::string& path, bool is_blend) {
  const auto work = [&studio, path, is_blend](const Progress&) -> Jobs::Finish {
    auto map = std::make_shared<ProfileMap>(is_blend ? make_profile_map(load_blend(path))
                                                     : load_profile_map(path));
    std::string message = "opened " + file_name(path);
    if (is_blend)
      message +=
          fmt::format(" as a map, which is edited: {} for the blend's {}",
                      bytes_text(map_bytes(*map)), bytes_text(std::filesystem::file_size(path)));
    return [&studio, path, map, message] {
      show_map(studio, *map, path);
      remember(studio, path);
      report(studio, message);
    };
  };
  start_opening(studio, studio.base_job, path, work);
}

void open_mesh_file(Studio& studio, const std::string& path) {
  const auto work = [&studio, path](const Progress&) -> Jobs::Finish {
    auto stage =
        make_plain_stage(load_mesh(path), {.file = std::filesystem::absolute(path).string()});
    return [&studio, path, stage] {
      show_stage(studio, stage, path);
      remember(studio, path);
      report(studio, fmt::format("opened {}: {} triangles", file_name(path),
                                 stage->scene.mesh.triangles.size()));
    };
  };
  start_opening(studio, studio.mesh_job, path, work);
}

// In place of the environment that dragging would turn, as strong and as it was turned.
void put_environment(Studio& studio, const StageLight& light) {
  const std::size_t place = find_light(studio.lighting, studio.selected_light, true);
  if (place < studio.lighting.size())
    studio.lighting[place].sky = light.sky;
  else
    studio.lighting.push_back(light);
  touch_view(studio);
}

// EXR and Radiance HDR are environments; PNG and JPEG are photographs to hallucinate from.
void open_image_file(Studio& studio, const std::string& path) {
  if (!is_environment_image(path)) return hallucinate(studio, path);
  studio.jobs.start(opening(path), [&studio, path](const Progress&) -> Jobs::Finish {
    const StageLight light =
        take_light(EnvironmentLight{.image = make_environment_image(load_image(path), path),
                                    .file = std::filesystem::absolute(path).string()});
    return [&studio, path, light] {
      put_environment(studio, light);
      remember(studio, path);
      report(studio, "lit by " + file_name(path));
    };
  });
}

void open_scene_file(Studio& studio, const std::string& path, const Document& description) {
  const auto work = [&studio, path, description](const Progress& progress) -> Jobs::Finish {
    auto opened = std::make_shared<OpenedScene>(open_scene(description, path, progress));
    return [&studio, path, opened] {
      show_scene(studio, *opened);
      remember(studio, path);
      report(studio, "opened " + file_name(path));
    };
  };
  start_opening(studio, studio.base_job, path, work);
}

Material load_map_or_blend(const std::string& path) {
  const FileKind kind = find_file_kind(path);
  if (kind == FileKind::table)
    throw Error({path, {}, "a map or a blend (open the table, then export its map)", "a table"});
  return kind == FileKind::blend ? Material(load_blend(path)) : Material(load_profile_map(path));
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
    return open_scene_file(studio, path, document);
  open_recipe(studio, path, document);
}

}  // namespace

std::shared_ptr<const Stage> make_plain_stage(TriangleMesh mesh, MeshSource source) {
  Scene scene;
  scene.mesh = std::move(mesh);
  source.size_mm = mesh_size_mm;
  fit_to_size(scene.mesh, source.size_mm);
  scene.mesh_name = source.file.empty() ? source.shape : source.file;
  scene.mesh_source = std::move(source);
  scene.background = background;
  return make_stage(std::move(scene));
}

void show_map(Studio& studio, const ProfileMap& map, const std::string& path,
              std::shared_ptr<const SliceSource> table) {
  studio.editor = std::make_unique<Editor>(map, make_loaders(studio.recipe_path));
  studio.snapshot = studio.editor->snapshot();
  studio.seen_version = 0;
  studio.saved_version = studio.snapshot->version;
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
  studio.mask.brush.radius_mm = 0.04 * static_cast<double>(diagonal(studio.stage->box));
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
  studio.seen_version = 0;
  studio.selected_layer.reset();
  studio.scene_history = {};
  touch_map(studio);
}

void open_layer(Studio& studio, const std::string& path) {
  const std::string whole = std::filesystem::absolute(path).string();
  studio.jobs.start(opening(path), [&studio, whole](const Progress&) -> Jobs::Finish {
    SurfaceLayer layer{.material = std::make_shared<const Material>(load_map_or_blend(whole)),
                       .material_name = file_name(whole),
                       .material_file = whole};
    return [&studio, layer] {
      add_stage_layer(studio, layer);
      report(studio, layer.material_name + " lies on the surface now");
    };
  });
}

void open_second(Studio& studio, const std::string& path) {
  const std::string whole = std::filesystem::absolute(path).string();
  studio.jobs.start(opening(path), [&studio, whole](const Progress&) -> Jobs::Finish {
    auto second = std::make_shared<SecondMaterial>();
    second->path = whole;
    const Material material = load_map_or_blend(whole);
    const auto* blend = std::get_if<ProfileBlend>(&material);
    auto map = std::make_shared<ProfileMap>(blend != nullptr ? make_profile_map(*blend)
                                                             : std::get<ProfileMap>(material));
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

#include "app/studio/studio_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "app/cli/inputs.h"
#include "base/error.h"
#include "fit/fit.h"
#include "image/color.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "io/json/json.h"
#include "io/mesh/mesh_file.h"
#include "mesh/shapes.h"
#include "scene/environment.h"

namespace parian {
namespace {

constexpr double mesh_size_mm = 60;
constexpr std::size_t max_recent = 12;
constexpr Rgb background{0.02f, 0.02f, 0.025f};

std::string file_name(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

RecipeLoaders make_loaders(const std::string& recipe) {
  return make_recipe_loaders(std::filesystem::path(recipe).parent_path().string());
}

std::string recent_path(const StudioPaths& paths) {
  return paths.state_folder.empty() ? "" : paths.state_folder + "/recent.json";
}

void remember(Studio& studio, const std::string& path) {
  const std::string whole = std::filesystem::absolute(path).string();
  std::erase(studio.recent, whole);
  studio.recent.insert(studio.recent.begin(), whole);
  if (studio.recent.size() > max_recent) studio.recent.resize(max_recent);
  if (studio.paths.state_folder.empty()) return;
  Document::Array files;
  for (const std::string& file : studio.recent) files.emplace_back(file);
  Document document{Document::Object{}};
  set(document, "files", std::move(files));
  try {
    save_document(recent_path(studio.paths), document);
  } catch (const Error& error) {
    report(studio, error.what(), true);
  }
}

void load_recent(Studio& studio) {
  const std::string path = recent_path(studio.paths);
  std::error_code ignored;
  if (path.empty() || !std::filesystem::exists(path, ignored)) return;
  try {
    const Document document = load_document(path);
    for (const Document& file : as_array(get(document, "files")))
      studio.recent.push_back(as_string(file));
  } catch (const Error& error) {
    report(studio, error.what(), true);
  }
}

void show_map(Studio& studio, const ProfileMap& map, const std::string& path,
              std::shared_ptr<const SliceSource> table = nullptr) {
  studio.editor = std::make_unique<Editor>(map, make_loaders(studio.recipe_path));
  studio.snapshot = studio.editor->snapshot();
  studio.seen_version = 0;
  studio.saved_version = studio.autosaved_version = studio.snapshot->version;
  studio.original = std::make_shared<const Material>(map);
  studio.table = std::move(table);
  studio.material_path = path;
  studio.is_homogeneous = false;
  studio.selected_layer.reset();
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

void open_table_file(Studio& studio, const std::string& path) {
  studio.jobs.start("open " + path, [&studio, path](const Progress& progress) -> Jobs::Finish {
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
  studio.jobs.start("open " + path, [&studio, path, is_blend](const Progress&) -> Jobs::Finish {
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
  studio.jobs.start("open " + path, [&studio, path](const Progress&) -> Jobs::Finish {
    Scene scene;
    scene.mesh = load_mesh(path);
    fit_to_size(scene.mesh, mesh_size_mm);
    scene.mesh_name = path;
    scene.background = background;
    auto stage = make_stage(std::move(scene));
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
  if (extension != ".exr" && extension != ".hdr") {
    Document from{Document::Object{}}, pin{Document::Object{}}, layer{Document::Object{}};
    if (studio.snapshot == nullptr) return;
    const double pitch = studio.snapshot->after.pixel_pitch_mm;
    set(from, "at",
        Document::Array{(studio.inspected.x + 0.5) * pitch, (studio.inspected.y + 0.5) * pitch});
    set(pin, "at", Document::Array{0.5, 0.5});
    set(pin, "from", std::move(from));
    set(layer, "name", "hallucinate");
    set(layer, "operation", "hallucinate");
    set(layer, "photograph", std::filesystem::absolute(path).string());
    set(layer, "pins", Document::Array{std::move(pin)});
    studio.editor->post("hallucinate", insert_layer(studio.snapshot->layers.size(), layer));
    studio.selected_layer = studio.snapshot->layers.size();
    touch_map(studio);
    return report(studio,
                  "a material from " + file_name(path) + " with the range of the inspected pixel");
  }
  studio.jobs.start("open " + path, [&studio, path](const Progress&) -> Jobs::Finish {
    auto image = std::make_shared<const Image>(make_environment_image(load_image(path), path));
    return [&studio, path, image] {
      studio.lighting.image = image;
      touch_view(studio);
      remember(studio, path);
      report(studio, "lit by " + file_name(path));
    };
  });
}

void open_scene_file(Studio& studio, const std::string& path) {
  studio.jobs.start("open " + path, [&studio, path](const Progress& progress) -> Jobs::Finish {
    LoadedScene loaded = load_scene(path);
    Lighting lighting;
    lighting.lamp = lighting.environment = 0;
    for (const Light& light : loaded.scene.lights)
      if (const auto* sky = std::get_if<EnvironmentLight>(&light)) {
        lighting.image = std::make_shared<const Image>(sky->image);
        lighting.environment = static_cast<double>(sky->scale.y);
        lighting.rotation_deg = sky->rotation_deg;
      } else if (const auto* sun = std::get_if<DirectionalLight>(&light)) {
        lighting.lamp = static_cast<double>(sun->irradiance.y);
        lighting.elevation_deg =
            57.29577951308232 * static_cast<double>(std::asin(sun->direction.y));
        lighting.azimuth_deg =
            57.29577951308232 * static_cast<double>(std::atan2(sun->direction.x, sun->direction.z));
      }
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
      const auto& shown = std::get<Material>(*material);
      if (const auto* map = std::get_if<ProfileMap>(&shown)) {
        show_map(studio, *map, path);
      } else if (const auto* blend = std::get_if<ProfileBlend>(&shown)) {
        show_map(studio, make_profile_map(*blend), path);
      } else {
        const auto& dipole = std::get<Dipole>(shown);
        HomogeneousControls controls{.eta = dipole.eta};
        for (std::size_t c = 0; c < 3; ++c) {
          const auto& medium = dipole.channels[std::min(c, dipole.channels.size() - 1)];
          controls.sigma_a[c] = medium.sigma_a;
          controls.sigma_s_prime[c] = medium.sigma_s_prime;
        }
        set_homogeneous(studio, controls);
      }
      remember(studio, path);
      report(studio, has_layers
                         ? "opened " + file_name(path) + "; its layers on the surface are not shown"
                         : "opened " + file_name(path));
    };
  });
}

void open_recipe(Studio& studio, const std::string& path, const Document& document) {
  if (studio.editor == nullptr)
    throw Error({path, {}, "a map to be open before its recipe", "none"});
  // Paths in it are relative to its folder: a session of its own.
  studio.recipe_path = path;
  const auto& map = std::get<ProfileMap>(*studio.original);
  studio.editor = std::make_unique<Editor>(map, make_loaders(path));
  studio.editor->post("open " + std::filesystem::path(path).filename().string(),
                      set_whole_recipe(document));
  studio.seen_version = 0;
  studio.selected_layer.reset();
  remember(studio, path);
  touch_map(studio);
}

void open_json(Studio& studio, const std::string& path) {
  const Document document = load_document(path);
  if (find(document, "layers") != nullptr && find(document, "mesh") == nullptr)
    return open_recipe(studio, path, document);
  open_scene_file(studio, path);
}

}  // namespace

std::string autosave_path(const StudioPaths& paths) {
  return paths.state_folder.empty() ? "" : paths.state_folder + "/autosave.json";
}

void write_autosave(const Studio& studio) {
  const std::string path = autosave_path(studio.paths);
  if (path.empty() || studio.snapshot == nullptr) return;
  if (studio.snapshot->layers.empty()) return remove_autosave(studio);
  Document document{Document::Object{}};
  set(document, "material", studio.material_path);
  set(document, "recipe_file", studio.recipe_path);
  set(document, "recipe", studio.snapshot->recipe);
  save_document(path, document);
}

void remove_autosave(const Studio& studio) {
  std::error_code ignored;
  const std::string path = autosave_path(studio.paths);
  if (!path.empty()) std::filesystem::remove(path, ignored);
}

void start_studio(Studio& studio, const StudioPaths& paths) {
  studio.paths = paths;
  std::error_code failure;
  if (!paths.state_folder.empty()) {
    std::filesystem::create_directories(paths.state_folder, failure);
    if (failure) {
      report(studio,
             fmt::format("{}: cannot be made ({}); nothing is saved on the way", paths.state_folder,
                         failure.message()),
             true);
      studio.paths.state_folder.clear();
    }
  }
  load_recent(studio);
  const std::string saved = autosave_path(studio.paths);
  if (!saved.empty() && std::filesystem::exists(saved, failure)) studio.recoverable = saved;
  studio.lighting.image = std::make_shared<const Image>(make_studio_image());
  Scene scene;
  scene.mesh = make_shape("knot");
  fit_to_size(scene.mesh, mesh_size_mm);
  scene.mesh_name = "knot";
  scene.background = background;
  show_stage(studio, make_stage(std::move(scene)), "knot");
  const std::string table = paths.data_folder + "/stone-72x64.h5";
  try {
    const std::shared_ptr<const SliceSource> source = open_table(table);
    show_map(studio, fit_profiles(*source, {}).map, table, source);
  } catch (const Error& error) {
    report(studio, error.what(), true);
    set_homogeneous(studio, {});
  }
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

void save_recipe(Studio& studio, const std::string& path) {
  try {
    if (studio.snapshot == nullptr) return;
    save_document(path, studio.snapshot->recipe);
    studio.recipe_path = path;
    studio.saved_version = studio.snapshot->version;
    remember(studio, path);
    report(studio, "saved " + path);
  } catch (const std::exception& error) {
    report(studio, error.what(), true);
  }
}

void save_map(Studio& studio, const std::string& path) {
  if (studio.snapshot == nullptr) return;
  studio.jobs.start("save " + path,
                    [&studio, path, map = studio.snapshot->map](const Progress&) -> Jobs::Finish {
                      save_profile_map(path, *map);
                      return [&studio, path] { report(studio, "saved " + path); };
                    });
}

void save_picture(Studio& studio, const std::string& path) {
  const bool has_refined = studio.refined != nullptr && studio.refined->id == studio.request_id;
  const std::shared_ptr<const Picture> picture = has_refined ? studio.refined : studio.picture;
  if (picture == nullptr) return;
  try {
    Image image = make_image(picture->width, picture->height, 3);
    for (std::size_t i = 0; i < image.values.size(); ++i)
      image.values[i] = decode_srgb(static_cast<float>(picture->rgba[i / 3 * 4 + i % 3]) / 255.0f);
    save_image(path, image);
    report(studio, "saved " + path);
  } catch (const std::exception& error) {
    report(studio, error.what(), true);
  }
}

void save_compressed(Studio& studio, std::size_t index, const std::string& path) {
  if (index >= studio.compressed.size()) return;
  try {
    save_blend(path, *studio.compressed[index].blend, BlendEncoding::packed);
    report(studio, "saved " + path);
  } catch (const std::exception& error) {
    report(studio, error.what(), true);
  }
}

void recover(Studio& studio) {
  if (!studio.recoverable) return;
  const std::string path = *std::exchange(studio.recoverable, std::nullopt);
  try {
    const Document saved = load_document(path);
    const std::string material = as_string(get(saved, "material"));
    const std::string recipe_file = as_string(get(saved, "recipe_file"));
    const Document recipe = get(saved, "recipe");
    const auto apply = [&studio, recipe, recipe_file] {
      studio.recipe_path = recipe_file;
      const auto& map = std::get<ProfileMap>(*studio.original);
      studio.editor = std::make_unique<Editor>(map, make_loaders(recipe_file));
      studio.editor->post("recover", set_whole_recipe(recipe));
      studio.seen_version = 0;
      touch_map(studio);
      report(studio, "recovered the last recipe");
    };
    if (material == studio.material_path) return apply();
    studio.jobs.start(
        "open " + material, [&studio, material, apply](const Progress& progress) -> Jobs::Finish {
          const FileKind kind = find_file_kind(material);
          auto map = std::make_shared<ProfileMap>(
              kind == FileKind::blend ? make_profile_map(load_blend(material))
              : kind == FileKind::map ? load_profile_map(material)
                                      : fit_profiles(*open_table(material), {}, progress).map);
          return [&studio, material, map, apply] {
            show_map(studio, *map, material);
            apply();
          };
        });
  } catch (const std::exception& error) {
    report(studio, error.what(), true);
  }
}

}  // namespace parian

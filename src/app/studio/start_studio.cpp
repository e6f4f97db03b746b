// The first state of the editor, and what it keeps between runs: recent files, the layout, and the
// recipe of a run that ended badly.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <filesystem>
#include <set>
#include <utility>

#include "app/cli/inputs.h"
#include "app/studio/painted_files.h"
#include "app/studio/scene_file.h"
#include "app/studio/studio_files.h"
#include "base/error.h"
#include "fit/fit.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/json/json.h"
#include "mesh/shapes.h"
#include "scene/write_scene.h"

namespace parian {
namespace {

constexpr std::size_t max_recent = 12;

std::string state_file(const StudioPaths& paths, const std::string& name) {
  return paths.state_folder.empty() ? "" : paths.state_folder + "/" + name;
}

// Small files that nothing depends on: what is wrong with them is a message.
void save_state(Studio& studio, const std::string& name, const Document& document) {
  if (studio.paths.state_folder.empty()) return;
  try {
    save_document(state_file(studio.paths, name), document);
  } catch (const Error& error) {
    report(studio, error.what(), true);
  }
}

std::optional<Document> load_state(Studio& studio, const std::string& name) {
  const std::string path = state_file(studio.paths, name);
  std::error_code ignored;
  if (path.empty() || !std::filesystem::exists(path, ignored)) return std::nullopt;
  try {
    return load_document(path);
  } catch (const Error& error) {
    report(studio, std::string(error.what()) + "; the file is made anew", true);
    return std::nullopt;
  }
}

void load_kept(Studio& studio) {
  try {
    if (const auto recent = load_state(studio, "recent.json"))
      for (const Document& file : as_array(get(*recent, "files")))
        studio.recent.push_back(as_string(file));
    if (const auto layout = load_state(studio, "layout.json")) {
      const auto share = [&](const char* key) {
        return static_cast<float>(as_number(get(*layout, key), 0, 1));
      };
      studio.shares = {
          .map = share("map"), .side = share("side"), .flat = share("flat"), .tabs = share("tabs")};
    }
  } catch (const Error& error) {
    report(studio, std::string(error.what()) + "; the file is made anew", true);
  }
}

// The process of an autosave's name; 0: it is none.
pid_t process_of(const std::string& name) {
  if (!name.starts_with(autosave_start) || !name.ends_with(autosave_end)) return 0;
  const std::string_view digits = std::string_view(name).substr(
      autosave_start.size(), name.size() - autosave_start.size() - autosave_end.size());
  pid_t process = 0;
  const auto [end, failure] =
      std::from_chars(digits.data(), digits.data() + digits.size(), process);
  return failure == std::errc() && end == digits.data() + digits.size() ? process : 0;
}

bool has_ended(pid_t process) {
  return process == getpid() || (kill(process, 0) != 0 && errno == ESRCH);
}

void make_state_folder(Studio& studio) {
  std::error_code failure;
  if (studio.paths.state_folder.empty()) return;
  std::filesystem::create_directories(studio.paths.state_folder, failure);
  if (!failure) return;
  report(studio,
         fmt::format("{}: cannot be made ({}); nothing is saved on the way. --state names another "
                     "folder",
                     studio.paths.state_folder, failure.message()),
         true);
  studio.paths.state_folder.clear();
}

ProfileMap load_any_map(const std::string& path, std::shared_ptr<const SliceSource>& table,
                        const Progress& progress) {
  const FileKind kind = find_file_kind(path);
  if (kind == FileKind::blend) return make_profile_map(load_blend(path));
  if (kind == FileKind::map) return load_profile_map(path);
  table = open_table(path);
  return fit_profiles(*table, {}, progress).map;
}

// What an autosave is made into.
struct Saved {
  std::string material_path, recipe_file;
  Document recipe;
  std::optional<OpenedScene> scene;
  std::string scene_error;  // why there is none
  ProfileMap map;
  std::shared_ptr<const SliceSource> table;
};

Saved load_saved(const std::string& path, const Progress& progress) {
  const Document document = load_document(path);
  Saved saved{.material_path = as_string(get(document, "material")),
              .recipe_file = as_string(get(document, "recipe_file")),
              .recipe = get(document, "recipe")};
  // The recipe comes back without the mesh or a layer, too.
  try {
    if (const Document* scene = find(document, "scene"))
      saved.scene = open_scene(*scene, path, progress);
    if (saved.scene)
      forget_autosaved_masks({.state_folder = std::filesystem::path(path).parent_path().string()},
                             saved.scene->layers);
  } catch (const Error& error) {
    if (error.kind == ErrorKind::cancelled) throw;
    saved.scene_error = error.what();
  }
  const ProfileMap* opened =
      saved.scene ? std::get_if<ProfileMap>(&saved.scene->material) : nullptr;
  if (opened != nullptr && saved.scene->material_path == saved.material_path) {
    saved.map = *opened;
    saved.table = saved.scene->table;
  } else {
    saved.map = load_any_map(saved.material_path, saved.table, progress);
  }
  return saved;
}

void show_saved(Studio& studio, const Saved& saved) {
  if (!saved.scene_error.empty()) report(studio, saved.scene_error, true);
  if (saved.scene) show_scene(studio, *saved.scene);
  const bool is_homogeneous = studio.is_homogeneous;
  show_map(studio, saved.map, saved.material_path, saved.table);
  show_recipe(studio, saved.recipe_file, saved.recipe, "recover");
  if (saved.scene && is_homogeneous) set_homogeneous(studio, studio.homogeneous);
  studio.saved_version = 0;
  studio.saved_layers.clear();
  report(studio, "recovered the last recipe");
}

}  // namespace

std::string aside_path(const StudioPaths& paths) {
  return state_file(paths, "unsaved.json");
}

bool is_of_ended_run(const std::string& path) {
  const pid_t process = process_of(std::filesystem::path(path).filename().string());
  return process > 0 && has_ended(process);
}

void remember(Studio& studio, const std::string& path) {
  const std::string whole = std::filesystem::absolute(path).string();
  std::erase(studio.recent, whole);
  studio.recent.insert(studio.recent.begin(), whole);
  if (studio.recent.size() > max_recent) studio.recent.resize(max_recent);
  Document::Array files(studio.recent.begin(), studio.recent.end());
  Document document{Document::Object{}};
  set(document, "files", std::move(files));
  save_state(studio, "recent.json", document);
}

std::string autosave_path(const StudioPaths& paths) {
  return state_file(paths, fmt::format("{}{}{}", autosave_start, getpid(), autosave_end));
}

void write_autosave(const Studio& studio) {
  const std::string path = autosave_path(studio.paths);
  if (path.empty() || studio.snapshot == nullptr) return;
  std::error_code ignored;
  if (studio.snapshot->layers.empty() && studio.scene_history.done.empty()) {
    std::filesystem::remove(path, ignored);
    return sweep_painted_masks(studio.paths, {});
  }
  Document document{Document::Object{}};
  set(document, "material", std::filesystem::absolute(studio.material_path).string());
  set(document, "recipe_file", studio.recipe_path);
  set(document, "recipe", studio.snapshot->recipe);
  std::set<std::string> masks;
  if (studio.stage != nullptr) {
    Scene scene = describe_scene(studio);
    masks = autosave_painted_masks(studio.paths, scene);
    set(document, "scene", write_scene(scene));
  }
  save_document(path, document);
  // What it was recovered from.
  if (!studio.recoverable) std::filesystem::remove(aside_path(studio.paths), ignored);
  sweep_painted_masks(studio.paths, masks);
}

std::optional<std::string> find_autosave(const StudioPaths& paths) {
  const std::string aside = aside_path(paths);
  std::error_code failure, ignored;
  std::filesystem::path newest;
  std::filesystem::file_time_type newest_time{};
  if (paths.state_folder.empty()) return std::nullopt;
  for (std::filesystem::directory_iterator at(paths.state_folder, failure), end;
       !failure && at != end; at.increment(failure)) {
    if (!is_of_ended_run(at->path().string())) continue;
    const auto time = at->last_write_time(ignored);
    if (newest.empty() || time > newest_time) {
      newest = at->path();
      newest_time = time;
    }
  }
  if (!newest.empty()) std::filesystem::rename(newest, aside, ignored);
  return std::filesystem::exists(aside, ignored) ? std::optional(aside) : std::nullopt;
}

void discard_recoverable(Studio& studio) {
  std::error_code ignored;
  if (studio.recoverable) std::filesystem::remove(*studio.recoverable, ignored);
  studio.recoverable.reset();
  sweep_painted_masks(studio.paths, {});
}

void recover(Studio& studio) {
  if (!studio.recoverable) return;
  const std::string path = *std::exchange(studio.recoverable, std::nullopt);
  studio.jobs.start("recover", [&studio, path](const Progress& progress) -> Jobs::Finish {
    auto saved = std::make_shared<const Saved>(load_saved(path, progress));
    return [&studio, saved] { show_saved(studio, *saved); };
  });
}

void start_studio(Studio& studio, const StudioPaths& paths) {
  studio.paths = paths;
  make_state_folder(studio);
  load_kept(studio);
  studio.recoverable = find_autosave(studio.paths);
  studio.lighting = make_first_lighting();
  show_stage(studio, make_plain_stage(make_shape("knot"), {.shape = "knot"}), "knot");
  const std::string path = paths.data_folder + "/stone-72x64.h5";
  try {
    std::shared_ptr<const SliceSource> table;
    const ProfileMap map = load_any_map(path, table, {});
    show_map(studio, map, path, table);
  } catch (const Error& error) {
    report(studio, error.what(), true);
    set_homogeneous(studio, first_homogeneous());
  }
}

void finish_studio(Studio& studio) {
  std::error_code ignored;
  const std::string path = autosave_path(studio.paths);
  if (!path.empty()) std::filesystem::remove(path, ignored);
  // What was recovered has been saved or given up; what was not decided on waits.
  if (!path.empty() && !studio.recoverable)
    std::filesystem::remove(aside_path(studio.paths), ignored);
  sweep_painted_masks(studio.paths, {});
  Document layout{Document::Object{}};
  set(layout, "map", static_cast<double>(studio.shares.map));
  set(layout, "side", static_cast<double>(studio.shares.side));
  set(layout, "flat", static_cast<double>(studio.shares.flat));
  set(layout, "tabs", static_cast<double>(studio.shares.tabs));
  save_state(studio, "layout.json", layout);
}

}  // namespace parian

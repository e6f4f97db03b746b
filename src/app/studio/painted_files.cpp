#include "app/studio/painted_files.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <utility>

#include "app/studio/studio_files.h"
#include "base/hash.h"
#include "io/json/json.h"

namespace parian {
namespace {

namespace fs = std::filesystem;

// Whole, as scenes in the editor have it.
std::string whole_path(const fs::path& path) {
  return fs::absolute(path).lexically_normal().string();
}

template <typename Layer, typename Visit>
void for_vertex_masks(Layer& layer, const Visit& visit) {
  for (auto& term : layer.mask)
    if (auto* mask = std::get_if<VertexMask>(&term.shape)) visit(*mask);
}

// Of all masks that are, were, or may be again.
std::set<std::string> files_of_masks(const Studio& studio) {
  std::set<std::string> files;
  const auto add = [&](const StageLayers& layers) {
    for (const auto& layer : layers)
      for_vertex_masks(*layer, [&](const VertexMask& mask) { files.insert(mask.file); });
  };
  add(studio.layers);
  if (studio.scene_history.present) add(studio.scene_history.present->layers);
  for (const auto* entries : {&studio.scene_history.done, &studio.scene_history.undone})
    for (const SceneEntry& entry : *entries) {
      add(entry.before.layers);
      add(entry.after.layers);
    }
  return files;
}

void for_painted(Scene& scene, const std::function<void(VertexMask&)>& visit) {
  for (SurfaceLayer& layer : scene.layers)
    for_vertex_masks(layer, [&](VertexMask& mask) {
      if (mask.file.empty()) visit(mask);
    });
}

constexpr std::string_view mask_part = "-mask-";

// The autosave that a mask is of; empty: the file is none.
std::string autosave_of(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t at = name.rfind(mask_part);
  return name.starts_with(autosave_start) && at != std::string::npos
             ? (file.parent_path() / (name.substr(0, at) + std::string(autosave_end))).string()
             : std::string();
}

}  // namespace

void save_painted(const PaintedFile& file) {
  Document::Array weights;
  weights.reserve(file.weights.size());
  // The shortest digits of the float: they read back to it.
  for (const float weight : file.weights)
    weights.emplace_back(std::strtod(fmt::format("{}", weight).c_str(), nullptr));
  save_document(file.path, Document(std::move(weights)));
}

std::vector<PaintedFile> name_painted_masks(const Studio& studio, Scene& scene,
                                            const std::string& path) {
  const std::set<std::string> taken = files_of_masks(studio);
  const fs::path folder = fs::path(path).parent_path();
  const std::string stem = fs::path(path).stem().string();
  std::vector<PaintedFile> files;
  int number = 0;
  for_painted(scene, [&](VertexMask& mask) {
    do {
      ++number;
      mask.file = whole_path(folder / fmt::format("{}{}{}.json", stem, mask_part, number));
    } while (taken.contains(mask.file));
    files.push_back({mask.file, mask.weights});
  });
  return files;
}

std::set<std::string> autosave_painted_masks(const StudioPaths& paths, Scene& scene) {
  std::set<std::string> files;
  std::error_code ignored;
  const std::string stem = fs::path(autosave_path(paths)).stem().string();
  for_painted(scene, [&](VertexMask& mask) {
    mask.file =
        whole_path(fs::path(paths.state_folder) /
                   fmt::format("{}{}{:016x}.json", stem, mask_part, hash_values(mask.weights)));
    if (files.insert(mask.file).second && !fs::exists(mask.file, ignored))
      save_painted({mask.file, mask.weights});
  });
  return files;
}

void sweep_painted_masks(const StudioPaths& paths, const std::set<std::string>& kept) {
  std::error_code failure, ignored;
  if (paths.state_folder.empty() || fs::exists(aside_path(paths), ignored)) return;
  std::vector<fs::path> old;
  for (fs::directory_iterator at(paths.state_folder, failure), end; !failure && at != end;
       at.increment(failure)) {
    const std::string autosave = autosave_of(at->path());
    if (autosave.empty() || kept.contains(whole_path(at->path()))) continue;
    const bool is_own = fs::path(autosave).filename() == fs::path(autosave_path(paths)).filename();
    if (is_own || (is_of_ended_run(autosave) && !fs::exists(autosave, ignored)))
      old.push_back(at->path());
  }
  for (const fs::path& path : old) fs::remove(path, ignored);
}

void forget_autosaved_masks(const StudioPaths& paths, StageLayers& layers) {
  const std::string folder = whole_path(paths.state_folder);
  for (std::shared_ptr<const SurfaceLayer>& layer : layers) {
    SurfaceLayer changed = *layer;
    bool changes = false;
    for_vertex_masks(changed, [&](VertexMask& mask) {
      if (autosave_of(mask.file).empty() || fs::path(mask.file).parent_path() != folder) return;
      mask.file.clear();
      changes = true;
    });
    if (changes) layer = std::make_shared<const SurfaceLayer>(std::move(changed));
  }
}

}  // namespace parian

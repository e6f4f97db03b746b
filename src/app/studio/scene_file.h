// Scenes as the editor opens and writes them: what `parian render` makes of the file is what the
// view shows.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/studio/stage.h"
#include "base/document.h"
#include "base/progress.h"
#include "material/slices.h"

namespace parian {

// All paths in it are whole.
struct OpenedScene {
  std::shared_ptr<const Stage> stage;
  Orbit orbit;
  Lighting lighting;
  StageLayers layers;
  double exposure = 0;
  Material material;  // of a table its fit
  std::string material_path;
  std::shared_ptr<const SliceSource> table;  // null: none
  std::vector<std::string> warnings;
};
// Paths in the description are relative to that of `path`.
OpenedScene open_scene(const Document& description, const std::string& path,
                       const Progress& progress);

struct Studio;
void show_scene(Studio& studio, const OpenedScene& scene);

// What the view shows, without meshes and maps: for write_scene. Layers that cannot lie on the
// present material are left out.
Scene describe_scene(const Studio& studio);
// The present material is the file's that it was opened from.
bool is_material_of_file(const Studio& studio);
// A map that was edited, or that is from a table, a blend that was made here, and painted masks
// (painted_files.h) are written beside the description.
void save_scene(Studio& studio, const std::string& path);

}  // namespace parian

// Painted masks as files: beside a scene that is saved, and beside an autosave.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "app/studio/studio.h"

namespace parian {

// One JSON array, as scenes name it.
struct PaintedFile {
  std::string path;
  std::vector<float> weights;
};
void save_painted(const PaintedFile& file);

// Names the painted masks of a scene that have no file, beside it: "dragon.json" has
// "dragon-mask-1.json" and so on, but none that a mask of this run was read from, whose weights may
// come back by undo. What is returned has to be written.
std::vector<PaintedFile> name_painted_masks(const Studio& studio, Scene& scene,
                                            const std::string& path);

// The same for this run's autosave, by what they hold; written where they are not yet. Returns the
// files that the scene needs.
std::set<std::string> autosave_painted_masks(const StudioPaths& paths, Scene& scene);
// Removes those that no autosave needs any more: of this run but for `kept`, and of runs that have
// ended.
void sweep_painted_masks(const StudioPaths& paths, const std::set<std::string>& kept);
// Autosaved ones are nobody's files once they are recovered.
void forget_autosaved_masks(const StudioPaths& paths, StageLayers& layers);

}  // namespace parian

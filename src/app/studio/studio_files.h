// Files of the editor, by what they are, in the background; what is wrong becomes a message.
// Autosave: the recipe and what it belongs to, kept until the program ends as it should.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "app/studio/studio.h"

namespace parian {

// Tables (fitted first), maps, blends, meshes, recipes, scenes, environments (EXR, HDR) and
// photographs (PNG, JPEG), from which a material is made.
void open_file(Studio& studio, const std::string& path);
// Several at once. Of materials the first is edited, the second one is there to pick from; recipes
// and photographs come after the map that they come with. Once a frame open_waiting goes on.
void open_files(Studio& studio, const std::vector<std::string>& paths);
void open_waiting(Studio& studio);
bool is_environment_image(const std::string& path);  // by its name: EXR, HDR
// A map or blend to take profiles and patterns from.
void open_second(Studio& studio, const std::string& path);
// A map or blend that becomes a layer over the material.
void open_layer(Studio& studio, const std::string& path);

void save_recipe(Studio& studio, const std::string& path);
void save_map(Studio& studio, const std::string& path);
void save_picture(Studio& studio, const std::string& path);
void save_compressed(Studio& studio, std::size_t index, const std::string& path);

// What no file holds, as a sentence; empty: nothing. The recipe, and what was painted on the
// surface.
std::string what_is_unsaved(const Studio& studio);
void write_autosave(const Studio& studio);
// Each running editor has a file of its own; empty without a folder for state.
std::string autosave_path(const StudioPaths& paths);
inline constexpr std::string_view autosave_start = "autosave-", autosave_end = ".json";
bool is_of_ended_run(const std::string& autosave);
// What was put aside at the start for the user to decide on.
std::string aside_path(const StudioPaths& paths);
// What another run has left, put aside for `recover`; none: nothing.
std::optional<std::string> find_autosave(const StudioPaths& paths);
// Takes up what find_autosave has found, or throws it away.
void recover(Studio& studio);
void discard_recoverable(Studio& studio);

// Starts with the bundled sample on a mesh; fills `recoverable` when the last run ended badly.
void start_studio(Studio& studio, const StudioPaths& paths);
// When the program ends as it should: nothing to recover, and the layout is kept.
void finish_studio(Studio& studio);

// Between the parts of this only.
void show_map(Studio& studio, const ProfileMap& map, const std::string& path,
              std::shared_ptr<const SliceSource> table = nullptr);
void show_stage(Studio& studio, std::shared_ptr<const Stage> stage, const std::string& path);
void show_recipe(Studio& studio, const std::string& path, const Document& recipe,
                 const std::string& label);
void remember(Studio& studio, const std::string& path);
// Of the size that meshes without a scene get.
std::shared_ptr<const Stage> make_plain_stage(TriangleMesh mesh, MeshSource source);

}  // namespace parian

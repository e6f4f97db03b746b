// Files that commands take, whatever their kind, and checks of where results go.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "edit/recipe.h"
#include "judge/plot.h"
#include "material/material.h"
#include "scene/read_scene.h"

namespace parian {

enum class FileKind { table, map, blend, transport, image, mesh, json, other };

// By the HDF5 attribute "format", then by the name's extension.
FileKind find_file_kind(const std::string& path);

// A table, or a material seen as one.
struct Surface {
  std::shared_ptr<const Material> material;  // null for tables
  std::unique_ptr<SliceSource> slices;       // refers to *material
};

// A material takes grid and offsets from `like`; without it, from its own grid and support.
Surface open_surface(const std::string& path, const TableHeader* like = nullptr);

// A scene with all that it refers to by paths relative to its own.
struct LoadedScene {
  Scene scene;
  MeshReport mesh;                 // of a mesh from a file
  std::vector<std::string> files;  // the description and all it refers to
};
LoadedScene load_scene(const std::string& path);
// The same of a description that was read before; `path` is where it is from.
LoadedScene load_scene(const Document& document, const std::string& path, Disabled disabled);

// Maps (or blends as maps), images and tables by paths relative to a recipe's folder. `files`,
// which must outlive the loaders where it is given, gets the paths of all that they read.
RecipeLoaders make_recipe_loaders(const std::string& folder,
                                  std::vector<std::string>* files = nullptr);

// By whatever names, and where there is none yet.
bool is_same_file(const std::string& a, const std::string& b);

// Before long work: throws when a result cannot be written or would replace an input.
void check_output(const std::string& path, const std::vector<std::string>& inputs);

// --deflate, of commands that write a table.
Param deflate_param(int& deflate);

// Parameters that mean nothing here must have their defaults: the Error, of usage, names the first
// that has not.
void check_unused(const ParamList& given, const ParamList& defaults, const std::string& expected,
                  const std::string& found);

// "X,Y", inside the grid.
PlotPixel parse_pixel(const std::string& text, const TableHeader& header);

}  // namespace parian

#include "app/cli/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "base/error.h"
#include "io/blend/blend_file.h"
#include "io/hdf5/map_file.h"
#include "io/hdf5/table_file.h"
#include "io/image/image_file.h"
#include "io/json/files.h"
#include "io/json/json.h"
#include "io/mesh/mesh_file.h"
#include "render/render.h"
#include "transport/gather_table.h"

namespace parian {

namespace {

// A table is held in memory, whole, and once more while it is rendered.
BssrdfTable load_table(const std::string& path) {
  const std::unique_ptr<SliceSource> source = open_table(path);
  const TableHeader& header = source->header();
  const std::size_t bytes = static_cast<std::size_t>(header.channels) * header.offsets.size() *
                            header.pixels() * sizeof(float);
  check_memory(bytes + gather_table_bytes(header), 0, "a fit of " + path + " needs less");
  return read_table(*source);
}

SurfaceMaterial load_material(const std::string& path) {
  const FileKind kind = find_file_kind(path);
  if (kind == FileKind::map) return Material(load_profile_map(path));
  if (kind == FileKind::blend) return Material(load_blend(path));
  if (kind == FileKind::table || kind == FileKind::other) return load_table(path);
  const char* found = kind == FileKind::image       ? "an image"
                      : kind == FileKind::mesh      ? "a mesh"
                      : kind == FileKind::transport ? "transport"
                                                    : "a JSON file";
  throw Error({path, {}, "a profile map, a blend or a table", found});
}

}  // namespace

FileKind find_file_kind(const std::string& path) {
  if (is_blend_file(path)) return FileKind::blend;
  const std::string format = read_format(path);
  if (format == "parian-bssrdf-table") return FileKind::table;
  if (format == "parian-profile-map") return FileKind::map;
  if (format == "parian-transport") return FileKind::transport;
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".json") return FileKind::json;
  if (extension == ".kbm") return FileKind::blend;  // whatever is in it: the error is a blend's
  for (const char* known : {".png", ".jpg", ".jpeg", ".exr", ".hdr"})
    if (extension == known) return FileKind::image;
  for (const char* known : {".ply", ".obj", ".gltf", ".glb", ".stl"})
    if (extension == known) return FileKind::mesh;
  return FileKind::other;
}

Surface open_surface(const std::string& path, const TableHeader* like) {
  Surface surface;
  const FileKind kind = find_file_kind(path);
  if (kind == FileKind::map || kind == FileKind::blend) {
    surface.material = std::make_shared<const Material>(
        kind == FileKind::map ? Material(load_profile_map(path)) : Material(load_blend(path)));
    surface.slices =
        make_slices(*surface.material, like ? *like : natural_header(*surface.material), path);
  } else {  // whatever it is, its error is that of a table
    surface.slices = open_table(path);
  }
  return surface;
}

LoadedScene load_scene(const std::string& path) {
  return load_scene(load_document(path), path, Disabled::drop);
}

LoadedScene load_scene(const Document& document, const std::string& path, Disabled disabled) {
  LoadedScene loaded;
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const auto resolve = [&](const std::string& name) {
    return loaded.files.emplace_back((folder / name).string());
  };
  loaded.files.push_back(path);
  SceneLoaders loaders;
  loaders.load_mesh = [&](const std::string& name) {
    return load_mesh(resolve(name), &loaded.mesh);
  };
  loaders.load_image = [&](const std::string& name) { return load_image(resolve(name)); };
  loaders.load_material = [&](const std::string& name) { return load_material(resolve(name)); };
  loaders.load_document = [&](const std::string& name) { return load_document(resolve(name)); };
  loaded.scene = read_scene(document, loaders, disabled);
  return loaded;
}

RecipeLoaders make_recipe_loaders(const std::string& folder, std::vector<std::string>* files) {
  const auto resolve = [folder = std::filesystem::path(folder), files](const std::string& name) {
    std::string path = (folder / name).string();
    if (files != nullptr) files->push_back(path);
    return path;
  };
  RecipeLoaders loaders;
  loaders.load_map = [resolve](const std::string& name) {
    const std::string path = resolve(name);
    return find_file_kind(path) == FileKind::blend ? make_profile_map(load_blend(path))
                                                   : load_profile_map(path);
  };
  loaders.load_image = [resolve](const std::string& name) { return load_image(resolve(name)); };
  loaders.load_table = [resolve](const std::string& name) { return open_table(resolve(name)); };
  return loaders;
}

bool is_same_file(const std::string& a, const std::string& b) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  return !a.empty() && !b.empty() &&
         (fs::equivalent(a, b, ignored) || fs::weakly_canonical(fs::absolute(a), ignored) ==
                                               fs::weakly_canonical(fs::absolute(b), ignored));
}

void check_output(const std::string& path, const std::vector<std::string>& inputs) {
  for (const std::string& input : inputs)
    if (is_same_file(path, input))
      throw Error({path, {}, "an output of another name", "the input"}, ErrorKind::usage);
  check_writable(path);
}

Param deflate_param(int& deflate) {
  return {.name = "deflate",
          .help = "compression of the table, 0 for none",
          .target = &deflate,
          .min = 0,
          .max = 9};
}

void check_unused(const ParamList& given, const ParamList& defaults, const std::string& expected,
                  const std::string& found) {
  for (std::size_t i = 0; i < given.size(); ++i)
    if (format_value(given[i]) != format_value(defaults[i]))
      throw Error({{}, "--" + given[i].name, expected, found}, ErrorKind::usage);
}

PlotPixel parse_pixel(const std::string& text, const TableHeader& header) {
  PlotPixel pixel;
  const char* end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, pixel.x);
  const bool has_comma = first.ec == std::errc() && first.ptr != end && *first.ptr == ',';
  const auto second = has_comma ? std::from_chars(first.ptr + 1, end, pixel.y) : first;
  const bool is_inside =
      pixel.x >= 0 && pixel.x < header.width && pixel.y >= 0 && pixel.y < header.height;
  if (!has_comma || second.ec != std::errc() || second.ptr != end || !is_inside)
    throw Error({{},
                 "--plot",
                 fmt::format("a pixel X,Y in a grid of {} x {}", header.width, header.height),
                 "'" + text + "'"},
                ErrorKind::usage);
  return pixel;
}

}  // namespace parian

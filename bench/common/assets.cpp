#include "bench/common/assets.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>

#include "io/image/image_file.h"
#include "io/mesh/mesh_file.h"
#include "mesh/shapes.h"
#include "scene/environment.h"

namespace parian {
namespace {

std::string assets_folder() {
  if (const char* cache = std::getenv("PARIAN_CACHE")) return std::string(cache) + "/assets/";
  if (const char* cache = std::getenv("XDG_CACHE_HOME"))
    return std::string(cache) + "/parian/assets/";
  const char* home = std::getenv("HOME");
  return std::string(home == nullptr ? "" : home) + "/.cache/parian/assets/";
}

}  // namespace

TriangleMesh make_bench_mesh(const std::string& file, int detail, double size_mm) {
  const std::string path = assets_folder() + file;
  TriangleMesh mesh;
  if (std::filesystem::exists(path)) {
    mesh = load_mesh(path);
  } else {
    fmt::print("{} is not there (./run assets fetches it): the built-in knot instead\n", file);
    mesh = make_knot(detail);
  }
  fit_to_size(mesh, size_mm);
  return mesh;
}

EnvironmentLight make_bench_environment() {
  EnvironmentLight light;
  const std::string path = assets_folder() + "sunset.exr";
  light.image = std::filesystem::exists(path) ? make_environment_image(load_image(path), path)
                                              : make_sky_image();
  return light;
}

}  // namespace parian

// Pieces of scene descriptions that several readers share, and the reader of lights.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/document.h"
#include "base/error.h"
#include "scene/read_scene.h"

namespace parian {

inline constexpr double max_length_mm = 1e9;
inline constexpr double max_coefficient = 1000;  // 1/mm
inline constexpr double min_scattering = 1e-6;   // 1/mm

// A number for all three, or an array of 3; each in [min, max].
std::array<double, 3> read_three(const Document& node, double min, double max);
// The same in [0, max_radiance].
Rgb read_rgb(const Document& node);
// An array of 3, each in [min, max].
Vec3 read_vec3(const Document& node, double min, double max);
// An array of 3 other than zero, normalised.
Vec3 read_direction(const Document& node);
// A string that is not empty.
const std::string& read_path(const Document& node);
// "FILE: POINTER: TEXT"
std::string warning_at(const Document& node, const std::string& text);

// An Error at this string, naming the nearest known one.
[[noreturn]] void throw_unknown(const Document& node, const std::vector<std::string>& known);
// The member of that one of these keys which the object has; exactly one must be there.
const Document& get_one_of(const Document& object, const std::vector<std::string>& keys);

// Names that are looked up elsewhere get this node's place.
template <typename Find>
auto find_at(const Document& node, Find find_by_name) {
  const std::string& name = as_string(node);
  try {
    return find_by_name(name);
  } catch (const Error& error) {
    if (!error.parts.file.empty()) throw;
    throw_at(node, error.parts.expected, error.parts.found);
  }
}

// `name` gets what errors and reports call it.
SurfaceMaterial read_material(const Document& node, const SceneLoaders& loaders, std::string& name);
void read_mapping(const Document& node, Mapping& mapping);
// One mask or an array of them.
SurfaceMask read_mask(const Document& node, const SceneLoaders& loaders);
// Onto a scene that has its mesh and material; checks them against both.
void read_layers(const Document& node, const SceneLoaders& loaders, Scene& scene);

std::vector<Light> read_lights(const Document& node, const SceneLoaders& loaders,
                               std::vector<std::string>& warnings);

}  // namespace parian

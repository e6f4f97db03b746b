// Pieces of scene descriptions that several readers share, and the reader of lights.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/document.h"
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

std::vector<Light> read_lights(const Document& node, const SceneLoaders& loaders,
                               std::vector<std::string>& warnings);

}  // namespace parian

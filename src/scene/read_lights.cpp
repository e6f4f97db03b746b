// Lights and small values of scene descriptions.
#include <fmt/format.h>

#include <cmath>

#include "base/check.h"
#include "base/error.h"
#include "base/names.h"
#include "scene/environment.h"
#include "scene/read_parts_internal.h"

namespace parian {
namespace {

constexpr std::size_t max_lights = 64;

DirectionalLight read_directional(const Document& node) {
  check_keys(node, {"type", "enabled", "direction", "irradiance"});
  DirectionalLight light;
  light.direction = read_direction(get(node, "direction"));
  if (const Document* irradiance = find(node, "irradiance"))
    light.irradiance = read_rgb(*irradiance);
  return light;
}

PointLight read_point(const Document& node) {
  check_keys(node, {"type", "enabled", "position", "intensity"});
  PointLight light;
  light.position = read_vec3(get(node, "position"), -max_length_mm, max_length_mm);
  light.intensity = read_rgb(get(node, "intensity"));
  return light;
}

Image read_sky(const Document& node) {
  const std::string& name = as_string(node);
  if (name == "clear") return make_sky_image();
  if (name == "studio") return make_studio_image();
  throw_unknown(node, {"clear", "studio"});
}

EnvironmentLight read_environment(const Document& node, const SceneLoaders& loaders,
                                  std::vector<std::string>& warnings) {
  check_keys(node, {"type", "enabled", "file", "sky", "rotation_deg", "scale"});
  const Document* file = find(node, "file");
  const Document* sky = find(node, "sky");
  if ((file == nullptr) == (sky == nullptr))
    throw_at(node, "one of the keys 'file' and 'sky'", file == nullptr ? "neither" : "both");
  EnvironmentLight light;
  if (const Document* rotation = find(node, "rotation_deg"))
    light.rotation_deg = as_number(*rotation, -360, 360);
  if (const Document* scale = find(node, "scale")) light.scale = read_rgb(*scale);
  if (sky != nullptr) {
    light.image = read_sky(*sky);
    light.sky = as_string(*sky);
  } else {
    PARIAN_CHECK(loaders.load_image != nullptr);
    const std::string& path = read_path(*file);
    std::size_t negative = 0;
    light.image = make_environment_image(loaders.load_image(path), path, &negative);
    light.file = path;
    if (negative > 0)
      warnings.push_back(fmt::format("{}: {} negative values count as 0", path, negative));
  }
  return light;
}

Light read_kind(const Document& node, const SceneLoaders& loaders,
                std::vector<std::string>& warnings) {
  const Document& type = get(node, "type");
  if (as_string(type) == "directional") return read_directional(node);
  if (as_string(type) == "point") return read_point(node);
  if (as_string(type) == "environment") return read_environment(node, loaders, warnings);
  throw_unknown(type, {"directional", "point", "environment"});
}

Light read_light(const Document& node, const SceneLoaders& loaders,
                 std::vector<std::string>& warnings) {
  Light light = read_kind(node, loaders, warnings);
  if (const Document* enabled = find(node, "enabled"))
    std::visit([&](auto& one) { one.enabled = as_bool(*enabled); }, light);
  return light;
}

}  // namespace

std::array<double, 3> read_three(const Document& node, double min, double max) {
  std::array<double, 3> values{};
  if (std::holds_alternative<double>(node.value)) {
    values.fill(as_number(node, min, max));
    return values;
  }
  if (!std::holds_alternative<Document::Array>(node.value) || as_array(node).size() != 3)
    throw_at(node, "a number or an array of 3");
  for (std::size_t c = 0; c < 3; ++c) values[c] = as_number(as_array(node)[c], min, max);
  return values;
}

Rgb read_rgb(const Document& node) {
  const auto values = read_three(node, 0, max_radiance);
  return {static_cast<float>(values[0]), static_cast<float>(values[1]),
          static_cast<float>(values[2])};
}

Vec3 read_vec3(const Document& node, double min, double max) {
  const Document::Array& elements = as_array(node);
  if (elements.size() != 3) throw_at(node, "an array of 3");
  return {static_cast<float>(as_number(elements[0], min, max)),
          static_cast<float>(as_number(elements[1], min, max)),
          static_cast<float>(as_number(elements[2], min, max))};
}

Vec3 read_direction(const Document& node) {
  const Vec3 v = read_vec3(node, -max_length_mm, max_length_mm);
  const float largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
  if (!(largest >= 1e-9f)) throw_at(node, "a direction other than zero", "[0, 0, 0]");
  if (std::abs(dot(v, v) - 1) < 1e-6f) return v;  // what was written is read back to the bit
  return normalize(v / largest);
}

const std::string& read_path(const Document& node) {
  if (as_string(node).empty()) throw_at(node, "a path", "an empty string");
  return as_string(node);
}

std::string warning_at(const Document& node, const std::string& text) {
  return fmt::format("{}{}: {}", node.file ? *node.file + ": " : std::string(),
                     node.pointer.empty() ? "/" : node.pointer, text);
}

void throw_unknown(const Document& node, const std::vector<std::string>& known) {
  const std::string nearest = nearest_name(as_string(node), known);
  throw_at(node, "one of " + list_names(known),
           describe_value(node) +
               (nearest.empty() ? std::string() : fmt::format(" (did you mean '{}'?)", nearest)));
}

// Which one of these keys the object has; exactly one must be there.
const Document& get_one_of(const Document& object, const std::vector<std::string>& keys) {
  const Document* only = nullptr;
  for (const std::string& key : keys) {
    const Document* member = find(object, key);
    if (member == nullptr) continue;
    if (only != nullptr) throw_at(*member, "only one of the keys " + list_names(keys), "another");
    only = member;
  }
  if (only == nullptr) throw_at(object, "one of the keys " + list_names(keys), "none of them");
  return *only;
}

std::vector<Light> read_lights(const Document& node, const SceneLoaders& loaders,
                               std::vector<std::string>& warnings) {
  const Document::Array& elements = as_array(node);
  if (elements.size() > max_lights) throw_at(node, fmt::format("at most {} lights", max_lights));
  std::vector<Light> lights;
  for (const Document& element : elements) lights.push_back(read_light(element, loaders, warnings));
  return lights;
}

}  // namespace parian

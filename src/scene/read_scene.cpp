#include "scene/read_scene.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/error.h"
#include "base/names.h"
#include "mesh/shapes.h"
#include "scene/camera.h"
#include "scene/read_parts_internal.h"

namespace parian {
namespace {

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

// Turned about x, then y, then z.
void rotate(TriangleMesh& mesh, Vec3 degrees) {
  const auto turn = [](float angle, float& a, float& b) {
    const auto c = static_cast<float>(std::cos(angle * std::numbers::pi / 180));
    const auto s = static_cast<float>(std::sin(angle * std::numbers::pi / 180));
    const float turned = c * a - s * b;
    b = s * a + c * b;
    a = turned;
  };
  for (std::vector<Vec3>* vectors : {&mesh.positions, &mesh.normals})
    for (Vec3& v : *vectors) {
      turn(degrees.x, v.y, v.z);
      turn(degrees.y, v.z, v.x);
      turn(degrees.z, v.x, v.y);
    }
}

void read_mesh(const Document& node, const SceneLoaders& loaders, Scene& scene) {
  double size_mm = 0;
  const ParamList params{{.name = "size-mm",
                          .help = "longest side of the mesh's box",
                          .target = &size_mm,
                          .min = 0,
                          .max = 1e6,
                          .above_min = true,
                          .unit = "mm"}};
  read_params(node, params, {"file", "shape", "rotation_deg"});
  get(node, "size_mm");
  Vec3 rotation;
  if (const Document* degrees = find(node, "rotation_deg"))
    rotation = read_vec3(*degrees, -360, 360);
  const Document& source = get_one_of(node, {"file", "shape"});
  if (find(node, "file") != nullptr) {
    scene.mesh_name = read_path(source);
    PARIAN_CHECK(loaders.load_mesh != nullptr);
    scene.mesh = loaders.load_mesh(scene.mesh_name);
  } else {
    scene.mesh_name = as_string(source);
    scene.mesh = find_at(source, [](const std::string& name) { return make_shape(name); });
  }
  if (rotation != Vec3{}) rotate(scene.mesh, rotation);
  fit_to_size(scene.mesh, size_mm);
}

// A measured homogeneous material by name, in any case.
const NamedMaterial* find_named(const std::string& name) {
  const auto lower = [](std::string text) {
    for (char& c : text) c = 'A' <= c && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
  };
  for (const NamedMaterial& material : named_materials())
    if (lower(material.name) == lower(name)) return &material;
  return &find_named_material(name);
}

Dipole read_named(const Document& node) {
  const NamedMaterial& named = *find_at(node, find_named);
  for (const DipoleCoefficients& medium : named.channels)
    if (medium.sigma_s_prime < min_scattering)
      throw_at(node, "a material that scatters in every channel",
               fmt::format("'{}', of which a channel has none measured", named.name));
  return {.channels = {named.channels.begin(), named.channels.end()}, .eta = named.eta};
}

Dipole read_coefficients(const Document& node) {
  const auto sigma_a = read_three(get(node, "sigma_a"), 0, max_coefficient);
  const auto sigma_s_prime =
      read_three(get(node, "sigma_s_prime"), min_scattering, max_coefficient);
  Dipole dipole;
  for (std::size_t c = 0; c < 3; ++c)
    dipole.channels.push_back({.sigma_a = sigma_a[c], .sigma_s_prime = sigma_s_prime[c]});
  if (const Document* eta = find(node, "eta")) dipole.eta = as_number(*eta, 1, 2.5);
  return dipole;
}

void read_material(const Document& node, const SceneLoaders& loaders, Scene& scene) {
  check_keys(node, {"file", "named", "sigma_a", "sigma_s_prime", "eta"});
  const bool has_coefficients =
      find(node, "sigma_a") != nullptr || find(node, "sigma_s_prime") != nullptr;
  if (has_coefficients && find(node, "file") == nullptr && find(node, "named") == nullptr) {
    scene.material = Material(read_coefficients(node));
    scene.material_name = "homogeneous";
    return;
  }
  const Document& source = get_one_of(node, {"file", "named", "sigma_a", "sigma_s_prime"});
  if (const Document* eta = find(node, "eta"))
    throw_at(*eta, "the key 'eta' only beside 'sigma_a'", "it here");
  scene.material_name = as_string(source);
  if (find(node, "file") != nullptr) {
    read_path(source);
    PARIAN_CHECK(loaders.load_material != nullptr);
    scene.material = loaders.load_material(scene.material_name);
  } else {
    scene.material = Material(read_named(source));
  }
}

void read_mapping(const Document& node, Mapping& mapping) {
  read_params(node, describe(mapping), {"offset_mm"});
  if (const Document* offset = find(node, "offset_mm")) {
    if (as_array(*offset).size() != 2) throw_at(*offset, "an array of 2");
    mapping.offset_mm = {static_cast<float>(as_number(as_array(*offset)[0], -1e6, 1e6)),
                         static_cast<float>(as_number(as_array(*offset)[1], -1e6, 1e6))};
  }
  if (const Document* size = find(node, "uv_size_mm"); size && mapping.kind != MappingKind::uv)
    throw_at(*size, "the key 'uv_size_mm' only where 'kind' is 'uv'", "it with 'box'");
}

// What the camera leaves out frames the mesh's box.
void read_camera(const Document* node, Scene& scene) {
  const Bounds3 box = bounds(scene.mesh);
  Camera& camera = scene.camera;
  camera.target = center(box);
  if (node == nullptr) return frame_box(camera, box);
  read_params(*node, describe(camera), {"position", "target", "up"});
  if (const Document* target = find(*node, "target"))
    camera.target = read_vec3(*target, -max_length_mm, max_length_mm);
  if (const Document* up = find(*node, "up")) camera.up = read_direction(*up);
  const Document* position = find(*node, "position");
  if (position == nullptr) return frame_box(camera, box);
  camera.position = read_vec3(*position, -max_length_mm, max_length_mm);
  if (camera.position == camera.target)
    throw_at(*position, "a position other than the target", "both at the same place");
  const ViewProblem problem = check_view(camera, box);
  if (problem == ViewProblem::inside_box)
    scene.warnings.push_back(warning_at(*position, "the camera is inside the mesh's box"));
  if (problem == ViewProblem::box_outside_view)
    scene.warnings.push_back(warning_at(*node, "the mesh is outside the camera's view"));
}

void read_background(const Document& node, Scene& scene) {
  if (!std::holds_alternative<std::string>(node.value)) {
    if (!std::holds_alternative<double>(node.value) &&
        !std::holds_alternative<Document::Array>(node.value))
      throw_at(node, "a number, an array of 3 or 'environment'");
    scene.background = read_rgb(node);
    return;
  }
  if (as_string(node) != "environment") throw_at(node, "a number, an array of 3 or 'environment'");
  for (const Light& light : scene.lights)
    scene.show_environment =
        scene.show_environment || std::holds_alternative<EnvironmentLight>(light);
  if (!scene.show_environment)
    throw_at(node, "a light of type 'environment' to show", "no such light");
}

}  // namespace

Scene read_scene(const Document& document, const SceneLoaders& loaders) {
  check_keys(document, {"$schema", "description", "mesh", "material", "mapping", "specular",
                        "camera", "lights", "exposure", "background", "output"});
  Scene scene;
  if (const Document* text = find(document, "description")) as_string(*text);
  // Small parts first, so that their mistakes are found before large files are read.
  if (const Document* node = find(document, "mapping")) read_mapping(*node, scene.mapping);
  if (const Document* node = find(document, "specular"))
    read_params(*node, describe(scene.specular));
  if (const Document* node = find(document, "exposure")) scene.exposure = as_number(*node, -30, 30);
  if (const Document* node = find(document, "output")) scene.output = as_string(*node);
  const Document& material = get(document, "material");
  read_mesh(get(document, "mesh"), loaders, scene);
  read_camera(find(document, "camera"), scene);
  if (scene.mapping.kind == MappingKind::uv && scene.mesh.texcoords.empty())
    throw Error({.file = scene.mesh_name,
                 .expected = "texture coordinates, as the mapping is 'uv'",
                 .found = "none"});
  const Document* lights = find(document, "lights");
  if (lights != nullptr) scene.lights = read_lights(*lights, loaders, scene.warnings);
  if (scene.lights.empty())
    scene.warnings.push_back(
        warning_at(lights != nullptr ? *lights : document, "no light: the mesh will be black"));
  if (const Document* node = find(document, "background")) read_background(*node, scene);
  read_material(material, loaders, scene);
  return scene;
}

}  // namespace parian

#include "scene/read_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "base/error.h"
#include "mesh/shapes.h"
#include "scene/camera.h"
#include "scene/read_parts_internal.h"

namespace parian {
namespace {

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
  Vec3& rotation = scene.mesh_source.rotation_deg;
  scene.mesh_source.size_mm = size_mm;
  if (const Document* degrees = find(node, "rotation_deg"))
    rotation = read_vec3(*degrees, -360, 360);
  const Document& source = get_one_of(node, {"file", "shape"});
  if (find(node, "file") != nullptr) {
    scene.mesh_name = scene.mesh_source.file = read_path(source);
    PARIAN_CHECK(loaders.load_mesh != nullptr);
    scene.mesh = loaders.load_mesh(scene.mesh_name);
  } else {
    scene.mesh_name = scene.mesh_source.shape = as_string(source);
    scene.mesh = find_at(source, [](const std::string& name) { return make_shape(name); });
  }
  if (rotation != Vec3{}) rotate(scene.mesh, rotation);
  fit_to_size(scene.mesh, size_mm);
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

Scene read_scene(const Document& document, const SceneLoaders& loaders, Disabled disabled) {
  check_keys(document, {"$schema", "description", "mesh", "material", "mapping", "layers",
                        "specular", "camera", "lights", "exposure", "background", "output"});
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
  const auto is_off = [](const Light& light) {
    return !std::visit([](const auto& one) { return one.enabled; }, light);
  };
  if (std::all_of(scene.lights.begin(), scene.lights.end(), is_off))
    scene.warnings.push_back(
        warning_at(lights != nullptr ? *lights : document, "no light: the mesh will be black"));
  if (const Document* node = find(document, "background")) read_background(*node, scene);
  scene.material = read_material(material, loaders, scene.material_name);
  if (const Document* file = find(material, "file")) scene.material_file = as_string(*file);
  if (const Document* node = find(document, "layers")) read_layers(*node, loaders, scene);
  if (disabled == Disabled::keep) return scene;
  std::erase_if(scene.lights, is_off);
  std::erase_if(scene.layers, [](const SurfaceLayer& layer) { return !layer.enabled; });
  return scene;
}

}  // namespace parian

#include "scene/write_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "base/error.h"

namespace parian {
namespace {

// The shortest decimal that reads back to the same float.
Document write_float(float value) {
  return std::strtod(fmt::format("{}", value).c_str(), nullptr);
}

Document write_vec3(Vec3 v) {
  return Document::Array{write_float(v.x), write_float(v.y), write_float(v.z)};
}

Document write_rgb(Rgb color) {
  return color.x == color.y && color.y == color.z ? write_float(color.x) : write_vec3(color);
}

// A description could be written into; here it is only read.
template <typename Params>
Document write_numbers(const Params& params) {
  return write_params(describe(const_cast<Params&>(params)));
}

std::string need(const std::string& file, const std::string& what) {
  if (file.empty()) throw Error({{}, {}, what + " from a file", "one without"});
  return file;
}

Document write_mesh(const MeshSource& mesh) {
  Document node{Document::Object{}};
  if (mesh.shape.empty())
    set(node, "file", need(mesh.file, "a mesh"));
  else
    set(node, "shape", mesh.shape);
  set(node, "size_mm", mesh.size_mm);
  if (mesh.rotation_deg != Vec3{}) set(node, "rotation_deg", write_vec3(mesh.rotation_deg));
  return node;
}

Document write_three(const std::vector<DipoleCoefficients>& channels,
                     double DipoleCoefficients::*value) {
  const double first = channels.front().*value;
  if (std::all_of(channels.begin(), channels.end(),
                  [&](const DipoleCoefficients& channel) { return channel.*value == first; }))
    return first;
  Document::Array values;
  for (const DipoleCoefficients& channel : channels) values.emplace_back(channel.*value);
  return values;
}

void write_channels(Document& node, const std::vector<DipoleCoefficients>& channels) {
  set(node, "sigma_a", write_three(channels, &DipoleCoefficients::sigma_a));
  set(node, "sigma_s_prime", write_three(channels, &DipoleCoefficients::sigma_s_prime));
  set(node, "g", write_three(channels, &DipoleCoefficients::g));
}

Document write_below(const std::vector<DipoleLayer>& layers) {
  Document::Array below;
  for (const DipoleLayer& layer : layers) {
    Document node{Document::Object{}};
    write_channels(node, layer.channels);
    if (layer.thickness_mm > 0) set(node, "thickness_mm", layer.thickness_mm);
    below.push_back(std::move(node));
  }
  return below;
}

void write_gain(Document& node, const char* key, const CurveGain& gain) {
  if (gain.empty()) return;
  Document::Array points;
  for (const CurvePoint& point : gain) points.emplace_back(Document::Array{point.mm, point.factor});
  set(node, key, std::move(points));
}

Document write_dipole(const Dipole& dipole) {
  constexpr const char* models[] = {"classic", "better", "normalized"};
  Document node{Document::Object{}};
  write_channels(node, dipole.channels);
  set(node, "eta", dipole.eta);
  set(node, "single_scattering", dipole.single_scattering);
  set(node, "model", models[static_cast<std::size_t>(dipole.model)]);
  if (dipole.thickness_mm > 0) set(node, "thickness_mm", dipole.thickness_mm);
  if (!dipole.below.empty()) set(node, "below", write_below(dipole.below));
  write_gain(node, "reflectance_gain", dipole.reflectance_gain);
  write_gain(node, "attenuation_gain", dipole.attenuation_gain);
  return node;
}

Document write_material(const Material* material, const std::string& file) {
  if (const auto* dipole = std::get_if<Dipole>(material)) return write_dipole(*dipole);
  return Document::Object{{"file", need(file, "a material")}};
}

Document write_mapping(const Mapping& mapping) {
  Document node = write_numbers(mapping);
  if (mapping.kind != MappingKind::uv)
    std::erase_if(std::get<Document::Object>(node.value),
                  [](const auto& member) { return member.first == "uv_size_mm"; });
  set(node, "offset_mm",
      Document::Array{write_float(mapping.offset_mm.x), write_float(mapping.offset_mm.y)});
  return node;
}

Document write_specular(const Specular& specular) {
  Document node = write_numbers(specular);
  if (specular.eta == 0)
    std::erase_if(std::get<Document::Object>(node.value),
                  [](const auto& member) { return member.first == "eta"; });
  return node;
}

Document write_camera(const Camera& camera) {
  Document node = write_numbers(camera);
  set(node, "position", write_vec3(camera.position));
  set(node, "target", write_vec3(camera.target));
  set(node, "up", write_vec3(camera.up));
  return node;
}

// What a mask has beside its plain numbers.
struct WriteMask {
  Document& node;

  void operator()(const VertexMask& mask) const {
    set(node, "type", "vertex");
    set(node, "file", need(mask.file, "a mask's weights"));
  }
  void operator()(const TextureMask& mask) const {
    set(node, "type", "texture");
    set(node, "file", need(mask.file, "a mask's image"));
  }
  void operator()(const ProjectedMask& mask) const {
    set(node, "type", "projected");
    if (mask.image.width > 0) set(node, "file", need(mask.file, "a mask's image"));
    set(node, "center", write_vec3(mask.center));
    set(node, "direction", write_vec3(mask.direction));
    set(node, "up", write_vec3(mask.up));
  }
  void operator()(const GradientMask& mask) const {
    set(node, "type", "gradient");
    set(node, "from", write_vec3(mask.from));
    set(node, "to", write_vec3(mask.to));
  }
  void operator()(const SphereMask& mask) const {
    set(node, "type", "sphere");
    set(node, "center", write_vec3(mask.center));
  }
  void operator()(const SlabMask& mask) const {
    set(node, "type", "slab");
    set(node, "point", write_vec3(mask.point));
    set(node, "direction", write_vec3(mask.direction));
  }
  void operator()(const NoiseMask&) const { set(node, "type", "noise"); }
  void operator()(const StripesMask& mask) const {
    set(node, "type", "stripes");
    set(node, "direction", write_vec3(mask.direction));
  }
};

Document write_mask(const SurfaceMask& mask) {
  Document::Array terms;
  for (const MaskTerm& term : mask) {
    Document node = std::visit([](const auto& shape) { return write_numbers(shape); }, term.shape);
    std::visit(WriteMask{node}, term.shape);
    if (term.invert) set(node, "invert", true);
    terms.push_back(std::move(node));
  }
  return terms;
}

Document write_layer(const SurfaceLayer& layer) {
  Document node{Document::Object{}};
  if (!layer.material_name.empty()) set(node, "name", layer.material_name);
  if (!layer.enabled) set(node, "enabled", false);
  set(node, "material", write_material(layer.material.get(), layer.material_file));
  set(node, "mapping", write_mapping(layer.mapping));
  if (!layer.mask.empty()) set(node, "mask", write_mask(layer.mask));
  const Document numbers = write_numbers(layer);
  for (const auto& [key, value] : as_object(numbers)) set(node, key, value);
  return node;
}

struct WriteLight {
  Document& node;

  void operator()(const DirectionalLight& light) const {
    set(node, "type", "directional");
    set(node, "direction", write_vec3(light.direction));
    set(node, "irradiance", write_rgb(light.irradiance));
  }
  void operator()(const PointLight& light) const {
    set(node, "type", "point");
    set(node, "position", write_vec3(light.position));
    set(node, "intensity", write_rgb(light.intensity));
  }
  void operator()(const EnvironmentLight& light) const {
    set(node, "type", "environment");
    if (light.sky.empty())
      set(node, "file", need(light.file, "an environment"));
    else
      set(node, "sky", light.sky);
    set(node, "rotation_deg", light.rotation_deg);
    set(node, "scale", write_rgb(light.scale));
  }
};

Document write_lights(const std::vector<Light>& lights) {
  Document::Array nodes;
  for (const Light& light : lights) {
    Document node{Document::Object{}};
    std::visit(WriteLight{node}, light);
    if (!std::visit([](const auto& one) { return one.enabled; }, light))
      set(node, "enabled", false);
    nodes.push_back(std::move(node));
  }
  return nodes;
}

bool has_environment(const Scene& scene) {
  return std::any_of(scene.lights.begin(), scene.lights.end(), [](const Light& light) {
    return std::holds_alternative<EnvironmentLight>(light);
  });
}

}  // namespace

Document write_scene(const Scene& scene) {
  Document document{Document::Object{}};
  set(document, "mesh", write_mesh(scene.mesh_source));
  set(document, "material",
      write_material(std::get_if<Material>(&scene.material), scene.material_file));
  set(document, "mapping", write_mapping(scene.mapping));
  if (!scene.layers.empty()) {
    Document::Array layers;
    for (const SurfaceLayer& layer : scene.layers) layers.push_back(write_layer(layer));
    set(document, "layers", std::move(layers));
  }
  set(document, "specular", write_specular(scene.specular));
  set(document, "camera", write_camera(scene.camera));
  set(document, "lights", write_lights(scene.lights));
  set(document, "exposure", scene.exposure);
  if (scene.show_environment && has_environment(scene))
    set(document, "background", "environment");
  else
    set(document, "background", write_rgb(scene.background));
  if (!scene.output.empty()) set(document, "output", scene.output);
  return document;
}

}  // namespace parian

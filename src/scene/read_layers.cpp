// Materials of scene descriptions, and the layers that they form on a surface.
#include <fmt/format.h>

#include "base/check.h"
#include "scene/read_parts_internal.h"

namespace parian {
namespace {

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

SurfaceLayer read_layer(const Document& node, const SceneLoaders& loaders) {
  SurfaceLayer layer;
  read_params(node, describe(layer), {"name", "material", "mapping", "mask"});
  if (const Document* mapping = find(node, "mapping")) read_mapping(*mapping, layer.mapping);
  if (const Document* mask = find(node, "mask")) layer.mask = read_mask(*mask, loaders);
  const Document& source = get(node, "material");
  SurfaceMaterial material = read_material(source, loaders, layer.material_name);
  if (std::holds_alternative<BssrdfTable>(material))
    throw_at(source, "a fitted or homogeneous material", "the table '" + layer.material_name + "'");
  layer.material = std::move(std::get<Material>(material));
  if (const Document* name = find(node, "name")) layer.material_name = as_string(*name);
  return layer;
}

}  // namespace

SurfaceMaterial read_material(const Document& node, const SceneLoaders& loaders,
                              std::string& name) {
  check_keys(node, {"file", "named", "sigma_a", "sigma_s_prime", "eta"});
  const bool has_coefficients =
      find(node, "sigma_a") != nullptr || find(node, "sigma_s_prime") != nullptr;
  if (has_coefficients && find(node, "file") == nullptr && find(node, "named") == nullptr) {
    name = "homogeneous";
    return Material(read_coefficients(node));
  }
  const Document& source = get_one_of(node, {"file", "named", "sigma_a", "sigma_s_prime"});
  if (const Document* eta = find(node, "eta"))
    throw_at(*eta, "the key 'eta' only beside 'sigma_a'", "it here");
  name = as_string(source);
  if (find(node, "named") != nullptr) return Material(read_named(source));
  read_path(source);
  PARIAN_CHECK(loaders.load_material != nullptr);
  return loaders.load_material(name);
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

void read_layers(const Document& node, const SceneLoaders& loaders, Scene& scene) {
  const Document::Array& elements = as_array(node);
  if (elements.size() > max_layers)
    throw_at(node, fmt::format("at most {} layers", max_layers),
             fmt::format("{}", elements.size()));
  scene.layers.reserve(elements.size());
  for (const Document& element : elements) scene.layers.push_back(read_layer(element, loaders));
  check_layers(scene, node.file ? *node.file : std::string());
}

}  // namespace parian

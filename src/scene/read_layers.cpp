// Layers of scene descriptions, and how materials lie on a surface.
#include <fmt/format.h>

#include "base/check.h"
#include "scene/read_parts_internal.h"

namespace parian {
namespace {

SurfaceLayer read_layer(const Document& node, const SceneLoaders& loaders) {
  SurfaceLayer layer;
  read_params(node, describe(layer), {"name", "enabled", "material", "mapping", "mask"});
  if (const Document* mapping = find(node, "mapping")) read_mapping(*mapping, layer.mapping);
  if (const Document* mask = find(node, "mask")) layer.mask = read_mask(*mask, loaders);
  const Document& source = get(node, "material");
  SurfaceMaterial material = read_material(source, loaders, layer.material_name);
  if (std::holds_alternative<BssrdfTable>(material))
    throw_at(source, "a fitted or homogeneous material", "the table '" + layer.material_name + "'");
  layer.material = std::make_shared<const Material>(std::move(std::get<Material>(material)));
  if (const Document* file = find(source, "file")) layer.material_file = as_string(*file);
  if (const Document* name = find(node, "name")) layer.material_name = as_string(*name);
  if (const Document* enabled = find(node, "enabled")) layer.enabled = as_bool(*enabled);
  return layer;
}

}  // namespace

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

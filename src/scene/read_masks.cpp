// Masks of scene descriptions.
#include "base/check.h"
#include "scene/read_parts_internal.h"

namespace parian {
namespace {

constexpr std::size_t max_masks = 16;  // of one layer

Vec3 read_place(const Document& node) {
  return read_vec3(node, -max_length_mm, max_length_mm);
}

Image read_mask_image(const Document& node, const SceneLoaders& loaders) {
  const std::string& path = read_path(node);
  PARIAN_CHECK(loaders.load_image != nullptr);
  return make_mask_image(loaders.load_image(path), path);
}

// Plain numbers, and the keys that a mask reads itself.
template <typename Mask>
void read_plain(const Document& node, Mask& mask, std::vector<std::string> own) {
  own.insert(own.end(), {"type", "invert"});
  read_params(node, describe(mask), own);
}

VertexMask read_vertex(const Document& node, const SceneLoaders& loaders) {
  VertexMask mask;
  read_plain(node, mask, {"file"});
  const std::string& path = mask.file = read_path(get(node, "file"));
  PARIAN_CHECK(loaders.load_document != nullptr);
  const Document weights = loaders.load_document(path);
  mask.weights.reserve(as_array(weights).size());
  for (const Document& weight : as_array(weights))
    mask.weights.push_back(static_cast<float>(as_number(weight, 0, 1)));
  return mask;
}

TextureMask read_texture(const Document& node, const SceneLoaders& loaders) {
  TextureMask mask;
  read_plain(node, mask, {"file"});
  mask.file = read_path(get(node, "file"));
  mask.image = read_mask_image(get(node, "file"), loaders);
  return mask;
}

ProjectedMask read_projected(const Document& node, const SceneLoaders& loaders) {
  ProjectedMask mask;
  read_plain(node, mask, {"file", "center", "direction", "up"});
  mask.center = read_place(get(node, "center"));
  mask.direction = read_direction(get(node, "direction"));
  if (const Document* up = find(node, "up")) mask.up = read_direction(*up);
  if (const Document* file = find(node, "file")) {
    mask.file = read_path(*file);
    mask.image = read_mask_image(*file, loaders);
  }
  return mask;
}

GradientMask read_gradient(const Document& node) {
  GradientMask mask;
  read_plain(node, mask, {"from", "to"});
  mask.from = read_place(get(node, "from"));
  mask.to = read_place(get(node, "to"));
  return mask;
}

SphereMask read_sphere(const Document& node) {
  SphereMask mask;
  read_plain(node, mask, {"center"});
  mask.center = read_place(get(node, "center"));
  get(node, "radius_mm");
  return mask;
}

SlabMask read_slab(const Document& node) {
  SlabMask mask;
  read_plain(node, mask, {"point", "direction"});
  mask.point = read_place(get(node, "point"));
  mask.direction = read_direction(get(node, "direction"));
  return mask;
}

NoiseMask read_noise(const Document& node) {
  NoiseMask mask;
  read_plain(node, mask, {});
  return mask;
}

StripesMask read_stripes(const Document& node) {
  StripesMask mask;
  read_plain(node, mask, {"direction"});
  if (const Document* direction = find(node, "direction"))
    mask.direction = read_direction(*direction);
  return mask;
}

MaskShape read_shape(const Document& node, const SceneLoaders& loaders) {
  const Document& type = get(node, "type");
  const std::string& name = as_string(type);
  if (name == "vertex") return read_vertex(node, loaders);
  if (name == "texture") return read_texture(node, loaders);
  if (name == "projected") return read_projected(node, loaders);
  if (name == "gradient") return read_gradient(node);
  if (name == "sphere") return read_sphere(node);
  if (name == "slab") return read_slab(node);
  if (name == "noise") return read_noise(node);
  if (name == "stripes") return read_stripes(node);
  throw_unknown(
      type, {"vertex", "texture", "projected", "gradient", "sphere", "slab", "noise", "stripes"});
}

MaskTerm read_term(const Document& node, const SceneLoaders& loaders) {
  MaskTerm term{read_shape(node, loaders)};
  if (const Document* invert = find(node, "invert")) term.invert = as_bool(*invert);
  return term;
}

}  // namespace

SurfaceMask read_mask(const Document& node, const SceneLoaders& loaders) {
  if (std::holds_alternative<Document::Object>(node.value)) return {read_term(node, loaders)};
  if (!std::holds_alternative<Document::Array>(node.value) || as_array(node).empty() ||
      as_array(node).size() > max_masks)
    throw_at(node, "a mask, or an array of 1 to 16");
  SurfaceMask mask;
  mask.reserve(as_array(node).size());
  for (const Document& element : as_array(node)) mask.push_back(read_term(element, loaders));
  return mask;
}

}  // namespace parian

#include "scene/scene.h"

namespace parian {

Boundary boundary_of(const SurfaceMaterial& material) {
  if (const auto* table = std::get_if<BssrdfTable>(&material)) return table->header.boundary;
  return boundary_of(std::get<Material>(material));
}

double eta_of(const SurfaceMaterial& material) {
  if (const auto* table = std::get_if<BssrdfTable>(&material)) return table->header.eta;
  return eta_of(std::get<Material>(material));
}

ParamList describe(Camera& camera) {
  return {{.name = "fov-deg",
           .help = "vertical field of view",
           .target = &camera.fov_deg,
           .min = 0.1,
           .max = 170,
           .unit = "degrees"},
          {.name = "width",
           .help = "of the picture",
           .target = &camera.width,
           .min = 1,
           .max = max_picture_side,
           .unit = "pixels"},
          {.name = "height",
           .help = "of the picture",
           .target = &camera.height,
           .min = 1,
           .max = max_picture_side,
           .unit = "pixels"}};
}

ParamList describe(Mapping& mapping) {
  return {{.name = "kind",
           .help = "texture coordinates, or projection along the nearest axis",
           .target = make_choice(mapping.kind, {"uv", "box"})},
          {.name = "uv-size-mm",
           .help = "of a unit of u and v; 0: the sample's width",
           .target = &mapping.uv_size_mm,
           .min = 0,
           .max = 1e6,
           .unit = "mm"},
          {.name = "scale",
           .help = "enlarges the sample, not its profiles",
           .target = &mapping.scale,
           .min = 1e-3,
           .max = 1e3},
          {.name = "rotation-deg",
           .help = "of the sample in its plane, from its x to its y axis",
           .target = &mapping.rotation_deg,
           .min = -360,
           .max = 360,
           .unit = "degrees"}};
}

ParamList describe(Specular& specular) {
  return {{.name = "enabled", .help = "reflection on top", .target = &specular.enabled},
          {.name = "roughness",
           .help = "perceptual: alpha = roughness^2",
           .target = &specular.roughness,
           .min = 0.02,
           .max = 1},
          {.name = "eta",
           .help = "refractive index; default: the material's",
           .target = &specular.eta,
           .min = 1,
           .max = 4,
           .symbol = "eta"}};
}

}  // namespace parian

#include "scene/scene.h"

#include <fmt/format.h>

#include "base/error.h"

namespace parian {
namespace {

void visit_masks(SurfaceMask& mask, const std::function<void(std::string& path)>& visit) {
  for (MaskTerm& term : mask)
    std::visit(
        [&](auto& shape) {
          if constexpr (requires { shape.file; })
            if (!shape.file.empty()) visit(shape.file);
        },
        term.shape);
}

}  // namespace

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

ParamList describe(SurfaceLayer& layer) {
  const auto part = [](const char* name, const char* help, double& target) {
    return Param{.name = name, .help = help, .target = &target, .min = 0, .max = 1};
  };
  return {part("opacity", "how much of the layer where its mask is 1", layer.opacity),
          part("albedo", "how much of the albedo it takes over", layer.albedo),
          part("range", "how much of the range it takes over", layer.range),
          part("shape", "how much of the shape it takes over", layer.shape)};
}

void check_layers(const Scene& scene, const std::string& file) {
  if (scene.layers.empty()) return;
  if (scene.layers.size() > max_layers)
    throw Error({file, "/layers", fmt::format("at most {} layers", max_layers),
                 fmt::to_string(scene.layers.size())});
  if (std::holds_alternative<BssrdfTable>(scene.material))
    throw Error({file, "/layers", "layers over a fitted or homogeneous material",
                 fmt::format("them over the table '{}'", scene.material_name)});
  for (std::size_t i = 0; i < scene.layers.size(); ++i)
    check_layer(scene.layers[i], std::get<Material>(scene.material), scene.material_name,
                scene.mesh, file, fmt::format("/layers/{}", i));
}

void check_layer(const SurfaceLayer& layer, const Material& below, const std::string& below_name,
                 const TriangleMesh& mesh, const std::string& file, const std::string& place) {
  const auto of = [](const std::string& name) { return name.empty() ? "" : " of '" + name + "'"; };
  const auto name = [](Boundary boundary) {
    return boundary == Boundary::included ? "included" : "excluded";
  };
  const Boundary base = boundary_of(below), own = boundary_of(*layer.material);
  const double base_eta = eta_of(below), own_eta = eta_of(*layer.material);
  if (base != own)
    throw Error({file, place + "/material",
                 fmt::format("the boundary '{}'{}, which lies below", name(base), of(below_name)),
                 fmt::format("'{}'{}", name(own), of(layer.material_name))});
  if (base_eta != own_eta)
    throw Error({file, place + "/material",
                 fmt::format("the eta {}{}, which lies below", base_eta, of(below_name)),
                 fmt::format("{}{}", own_eta, of(layer.material_name))});
  if (layer.mapping.kind == MappingKind::uv && mesh.texcoords.empty())
    throw Error({file, place + "/mapping",
                 "a mesh with texture coordinates, as the mapping is 'uv'", "none"});
  auto& plain = const_cast<SurfaceLayer&>(layer);  // checks only read
  check(describe(plain));
  check(describe(plain.mapping));
  check(layer.mask, mesh, file, place + "/mask");
}

void for_each_file(Scene& scene, const std::function<void(std::string& path)>& visit) {
  const auto visit_named = [&](std::string& path) {
    if (!path.empty()) visit(path);
  };
  visit_named(scene.mesh_source.file);
  visit_named(scene.material_file);
  for (SurfaceLayer& layer : scene.layers) {
    visit_named(layer.material_file);
    visit_masks(layer.mask, visit);
  }
  for (Light& light : scene.lights)
    if (auto* environment = std::get_if<EnvironmentLight>(&light)) visit_named(environment->file);
}

}  // namespace parian

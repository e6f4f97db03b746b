#include <gtest/gtest.h>

#include "base/test_documents.h"
#include "base/test_errors.h"
#include "mesh/shapes.h"
#include "scene/read_scene.h"

namespace parian {
namespace {

SurfaceMaterial load_material(const std::string& path) {
  if (path == "table.h5") return BssrdfTable{};
  ProfileMap map = make_profile_map(2, 2, 3, 1, {0, 1});
  map.boundary = path == "included.h5" ? Boundary::included : Boundary::excluded;
  map.eta = 1.5;
  return Material(std::move(map));
}

SceneLoaders loaders() {
  return {.load_mesh = {},
          .load_image = [](const std::string&) { return make_image(4, 2, 3, 0.5f); },
          .load_material = load_material,
          .load_document =
              [](const std::string&) {
                return array({0, 1, 0.5});
              }};
}

Scene read(Document layers, Document material = object({{"named", "marble"}})) {
  return read_scene(
      locate(object({{"mesh", object({{"shape", "box"}, {"size_mm", 10}})},
                     {"material", std::move(material)},
                     {"layers", std::move(layers)},
                     {"lights", array({object({{"type", "environment"}, {"sky", "studio"}})})}})),
      loaders());
}
Document layer(Document::Object more = {}) {
  Document node = object({{"material", object({{"file", "m.h5"}})}});
  for (auto& [key, value] : more) set(node, key, value);
  return node;
}
std::string error_of(Document layers, Document material = object({{"named", "marble"}})) {
  return parian::error_of([&] { read(std::move(layers), std::move(material)); });
}
std::string mask_error(Document mask) {
  return error_of(array({layer({{"mask", std::move(mask)}})}));
}

TEST(ReadLayers, Defaults) {
  const Scene scene = read(array({layer()}));
  ASSERT_EQ(scene.layers.size(), 1);
  const SurfaceLayer& only = scene.layers[0];
  EXPECT_EQ(only.material_name, "m.h5");
  EXPECT_TRUE(std::holds_alternative<ProfileMap>(only.material));
  EXPECT_TRUE(only.mask.empty());
  for (const double value : {only.opacity, only.albedo, only.range, only.shape})
    EXPECT_EQ(value, 1);
  EXPECT_TRUE(read(array({})).layers.empty());
}

TEST(ReadLayers, EveryKey) {
  const Scene scene = read(array({layer(
      {{"name", "spot"},
       {"mapping", object({{"kind", "uv"}, {"scale", 2}})},
       {"opacity", 0.5},
       {"albedo", 0},
       {"range", 0.25},
       {"shape", 0.75},
       {"mask",
        array({object({{"type", "texture"}, {"file", "a.png"}, {"invert", true}}),
               object({{"type", "projected"},
                       {"file", "a.png"},
                       {"center", array({1, 2, 3})},
                       {"direction", array({0, 0, -2})},
                       {"up", array({0, 3, 0})},
                       {"width_mm", 4},
                       {"height_mm", 5},
                       {"feather_mm", 6},
                       {"facing", false}}),
               object({{"type", "gradient"}, {"from", array({0, 0, 0})}, {"to", array({0, 9, 0})}}),
               object({{"type", "sphere"},
                       {"center", array({1, 2, 3})},
                       {"radius_mm", 4},
                       {"feather_mm", 5}}),
               object({{"type", "slab"},
                       {"point", array({1, 2, 3})},
                       {"direction", array({0, 4, 0})},
                       {"thickness_mm", 5},
                       {"feather_mm", 6}}),
               object({{"type", "noise"},
                       {"scale_mm", 4},
                       {"threshold", 0.25},
                       {"softness", 0.5},
                       {"octaves", 2},
                       {"seed", 7}}),
               object({{"type", "stripes"},
                       {"direction", array({1, 0, 0})},
                       {"period_mm", 4},
                       {"fraction", 0.25},
                       {"offset_mm", -1},
                       {"feather_mm", 0.5}})})}})}));
  const SurfaceLayer& only = scene.layers.at(0);
  EXPECT_EQ(only.material_name, "spot");
  EXPECT_EQ(only.mapping.kind, MappingKind::uv);
  EXPECT_EQ(only.mapping.scale, 2);
  EXPECT_EQ(only.opacity, 0.5);
  EXPECT_EQ(only.albedo, 0);
  EXPECT_EQ(only.range, 0.25);
  EXPECT_EQ(only.shape, 0.75);
  ASSERT_EQ(only.mask.size(), 7);
  EXPECT_TRUE(only.mask[0].invert);
  EXPECT_FALSE(only.mask[1].invert);
  EXPECT_EQ(std::get<TextureMask>(only.mask[0].shape).image.width, 4);
  const auto& projected = std::get<ProjectedMask>(only.mask[1].shape);
  EXPECT_EQ(projected.image.height, 2);
  EXPECT_EQ(projected.center, (Vec3{1, 2, 3}));
  EXPECT_EQ(projected.direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(projected.up, (Vec3{0, 1, 0}));
  EXPECT_EQ(projected.width_mm, 4);
  EXPECT_EQ(projected.height_mm, 5);
  EXPECT_EQ(projected.feather_mm, 6);
  EXPECT_FALSE(projected.facing);
  EXPECT_EQ(std::get<GradientMask>(only.mask[2].shape).to, (Vec3{0, 9, 0}));
  EXPECT_EQ(std::get<SphereMask>(only.mask[3].shape).radius_mm, 4);
  EXPECT_EQ(std::get<SlabMask>(only.mask[4].shape).direction, (Vec3{0, 1, 0}));
  EXPECT_EQ(std::get<NoiseMask>(only.mask[5].shape).seed, 7);
  EXPECT_EQ(std::get<StripesMask>(only.mask[6].shape).offset_mm, -1);
}

TEST(ReadLayers, Errors) {
  EXPECT_EQ(error_of(array({layer({{"opacty", 1}})})),
            "s.json: /layers/0/opacty: expected a known key, found 'opacty' (did you mean "
            "'opacity'?)");
  EXPECT_EQ(error_of(array({object({})})),
            "s.json: /layers/0: expected the key 'material', found no such key");
  EXPECT_EQ(error_of(array({layer({{"albedo", 1.5}})})),
            "s.json: /layers/0/albedo: expected a value in [0, 1], found 1.5");
  EXPECT_EQ(error_of(array({layer()}), object({{"file", "table.h5"}})),
            "s.json: /layers: expected layers over a fitted or homogeneous material, found them "
            "over the table 'table.h5'");
  EXPECT_EQ(error_of(array({object({{"material", object({{"file", "table.h5"}})}})})),
            "s.json: /layers/0/material: expected a fitted or homogeneous material, found the "
            "table 'table.h5'");
  EXPECT_EQ(error_of(array({layer(), object({{"material", object({{"file", "included.h5"}})}})})),
            "s.json: /layers/1/material: expected the boundary 'excluded' of 'marble', which lies "
            "below, found 'included' of 'included.h5'");
  EXPECT_EQ(error_of(array({object(
                {{"material", object({{"sigma_a", 1}, {"sigma_s_prime", 1}, {"eta", 1.25}})}})})),
            "s.json: /layers/0/material: expected the eta 1.5 of 'marble', which lies below, found "
            "1.25 of 'homogeneous'");
  EXPECT_EQ(error_of(array(Document::Array(17, layer()))),
            "s.json: /layers: expected at most 16 layers, found 17");
}

TEST(ReadLayers, MaskErrors) {
  EXPECT_EQ(mask_error(object({{"type", "spher"}})),
            "s.json: /layers/0/mask/type: expected one of 'vertex', 'texture', 'projected', "
            "'gradient', 'sphere', 'slab', 'noise' or 'stripes', found the string 'spher' (did you "
            "mean 'sphere'?)");
  EXPECT_EQ(mask_error(object({{"type", "sphere"}, {"center", array({0, 0, 0})}, {"radius", 1}})),
            "s.json: /layers/0/mask/radius: expected a known key, found 'radius' (did you mean "
            "'radius_mm'?)");
  EXPECT_EQ(mask_error(object({{"type", "sphere"}, {"center", array({0, 0, 0})}})),
            "s.json: /layers/0/mask: expected the key 'radius_mm', found no such key");
  EXPECT_EQ(mask_error(array({})),
            "s.json: /layers/0/mask: expected a mask, or an array of 1 to 16, found an array of 0");
  EXPECT_EQ(
      mask_error(array({object({{"type", "noise"}}), object({{"type", "noise"}, {"octaves", 9}})})),
      "s.json: /layers/0/mask/1/octaves: expected a value in [1, 8], found 9");
  EXPECT_EQ(mask_error(object({{"type", "vertex"}, {"file", "w.json"}})),
            "s.json: /layers/0/mask: expected 14406 weights, one per vertex of the mesh, found 3");
  EXPECT_EQ(mask_error(object(
                {{"type", "slab"}, {"point", array({0, 0, 0})}, {"direction", array({0, 0, 0})}})),
            "s.json: /layers/0/mask/direction: expected a direction other than zero, found [0, 0, "
            "0]");
}

}  // namespace
}  // namespace parian

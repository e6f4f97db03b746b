#include "scene/write_scene.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "base/test_documents.h"
#include "base/test_errors.h"
#include "mesh/shapes.h"
#include "scene/read_scene.h"

namespace parian {
namespace {

SceneLoaders loaders() {
  return {.load_mesh = {},
          .load_image = [](const std::string&) { return make_image(4, 2, 3, 0.5f); },
          .load_material =
              [](const std::string&) {
                ProfileMap map = make_profile_map(2, 2, 3, 1, {0, 1});
                map.eta = 1.4;
                return Material(std::move(map));
              },
          .load_document =
              [](const std::string&) {
                return array(Document::Array(make_shape("box").positions.size(), 0.5));
              }};
}

Document make_masks() {
  return array(
      {object({{"type", "vertex"}, {"file", "w.json"}}),
       object({{"type", "texture"}, {"file", "a.png"}, {"invert", true}}),
       object({{"type", "projected"},
               {"file", "b.png"},
               {"center", array({0.1, 2, 3})},
               {"direction", array({0.3, -0.2, -2})},
               {"up", array({0, 3, 1})},
               {"width_mm", 4},
               {"facing", false}}),
       object(
           {{"type", "projected"}, {"center", array({1, 2, 3})}, {"direction", array({0, 0, 1})}}),
       object({{"type", "gradient"}, {"from", array({0, 0, 0})}, {"to", array({0.7, 9, 0})}}),
       object({{"type", "sphere"}, {"center", array({1, 2, 3})}, {"radius_mm", 4}}),
       object({{"type", "slab"}, {"point", array({1, 2, 3})}, {"direction", array({1, 4, 0})}}),
       object({{"type", "noise"}, {"octaves", 2}, {"seed", 7}}),
       object({{"type", "stripes"}, {"direction", array({1, 1, 0})}, {"offset_mm", -1}})});
}

// Something in every key.
Document make_description(Document material, Document below = array({})) {
  return object(
      {{"mesh", object({{"shape", "box"}, {"size_mm", 10}, {"rotation_deg", array({0, 30, 0.1})}})},
       {"material", std::move(material)},
       {"mapping", object({{"kind", "uv"}, {"uv_size_mm", 3}, {"offset_mm", array({0.1, -2})}})},
       {"layers", std::move(below)},
       {"specular", object({{"roughness", 0.1}, {"eta", 1.7}})},
       {"camera", object({{"position", array({10.1, 20, 30})},
                          {"target", array({0, 1.3, 0})},
                          {"up", array({0.2, 1, 0})},
                          {"fov_deg", 33.3},
                          {"width", 64},
                          {"height", 48}})},
       {"lights",
        array(
            {object({{"type", "directional"},
                     {"direction", array({0.3, 0.7, -0.2})},
                     {"irradiance", array({0.1, 0.2, 0.3})}}),
             object({{"type", "directional"}, {"direction", array({0, 0, 9})}, {"enabled", false}}),
             object({{"type", "point"}, {"position", array({0.1, 22, 3})}, {"intensity", 1234.5}}),
             object({{"type", "environment"}, {"sky", "clear"}, {"rotation_deg", 12.5}}),
             object({{"type", "environment"},
                     {"file", "e.hdr"},
                     {"scale", array({1, 2, 3})},
                     {"enabled", false}})})},
       {"exposure", -0.7},
       {"background", "environment"},
       {"output", "p.png"}});
}

Document make_layers() {
  return array(
      {object({{"name", "spot"},
               {"material", object({{"file", "m.h5"}})},
               {"mapping", object({{"scale", 1.1}, {"rotation_deg", 5}})},
               {"mask", make_masks()},
               {"opacity", 0.1},
               {"albedo", 0.2},
               {"range", 0.3},
               {"shape", 0.4}}),
       object({{"material", object({{"sigma_a", 0.1}, {"sigma_s_prime", 2}, {"eta", 1.4}})},
               {"enabled", false}})});
}

Scene read(const Document& document) {
  return read_scene(document, loaders(), Disabled::keep);
}

// What is written says all that was read, and the same again when it is read back.
void expect_round_trip(const Document& document) {
  const Scene scene = read(document);
  const Document written = write_scene(scene);
  const Scene again = read(written);
  EXPECT_EQ(again.mesh.positions, scene.mesh.positions);
  EXPECT_EQ(again.mesh.normals, scene.mesh.normals);
  EXPECT_EQ(again.camera, scene.camera);
  EXPECT_EQ(again.exposure, scene.exposure);
  EXPECT_EQ(again.output, scene.output);
  EXPECT_EQ(again.show_environment, scene.show_environment);
  EXPECT_EQ(again.background, scene.background);
  EXPECT_EQ(again.material_file, scene.material_file);
  const auto* dipole = std::get_if<Dipole>(&std::get<Material>(scene.material));
  if (dipole != nullptr) {
    EXPECT_EQ(std::get<Dipole>(std::get<Material>(again.material)), *dipole);
  }
  ASSERT_EQ(again.lights.size(), scene.lights.size());
  for (std::size_t i = 0; i < scene.lights.size(); ++i)
    EXPECT_EQ(again.lights[i].index(), scene.lights[i].index());
  ASSERT_EQ(again.layers.size(), scene.layers.size());
  for (std::size_t i = 0; i < scene.layers.size(); ++i) {
    EXPECT_EQ(again.layers[i].mask.size(), scene.layers[i].mask.size());
    EXPECT_EQ(again.layers[i].enabled, scene.layers[i].enabled);
    EXPECT_EQ(again.layers[i].material_name, scene.layers[i].material_name);
  }
  std::vector<std::string> names[2];
  Scene both[2] = {scene, again};
  for (int i = 0; i < 2; ++i)
    for_each_file(both[i], [&](std::string& path) { names[i].push_back(path); });
  EXPECT_EQ(names[0], names[1]);
}

// Documents are compared by what they hold, whatever the order of keys.
bool is_same(const Document& a, const Document& b) {
  if (a.value.index() != b.value.index()) return false;
  if (const auto* members = std::get_if<Document::Object>(&a.value))
    return members->size() == as_object(b).size() &&
           std::all_of(members->begin(), members->end(), [&](const auto& member) {
             const Document* other = find(b, member.first);
             return other != nullptr && is_same(member.second, *other);
           });
  if (const auto* elements = std::get_if<Document::Array>(&a.value))
    return std::equal(elements->begin(), elements->end(), as_array(b).begin(), as_array(b).end(),
                      is_same);
  if (const auto* number = std::get_if<double>(&a.value)) return *number == as_number(b);
  if (const auto* text = std::get_if<std::string>(&a.value)) return *text == as_string(b);
  if (const auto* flag = std::get_if<bool>(&a.value)) return *flag == as_bool(b);
  return true;
}

TEST(WriteScene, IsReadBackToTheBit) {
  const Document slab = object({{"sigma_a", array({0.1, 0.2, 0.3})},
                                {"sigma_s", 2},
                                {"g", array({0.1, 0.2, -0.3})},
                                {"eta", 1.4},
                                {"model", "better"},
                                {"thickness_mm", 0.7},
                                {"below", array({object({{"sigma_a", 1}, {"sigma_s_prime", 3}})})},
                                {"reflectance_gain", array({array({0, 2}), array({1.5, 0.5})})}});
  const Document single = object({{"named", "marble"},
                                  {"single_scattering", true},
                                  {"attenuation_gain", array({array({0, 2})})}});
  for (const Document& description :
       {make_description(slab, make_layers()), make_description(single),
        make_description(object({{"file", "base.h5"}}), make_layers())}) {
    expect_round_trip(description);
    const Document written = write_scene(read(description));
    EXPECT_TRUE(is_same(write_scene(read(written)), written));
  }
}

TEST(WriteScene, NumbersAreThoseOfTheDescription) {
  const Document written =
      write_scene(read(make_description(object({{"file", "base.h5"}}), make_layers())));
  EXPECT_EQ(as_numbers(get(get(written, "camera"), "position")),
            (std::vector<double>{10.1, 20, 30}));
  const Document& lights = get(written, "lights");
  EXPECT_EQ(as_numbers(get(as_array(lights)[0], "irradiance")),
            (std::vector<double>{0.1, 0.2, 0.3}));
  EXPECT_EQ(as_number(get(as_array(lights)[2], "intensity")), 1234.5);
  EXPECT_EQ(find(as_array(lights)[0], "enabled"), nullptr);
  EXPECT_FALSE(as_bool(get(as_array(lights)[1], "enabled")));
  const Document& layer = as_array(get(written, "layers"))[0];
  EXPECT_EQ(as_number(get(layer, "shape")), 0.4);
  EXPECT_EQ(as_array(get(layer, "mask")).size(), 9u);
  EXPECT_EQ(as_string(get(as_array(get(layer, "mask"))[0], "file")), "w.json");
}

TEST(WriteScene, WhatIsOffIsLeftOutOfPictures) {
  const Scene scene =
      read_scene(make_description(object({{"file", "m.h5"}}), make_layers()), loaders());
  EXPECT_EQ(scene.lights.size(), 3u);
  ASSERT_EQ(scene.layers.size(), 1u);
  EXPECT_EQ(scene.layers[0].material_name, "spot");
  // Their mistakes are found all the same.
  Document layers = make_layers();
  set(std::get<Document::Array>(layers.value)[1], "opacity", 2);
  EXPECT_THROW(read_scene(make_description(object({{"file", "m.h5"}}), layers), loaders()), Error);
}

TEST(WriteScene, WhatIsFromNoFileIsAnError) {
  const auto error_of = [](auto change) {
    Scene scene = read(make_description(object({{"file", "m.h5"}}), make_layers()));
    change(scene);
    return parian::error_of([&] { write_scene(scene); });
  };
  EXPECT_EQ(error_of([](Scene& s) { s.material_file.clear(); }),
            "expected a material from a file, found one without");
  EXPECT_EQ(error_of([](Scene& s) { s.mesh_source = {}; }),
            "expected a mesh from a file, found one without");
  EXPECT_EQ(error_of([](Scene& s) { std::get<EnvironmentLight>(s.lights[3]).sky.clear(); }),
            "expected an environment from a file, found one without");
  EXPECT_EQ(
      error_of([](Scene& s) { std::get<TextureMask>(s.layers[0].mask[1].shape).file.clear(); }),
      "expected a mask's image from a file, found one without");
}

}  // namespace
}  // namespace parian

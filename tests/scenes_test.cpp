// The example scenes, and the published schema against the reader.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include "base/test_errors.h"
#include "io/json/json.h"
#include "mesh/shapes.h"
#include "scene/read_scene.h"

namespace parian {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const std::string source_folder = std::string(PARIAN_SOURCE_DIR) + "/";

Document load_schema() {
  return load_document(source_folder + "data/schema/scene.schema.json");
}

// Stand-ins for files that need not be there.
SceneLoaders make_loaders() {
  return {.load_mesh = [](const std::string&) { return make_sphere(2); },
          .load_image = [](const std::string&) { return make_image(4, 2, 3, 1); },
          .load_material =
              [](const std::string&) {
                return Material(Dipole{{{}, {}, {}}, 1.3});
              }};
}

TEST(Scenes, EveryExampleReads) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder + "examples/scenes")) {
    if (entry.path().extension() != ".json") continue;
    ++count;
    const Scene scene = read_scene(load_document(entry.path().string()), make_loaders());
    EXPECT_EQ(scene.warnings, std::vector<std::string>{}) << entry.path();
    EXPECT_FALSE(scene.lights.empty()) << entry.path();
  }
  EXPECT_GE(count, 3);
}

const char* const mask_types[] = {"vertex", "texture", "projected", "gradient",
                                  "sphere", "slab",    "noise",     "stripes"};

std::vector<std::string> keys_of(const Document& object) {
  std::vector<std::string> keys;
  for (const auto& [key, member] : as_object(object)) keys.push_back(key);
  std::sort(keys.begin(), keys.end());
  return keys;
}

// What the reader says of a scene.
std::string error_of(const Document& scene) {
  return parian::error_of([&] { read_scene(scene, make_loaders()); });
}

// None of these keys of a group is unknown to the reader, whatever else is wrong with null there.
void expect_known(Document scene, const std::string& group, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    Document part{Document::Object{}};
    set(part, key, Document(nullptr));
    set(scene, group, part);
    EXPECT_THAT(error_of(scene), AllOf(Not(HasSubstr("known key")), Not(HasSubstr("unknown"))))
        << group << ' ' << key;
  }
}

TEST(Scenes, SchemaHasTheReadersKeys) {
  const Document schema = load_schema();
  Document example = load_document(source_folder + "examples/scenes/knot-marble.json");
  Document mesh{Document::Object{}};
  set(mesh, "file", "sphere.ply");
  set(mesh, "size_mm", 1);
  set(example, "mesh", mesh);
  for (const std::string& key : keys_of(get(schema, "properties"))) {
    Document scene = example;
    if (find(scene, key) == nullptr) set(scene, key, Document(nullptr));
    EXPECT_THAT(error_of(scene), Not(HasSubstr("known key"))) << key;
  }
  const Document& definitions = get(schema, "$defs");
  expect_known(example, "mesh", keys_of(get(get(get(schema, "properties"), "mesh"), "properties")));
  for (const char* group : {"camera", "mapping", "specular"})
    expect_known(example, group, keys_of(get(get(definitions, group), "properties")));
  const auto& kinds = as_array(get(get(definitions, "material"), "oneOf"));
  for (const Document& kind : kinds)
    expect_known(example, "material", keys_of(get(kind, "properties")));
  for (const char* type : {"directional", "point", "environment"})
    for (const std::string& key : keys_of(get(get(definitions, type), "properties"))) {
      Document light{Document::Object{}};
      set(light, key, Document(nullptr));
      set(light, "type", type);
      Document scene = example;
      set(scene, "lights", Document::Array{light});
      EXPECT_THAT(error_of(scene), Not(HasSubstr("known key"))) << type << key;
    }
}

// What the reader says of a layer.
std::string error_of_layer(const Document& layer) {
  Document scene = load_document(source_folder + "examples/scenes/knot-marble.json");
  set(scene, "layers", Document::Array{layer});
  return error_of(scene);
}

TEST(Scenes, SchemaHasTheReadersKeysOfLayers) {
  const Document schema = load_schema();
  const Document& definitions = get(schema, "$defs");
  const auto expect_known_in_layer = [](const Document& layer) {
    EXPECT_THAT(error_of_layer(layer), Not(HasSubstr("known key")));
  };
  for (const std::string& key : keys_of(get(get(definitions, "layer"), "properties"))) {
    Document layer{Document::Object{}};
    set(layer, key, Document(nullptr));
    expect_known_in_layer(layer);
  }
  EXPECT_EQ(as_array(get(get(definitions, "mask"), "oneOf")).size(), std::size(mask_types));
  for (const std::string type : mask_types)
    for (const std::string& key : keys_of(get(get(definitions, type + "_mask"), "properties"))) {
      Document mask{Document::Object{}}, layer{Document::Object{}};
      set(mask, key, Document(nullptr));
      set(mask, "type", type);
      set(layer, "mask", mask);
      expect_known_in_layer(layer);
    }
}

// Names, defaults and ranges of one description; `own` are the keys that are no plain numbers.
void expect_agreement(const Document& definition, const ParamList& params, std::size_t own) {
  const Document& properties = get(definition, "properties");
  EXPECT_EQ(as_object(properties).size(), params.size() + own);
  for (const Param& param : params) {
    const Document& property = get(properties, json_key(param));
    if (const Document* value = find(property, "default")) {
      if (std::holds_alternative<double>(value->value)) {
        EXPECT_EQ(std::stod(format_value(param)), as_number(*value)) << param.name;
      } else if (std::holds_alternative<bool>(value->value)) {
        EXPECT_EQ(format_value(param), as_bool(*value) ? "true" : "false") << param.name;
      } else {
        EXPECT_EQ(format_value(param), as_string(*value)) << param.name;
      }
    }
    const Document* minimum = find(property, param.above_min ? "exclusiveMinimum" : "minimum");
    EXPECT_EQ(minimum != nullptr, std::isfinite(param.min)) << param.name;
    if (minimum != nullptr) {
      EXPECT_EQ(as_number(*minimum), param.min) << param.name;
      EXPECT_EQ(as_number(get(property, "maximum")), param.max) << param.name;
    }
  }
}

TEST(Scenes, SchemaHasTheDescribedRanges) {
  const Document schema = load_schema();
  const Document& definitions = get(schema, "$defs");
  Scene scene;
  expect_agreement(get(definitions, "camera"), describe(scene.camera), 3);
  expect_agreement(get(definitions, "mapping"), describe(scene.mapping), 1);
  expect_agreement(get(definitions, "specular"), describe(scene.specular), 0);
  SurfaceLayer layer;
  expect_agreement(get(definitions, "layer"), describe(layer), 4);
  // Beside the type and whether it is inverted.
  const auto expect_mask = [&](const std::string& type, auto mask, std::size_t own) {
    expect_agreement(get(definitions, type + "_mask"), describe(mask), own + 2);
  };
  expect_mask("vertex", VertexMask{}, 1);
  expect_mask("texture", TextureMask{}, 1);
  expect_mask("projected", ProjectedMask{}, 4);
  expect_mask("gradient", GradientMask{}, 2);
  expect_mask("sphere", SphereMask{}, 1);
  expect_mask("slab", SlabMask{}, 2);
  expect_mask("noise", NoiseMask{}, 0);
  expect_mask("stripes", StripesMask{}, 1);
  std::vector<std::string> shapes;
  const Document& mesh = get(get(schema, "properties"), "mesh");
  for (const Document& name : as_array(get(get(get(mesh, "properties"), "shape"), "enum")))
    shapes.push_back(as_string(name));
  EXPECT_EQ(shapes, shape_names());
}

}  // namespace
}  // namespace parian

#include "scene/read_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/test_documents.h"
#include "base/test_errors.h"
#include "mesh/shapes.h"

namespace parian {
namespace {

SceneLoaders loaders() {
  return {.load_mesh =
              [](const std::string& path) {
                if (path == "gone.ply") throw Error({path, "", "a readable file", "no such file"});
                TriangleMesh mesh = make_box({2, 1, 0.5f}, 1);
                if (path == "plain.ply") mesh.texcoords.clear();
                return mesh;
              },
          .load_image =
              [](const std::string& path) {
                Image image = make_image(4, 2, path == "grey.exr" ? 1 : 3, 0.5f);
                if (path == "nan.exr") at(image, 3, 1, 2) = std::numeric_limits<float>::quiet_NaN();
                if (path == "negative.exr") at(image, 1, 0, 0) = -0.25f;
                if (path == "alpha.png") image = make_image(2, 1, 2);
                if (path == "square.exr") image = make_image(3, 3, 3, 0.5f);
                if (path == "infinite.exr")
                  at(image, 0, 1, 0) = std::numeric_limits<float>::infinity();
                return image;
              },
          .load_material =
              [](const std::string&) {
                ProfileMap map = make_profile_map(2, 2, 3, 1, {0, 1});
                map.boundary = Boundary::included;
                map.eta = 1.45;
                return Material(std::move(map));
              }};
}

Document minimal() {
  return object({{"mesh", object({{"shape", "box"}, {"size_mm", 10}})},
                 {"material", object({{"named", "marble"}})},
                 {"lights", array({object({{"type", "environment"}, {"sky", "studio"}})})}});
}

Scene read(Document document) {
  return read_scene(locate(std::move(document)), loaders());
}
Scene read_with(const std::string& key, Document value) {
  Document document = minimal();
  set(document, key, std::move(value));
  return read(std::move(document));
}
std::string error_with(const std::string& key, Document value) {
  return error_of([&] { read_with(key, std::move(value)); });
}

TEST(ReadScene, DefaultsOfAMinimalScene) {
  const Scene scene = read(minimal());
  EXPECT_EQ(scene.mesh_name, "box");
  const Bounds3 box = bounds(scene.mesh);
  EXPECT_NEAR(extent(box).x, 10, 1e-4);
  EXPECT_NEAR(box.lower.y, 0, 1e-5);
  EXPECT_EQ(scene.material_name, "marble");
  EXPECT_EQ(boundary_of(scene.material), Boundary::excluded);
  EXPECT_EQ(eta_of(scene.material), 1.5);
  EXPECT_EQ(scene.mapping.kind, MappingKind::box);
  EXPECT_EQ(scene.camera.width, 960);
  EXPECT_EQ(scene.camera.target, center(box));
  EXPECT_GT(scene.camera.position.z, 10);
  EXPECT_TRUE(scene.specular.enabled);
  EXPECT_EQ(scene.background, (Rgb{}));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(ReadScene, EveryKey) {
  const Scene scene = read(object(
      {{"$schema", "x"},
       {"description", "all keys"},
       {"mesh", object({{"file", "a.ply"}, {"size_mm", 4}, {"rotation_deg", array({0, 0, 90})}})},
       {"material", object({{"file", "m.h5"}})},
       {"mapping", object({{"kind", "uv"},
                           {"uv_size_mm", 12},
                           {"scale", 2},
                           {"rotation_deg", 30},
                           {"offset_mm", array({1, -2})}})},
       {"specular", object({{"enabled", false}, {"roughness", 0.5}, {"eta", 1.6}})},
       {"camera", object({{"position", array({1, 2, 30})},
                          {"target", array({0, 1, 0})},
                          {"up", array({0, 0, 2})},
                          {"fov_deg", 40},
                          {"width", 64},
                          {"height", 48}})},
       {"lights",
        array(
            {object({{"type", "directional"}, {"direction", array({0, 3, 4})}, {"irradiance", 2}}),
             object({{"type", "point"},
                     {"position", array({1, 2, 3})},
                     {"intensity", array({4, 5, 6})}}),
             object({{"type", "environment"},
                     {"file", "grey.exr"},
                     {"rotation_deg", 45},
                     {"scale", 3}})})},
       {"exposure", -1.5},
       {"output", "picture.exr"},
       {"background", "environment"}}));
  // A quarter turn about z takes the longest side from x to y.
  EXPECT_NEAR(extent(bounds(scene.mesh)).y, 4, 1e-5);
  EXPECT_NEAR(extent(bounds(scene.mesh)).x, 2, 1e-5);
  EXPECT_GT(enclosed_volume(scene.mesh), 0);
  const SurfacePoint point = get_surface_point(scene.mesh, 0, {0.3f, 0.3f});
  EXPECT_GT(dot(point.normal, point.geometric_normal), 0.5f);
  EXPECT_EQ(boundary_of(scene.material), Boundary::included);
  EXPECT_EQ(eta_of(scene.material), 1.45);
  EXPECT_EQ(scene.mapping.kind, MappingKind::uv);
  EXPECT_EQ(scene.mapping.uv_size_mm, 12);
  EXPECT_EQ(scene.mapping.scale, 2);
  EXPECT_EQ(scene.mapping.rotation_deg, 30);
  EXPECT_EQ(scene.mapping.offset_mm, (Vec2{1, -2}));
  EXPECT_FALSE(scene.specular.enabled);
  EXPECT_EQ(scene.specular.eta, 1.6);
  EXPECT_EQ(scene.camera.position, (Vec3{1, 2, 30}));
  EXPECT_EQ(scene.camera.up, (Vec3{0, 0, 1}));
  EXPECT_EQ(scene.camera.height, 48);
  ASSERT_EQ(scene.lights.size(), 3u);
  EXPECT_NEAR(distance(std::get<DirectionalLight>(scene.lights[0]).direction, {0, 0.6f, 0.8f}), 0,
              1e-6);
  EXPECT_EQ(std::get<DirectionalLight>(scene.lights[0]).irradiance, (Rgb{2, 2, 2}));
  EXPECT_EQ(std::get<PointLight>(scene.lights[1]).intensity, (Rgb{4, 5, 6}));
  const auto& environment = std::get<EnvironmentLight>(scene.lights[2]);
  EXPECT_EQ(environment.image.channels, 3);
  EXPECT_EQ(at(environment.image, 3, 1, 2), 0.5f);
  EXPECT_EQ(environment.rotation_deg, 45);
  EXPECT_EQ(scene.exposure, -1.5);
  EXPECT_EQ(scene.output, "picture.exr");
  EXPECT_TRUE(scene.show_environment);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(ReadScene, HomogeneousMaterials) {
  const Scene scene =
      read_with("material", object({{"sigma_a", array({0.1, 0.2, 0.3})}, {"sigma_s_prime", 1.5}}));
  const auto& dipole = std::get<Dipole>(std::get<Material>(scene.material));
  EXPECT_EQ(dipole.channels[2].sigma_a, 0.3);
  EXPECT_EQ(dipole.channels[2].sigma_s_prime, 1.5);
  EXPECT_EQ(dipole.eta, 1.3);
  EXPECT_FALSE(dipole.single_scattering);
  const Scene single = read_with("material", object({{"sigma_a", 0.1},
                                                     {"sigma_s", 2},
                                                     {"g", array({0, 0.5, -0.5})},
                                                     {"single_scattering", true}}));
  const auto& once = std::get<Dipole>(std::get<Material>(single.material));
  EXPECT_TRUE(once.single_scattering);
  EXPECT_EQ(once.channels[1].sigma_s_prime, 1);
  EXPECT_EQ(sigma_s_of(once.channels[2]), 2);
  const auto error = [](Document material) { return error_with("material", std::move(material)); };
  EXPECT_EQ(error(object({{"named", "marbel"}})),
            "s.json: /material/named: expected the name of a measured material, found 'marbel' "
            "(did you mean 'Marble'?)");
  EXPECT_EQ(error(object({{"named", "Coke"}})),
            "s.json: /material/named: expected a material that scatters in every channel, found "
            "'Coke', of which a channel has none measured");
  EXPECT_EQ(
      error(object({{"sigma_a", 0.1}})),
      "s.json: /material: expected one of the keys 'sigma_s_prime' or 'sigma_s', found none of "
      "them");
  EXPECT_EQ(error(object({{"sigma_a", 0.1}, {"sigma_s_prime", array({1, 2})}})),
            "s.json: /material/sigma_s_prime: expected a number or an array of 3, found an array "
            "of 2");
  EXPECT_EQ(error(object({{"named", "Marble"}, {"eta", 1.4}})),
            "s.json: /material/eta: expected the key 'eta' only beside 'sigma_a', found it here");
  EXPECT_EQ(error(object({{"named", "Marble"}, {"file", "m.h5"}})),
            "s.json: /material/named: expected only one of the keys 'file', 'named', 'sigma_a', "
            "'sigma_s_prime' or 'sigma_s', found another");
  EXPECT_EQ(
      error(object({})),
      "s.json: /material: expected one of the keys 'file', 'named', 'sigma_a', 'sigma_s_prime' "
      "or 'sigma_s', found none of them");
  EXPECT_EQ(error(object({{"sigma_a", 1}, {"sigma_s", 1}, {"g", 1}})),
            "s.json: /material/g: expected a number in [-0.99, 0.99], found the number 1");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto coefficients = [&](double sigma_a, double sigma_s, double g) {
    return error(object({{"sigma_a", sigma_a}, {"sigma_s", sigma_s}, {"g", g}}));
  };
  EXPECT_EQ(coefficients(-0.1, 1, 0),
            "s.json: /material/sigma_a: expected a number in [0, 1000], found the number -0.1");
  EXPECT_EQ(coefficients(nan, 1, 0),
            "s.json: /material/sigma_a: expected a number in [0, 1000], found the number nan");
  EXPECT_EQ(coefficients(0.1, 0, 0),
            "s.json: /material/sigma_s: expected a number in [1e-06, 1000], found the number 0");
  EXPECT_EQ(coefficients(0.1, nan, 0),
            "s.json: /material/sigma_s: expected a number in [1e-06, 1000], found the number nan");
  EXPECT_EQ(coefficients(0.1, 1, -1.5),
            "s.json: /material/g: expected a number in [-0.99, 0.99], found the number -1.5");
  EXPECT_EQ(error(object({{"sigma_a", 1}, {"sigma_s", 1}, {"sigma_s_prime", 1}})),
            "s.json: /material/sigma_s: expected only one of the keys 'sigma_s_prime' or "
            "'sigma_s', found another");
  EXPECT_EQ(error(object({{"file", "m.h5"}, {"single_scattering", true}})),
            "s.json: /material/single_scattering: expected the key 'single_scattering' only beside "
            "'sigma_a' or 'named', found it here");
  const Scene skin = read_with(
      "material",
      object({{"named", "Skin1"},
              {"model", "better"},
              {"thickness_mm", 2},
              {"below", Document::Array{object({{"sigma_a", 1}, {"sigma_s", 2}, {"g", 0.5}})}}}));
  const auto& stack = std::get<Dipole>(std::get<Material>(skin.material));
  EXPECT_EQ(stack.model, DiffusionModel::better);
  EXPECT_EQ(stack.thickness_mm, 2);
  ASSERT_EQ(stack.below.size(), 1u);
  EXPECT_EQ(stack.below[0].thickness_mm, 0);
  EXPECT_EQ(stack.below[0].channels[2].sigma_s_prime, 1);
  const Scene drawn = read_with(
      "material", object({{"named", "Marble"},
                          {"reflectance_gain", Document::Array{array({0, 1}), array({2, 3})}}}));
  const auto& gain = std::get<Dipole>(std::get<Material>(drawn.material)).reflectance_gain;
  ASSERT_EQ(gain.size(), 2u);
  EXPECT_EQ(gain[1].factor, 3);
  EXPECT_EQ(error(object({{"named", "Marble"},
                          {"attenuation_gain", Document::Array{array({2, 1}), array({2, 3})}}})),
            "s.json: /material/attenuation_gain/1/0: expected lengths that increase, found 2");
  EXPECT_EQ(error(object({{"named", "Marble"}, {"reflectance_gain", Document::Array{array({2})}}})),
            "s.json: /material/reflectance_gain/0: expected a pair [mm, factor], found an array of "
            "1");
  EXPECT_EQ(
      error(object({{"named", "Marble"}, {"model", "beter"}})),
      "s.json: /material/model: expected one of 'classic', 'better' or 'normalized', found the "
      "string 'beter' (did you mean 'better'?)");
  EXPECT_EQ(error(object({{"named", "Marble"}, {"thickness_mm", 0.1}})),
            "s.json: /material/thickness_mm: expected more than one transport mean free path 1 / "
            "(sigma_a + sigma_s') in all, found 0.219 of them");
  EXPECT_EQ(error(object({{"named", "Marble"}, {"thickness_mm", 5}, {"model", "normalized"}})),
            "s.json: /material/model: expected 'classic' or 'better' beside 'thickness_mm', found "
            "'normalized', which has half-spaces only");
  EXPECT_EQ(error(object({{"named", "Marble"}, {"thickness_mm", -1}})),
            "s.json: /material/thickness_mm: expected a number in [0.001, 10000], found the number "
            "-1");
  EXPECT_EQ(error(object({{"named", "Marble"}, {"below", Document::Array{}}})),
            "s.json: /material/below: expected the key 'thickness_mm' beside 'below', found none");
  EXPECT_EQ(error(object({{"named", "Marble"},
                          {"thickness_mm", 5},
                          {"below", Document::Array{object({{"sigma_a", 1}, {"sigma_s", 1}}),
                                                    object({{"sigma_a", 1}, {"sigma_s", 1}})}}})),
            "s.json: /material/below/0: expected the key 'thickness_mm' in all layers but the "
            "last, found none");
  EXPECT_EQ(error(object({{"named", "Marble"}, {"thickness_mm", 5}, {"single_scattering", true}})),
            "s.json: /material/thickness_mm: expected no 'thickness_mm' beside "
            "'single_scattering', found both");
  EXPECT_EQ(error(object({{"file", "m.h5"}, {"model", "better"}})),
            "s.json: /material/model: expected the key 'model' only beside 'sigma_a' or 'named', "
            "found it here");
  EXPECT_EQ(error(object({{"file", ""}})),
            "s.json: /material/file: expected a path, found an empty string");
}

TEST(ReadScene, BadMeshes) {
  const auto error = [](Document mesh) { return error_with("mesh", std::move(mesh)); };
  const char* size = "s.json: /mesh/size_mm: expected a value in (0, 1000000], found ";
  EXPECT_EQ(error(object({{"shape", "box"}, {"size_mm", 0}})), std::string(size) + "0");
  EXPECT_EQ(error(object({{"shape", "box"}, {"size_mm", -3}})), std::string(size) + "-3");
  EXPECT_EQ(error(object({{"shape", "box"}, {"size_mm", HUGE_VAL}})), std::string(size) + "inf");
  EXPECT_EQ(error(object({{"shape", "box"}, {"size_mm", "big"}})),
            "s.json: /mesh/size_mm: expected a number, found the string 'big'");
  EXPECT_EQ(error(object({{"shape", "box"}})),
            "s.json: /mesh: expected the key 'size_mm', found no such key");
  EXPECT_EQ(error(object({{"shape", "spere"}, {"size_mm", 1}})),
            "s.json: /mesh/shape: expected 'sphere', 'box', 'slab', 'knot' or 'fin', found 'spere' "
            "(did you mean 'sphere'?)");
  EXPECT_EQ(error(object({{"size_mm", 1}})),
            "s.json: /mesh: expected one of the keys 'file' or 'shape', found none of them");
  EXPECT_EQ(error(object({{"shape", "box"}, {"file", "a.ply"}, {"size_mm", 1}})),
            "s.json: /mesh/shape: expected only one of the keys 'file' or 'shape', found another");
  EXPECT_EQ(error(object({{"file", "gone.ply"}, {"size_mm", 1}})),
            "gone.ply: expected a readable file, found no such file");
  EXPECT_EQ(error(object({{"shape", "box"}, {"size_mm", 1}, {"rotation_deg", 90}})),
            "s.json: /mesh/rotation_deg: expected an array, found the number 90");
  EXPECT_EQ(error(object({{"shape", "box"}, {"size_cm", 1}})),
            "s.json: /mesh/size_cm: expected a known key, found 'size_cm' (did you mean "
            "'size_mm'?)");
}

TEST(ReadScene, BadMappings) {
  Document document = minimal();
  set(document, "mesh", object({{"file", "plain.ply"}, {"size_mm", 1}}));
  set(document, "mapping", object({{"kind", "uv"}}));
  EXPECT_EQ(error_of([&] { read(document); }),
            "plain.ply: expected texture coordinates, as the mapping is 'uv', found none");
  const auto error = [](Document mapping) { return error_with("mapping", std::move(mapping)); };
  EXPECT_EQ(error(object({{"kind", "boxx"}})),
            "s.json: /mapping/kind: expected one of 'uv' or 'box', found 'boxx' (did you mean "
            "'box'?)");
  EXPECT_EQ(error(object({{"scale", 0}})),
            "s.json: /mapping/scale: expected a value in [0.001, 1000], found 0");
  EXPECT_EQ(error(object({{"offset_mm", array({1, 2, 3})}})),
            "s.json: /mapping/offset_mm: expected an array of 2, found an array of 3");
  EXPECT_EQ(error(object({{"uv_size_mm", 3}})),
            "s.json: /mapping/uv_size_mm: expected the key 'uv_size_mm' only where 'kind' is 'uv', "
            "found it with 'box'");
}

TEST(ReadScene, Cameras) {
  const auto error = [](Document camera) { return error_with("camera", std::move(camera)); };
  EXPECT_EQ(
      error(object({{"position", array({1, 2, 3})}, {"target", array({1, 2, 3})}})),
      "s.json: /camera/position: expected a position other than the target, found both at the "
      "same place");
  EXPECT_EQ(error(object({{"up", array({0, 0, 0})}})),
            "s.json: /camera/up: expected a direction other than zero, found [0, 0, 0]");
  EXPECT_EQ(error(object({{"width", 0}})),
            "s.json: /camera/width: expected a value in [1, 16384], found 0");
  EXPECT_EQ(error(object({{"height", 20000}})),
            "s.json: /camera/height: expected a value in [1, 16384], found 20000");
  EXPECT_EQ(error(object({{"width", 1.5}})),
            "s.json: /camera/width: expected a whole number in [-2147483648, 2147483647], found "
            "the number 1.5");
  EXPECT_EQ(error(object({{"fov_deg", 180}})),
            "s.json: /camera/fov_deg: expected a value in [0.1, 170], found 180");
  EXPECT_EQ(error(object({{"position", array({1, 2})}})),
            "s.json: /camera/position: expected an array of 3, found an array of 2");

  const auto warnings = [](Document camera) {
    return read_with("camera", std::move(camera)).warnings;
  };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(warnings(object({{"position", array({1, 2, 1})}})),
            Lines{"s.json: /camera/position: the camera is inside the mesh's box"});
  EXPECT_EQ(warnings(object({{"position", array({0, 5, 50})}, {"target", array({0, 5, 90})}})),
            Lines{"s.json: /camera: the mesh is outside the camera's view"});
  EXPECT_EQ(warnings(object({{"position", array({0, 5, 50})}})), Lines{});
  // Without a position the default view keeps the rest.
  const Camera camera = read_with("camera", object({{"fov_deg", 5}, {"width", 32}})).camera;
  EXPECT_EQ(camera.fov_deg, 5);
  EXPECT_GT(length(camera.position), 100);
}

TEST(ReadScene, BadLights) {
  const auto error = [](Document light) { return error_with("lights", array({std::move(light)})); };
  EXPECT_EQ(
      error(object({{"type", "dirctional"}})),
      "s.json: /lights/0/type: expected one of 'directional', 'point' or 'environment', found "
      "the string 'dirctional' (did you mean 'directional'?)");
  EXPECT_EQ(error(object({{"type", "directional"}, {"direction", array({0, 0, 0})}})),
            "s.json: /lights/0/direction: expected a direction other than zero, found [0, 0, 0]");
  EXPECT_EQ(error(object({{"type", "directional"}})),
            "s.json: /lights/0: expected the key 'direction', found no such key");
  EXPECT_EQ(
      error(object({{"type", "point"}, {"position", array({0, 0, 0})}, {"intensity", -1}})),
      "s.json: /lights/0/intensity: expected a number in [0, 1000000000000], found the number "
      "-1");
  EXPECT_EQ(error(object({{"type", "point"}, {"intensty", 1}})),
            "s.json: /lights/0/intensty: expected a known key, found 'intensty' (did you mean "
            "'intensity'?)");
  const auto environment = [&](const char* key, const char* value) {
    return error(object({{"type", "environment"}, {key, value}}));
  };
  EXPECT_EQ(environment("sky", "clera"),
            "s.json: /lights/0/sky: expected one of 'clear' or 'studio', found the string 'clera' "
            "(did you mean 'clear'?)");
  EXPECT_EQ(environment("file", "nan.exr"),
            "nan.exr: pixel (3, 1), channel 2: expected a radiance of at most 1000000000000, "
            "found nan");
  EXPECT_EQ(environment("file", "infinite.exr"),
            "infinite.exr: pixel (0, 1), channel 0: expected a radiance of at most 1000000000000, "
            "found inf");
  EXPECT_EQ(environment("file", "square.exr"),
            "square.exr: expected a latitude-longitude image, twice as wide as high, found 3 x 3 "
            "pixels");
  EXPECT_EQ(environment("file", "alpha.png"),
            "alpha.png: expected an image of 1 or 3 channels, found 2 x 1 pixels of 2");
  EXPECT_EQ(error(object({{"type", "environment"}})),
            "s.json: /lights/0: expected one of the keys 'file' and 'sky', found neither");
  EXPECT_EQ(error_with("lights", array(Document::Array(65))),
            "s.json: /lights: expected at most 64 lights, found an array of 65");

  const std::vector<std::string> dark{"s.json: /lights: no light: the mesh will be black"};
  EXPECT_EQ(read_with("lights", array({})).warnings, dark);
  const Scene lossy =
      read_with("lights", array({object({{"type", "environment"}, {"file", "negative.exr"}})}));
  EXPECT_EQ(lossy.warnings, std::vector<std::string>{"negative.exr: 1 negative values count as 0"});
  EXPECT_EQ(at(std::get<EnvironmentLight>(lossy.lights[0]).image, 1, 0, 0), 0);
  Document document = minimal();
  std::get<Document::Object>(document.value).pop_back();
  EXPECT_EQ(read(document).warnings,
            std::vector<std::string>{"s.json: /: no light: the mesh will be black"});
}

TEST(ReadScene, TheRest) {
  EXPECT_EQ(error_with("mesch", 1),
            "s.json: /mesch: expected a known key, found 'mesch' (did you mean 'mesh'?)");
  EXPECT_EQ(error_of([] { read(object({})); }),
            "s.json: /: expected the key 'material', found no such key");
  EXPECT_EQ(error_with("exposure", 31),
            "s.json: /exposure: expected a number in [-30, 30], found the number 31");
  EXPECT_EQ(error_with("specular", object({{"roughness", 0}})),
            "s.json: /specular/roughness: expected a value in [0.02, 1], found 0");
  EXPECT_EQ(error_with("background", "sky"),
            "s.json: /background: expected a number, an array of 3 or 'environment', found the "
            "string 'sky'");
  Document document = minimal();
  set(document, "lights", array({}));
  set(document, "background", "environment");
  EXPECT_EQ(error_of([&] { read(document); }),
            "s.json: /background: expected a light of type 'environment' to show, found no such "
            "light");
  EXPECT_EQ(read_with("background", array({0.1, 0.2, 0.3})).background, (Rgb{0.1f, 0.2f, 0.3f}));
}

}  // namespace
}  // namespace parian
